# SPDX-License-Identifier: BSD-3-Clause
"""Noise of a signal from rows that come back to the same drivers: wander and memory are in it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.signals.steady import Floor, steady_floor, steady_starts
from sklvalve.recording.noise import noise_floor
from sklvalve.simulation.slow_residual import LENGTH

if TYPE_CHECKING:
    from sklvalve.mismatch.signals.steady import Driver

# what rests is averaged over so many rows, and one row in so many is asked
_AVERAGED = 9
# share of the recording that must lie between two rows: what wanders is another there
_APART = 0.1
# two rows are alike where their drivers part the signal by less than this many times its quick noise
_ALIKE = 1.0
_PARTNERS, _FEWEST_SETTLED, _FEWEST, _MOST = 3, 100, 60, 1500
_DEGREE = 3


def repeats_floor(
    values: np.ndarray, driver: Driver | None, beside: Sequence[Driver] = (), quantum: float = 0.0
) -> Floor:
    r"""Noise of a signal, from pairs of rows at which all that drives it has come back to the same values.

    .. math:: \hat\sigma^2 = \tfrac12 \overline{(\Delta y - g \cdot \Delta d)^2} - \overline{g^2 \sigma_d^2}

    over pairs of settled rows, a tenth of the recording apart and more, whose drivers d are nearly alike:
    what is left of their difference goes to first order, by the slopes g of a cubic through all settled rows,
    and so does what the drivers' own noise contributes. Unlike steady stretches this holds slow wander, and
    whatever the drivers of a row do not tell of it: play and friction, which remember.

    Parameters
    ----------
    values : ndarray of shape (n,)
    driver : Driver or None
    beside : sequence of Driver, default=()
        All other drivers.
    quantum : float, default=0.0
        Resolution of the signal.

    Returns
    -------
    floor : Floor
    """
    if driver is None:
        return Floor(None, 0, "neither a command nor an opening that moves is recorded")
    at = _settled(values, driver, beside)
    if len(at) < _FEWEST_SETTLED:
        return Floor(None, 0, f"the {driver.name} seldom rests")
    table = np.column_stack([_averaged(driver.values)[at], *(d.values[at] for d in beside)])
    spread = table.std(axis=0)
    moving = spread > 0.0
    table, spread = table[:, moving], spread[moving]
    # a command is known as it was given; the mean takes most of an opening's noise
    resting = 0.0 if driver.name == "command" else driver.noise / np.sqrt(_AVERAGED)
    noise = np.array([resting, *(d.noise for d in beside)])[moving]
    slopes = _slopes(table, spread, values[at])
    quick = steady_floor(values, driver, beside, quantum).value or np.nan_to_num(noise_floor(values))
    first, second = _pairs(table, slopes, at, _ALIKE * max(quick, quantum), _APART * len(values))
    rows = len(np.unique(first))
    if rows < _FEWEST:
        return Floor(None, rows, f"what drives it comes back to the same values in {rows} rows only")
    slope = 0.5 * (slopes[first] + slopes[second])
    apart = values[at[second]] - values[at[first]]
    apart = apart - np.sum(slope * (table[second] - table[first]), axis=1)
    variance = 0.5 * np.mean(apart**2) - np.mean(np.sum((slope * noise) ** 2, axis=1))
    return Floor(float(np.sqrt(max(variance, quantum**2 / 12.0))), rows)


def _settled(values: np.ndarray, driver: Driver, beside: Sequence[Driver]) -> np.ndarray:
    """Rows in which the driver has come to rest, some way from each other."""
    rests = np.zeros(len(values), dtype=bool)
    # means must not reach out of the stretch
    edge = _AVERAGED // 2
    for k in steady_starts(values, driver, beside, every=5):
        rests[k + edge : k + LENGTH - edge] = True
    at = np.flatnonzero(rests)[::_AVERAGED]
    return at[:: max(int(np.ceil(len(at) / _MOST)), 1)]


def _averaged(values: np.ndarray) -> np.ndarray:
    """Means over some rows; what touches a gap is one."""
    return np.convolve(values, np.full(_AVERAGED, 1.0 / _AVERAGED), "same")


def _slopes(table: np.ndarray, spread: np.ndarray, signal: np.ndarray) -> np.ndarray:
    """Slopes of a cubic through the signal, at each row."""
    scaled = (table - table.mean(axis=0)) / spread
    powers = [p for n in range(_DEGREE + 1) for p in combinations_with_replacement(range(scaled.shape[1]), n)]
    columns = np.column_stack([np.prod(scaled[:, list(p)], axis=1) for p in powers])
    weights = np.linalg.lstsq(columns, signal, rcond=1e-8)[0]
    slopes = np.zeros_like(scaled)
    for weight, power in zip(weights, powers, strict=True):
        for one in set(power):
            others = list(power)
            others.remove(one)
            slopes[:, one] += weight * power.count(one) * np.prod(scaled[:, others], axis=1)
    return slopes / spread


def _pairs(
    table: np.ndarray, slopes: np.ndarray, at: np.ndarray, near: float, apart: float
) -> tuple[np.ndarray, np.ndarray]:
    """Rows and their nearest likes, as two arrays of places."""
    # a slope may vanish by chance: what is alike must be so by the usual one as well
    steep = np.maximum(np.abs(slopes), np.median(np.abs(slopes), axis=0))
    first, second = [], []
    # of likes that are alike to the last digit any may be taken, but not always the same
    rng = np.random.default_rng(0)
    for k in range(len(at)):
        moved = np.maximum(steep[k], steep) * (table - table[k])
        distance = np.where(np.abs(at - at[k]) >= apart, np.sum(moved**2, axis=1), np.inf)
        order = np.lexsort((rng.random(len(at)), distance))[:_PARTNERS]
        order = order[distance[order] < near**2]
        first += [k] * len(order)
        second += order.tolist()
    return np.array(first, dtype=int), np.array(second, dtype=int)
