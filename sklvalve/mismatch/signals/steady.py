# SPDX-License-Identifier: BSD-3-Clause
"""Noise of a signal in stretches in which what drives it rests: a floor that no model has a part in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sklvalve.recording import Recording
from sklvalve.recording.noise import noise_floor
from sklvalve.simulation.slow_residual import LENGTH

# rows of rest before a stretch that let everything settle
SETTLING = 20
# a driver rests where it scatters about a straight line by no more than this many times its own variance,
# and goes no further than this share of its range
_STILL, _FURTHEST = 1.5, 0.02
# a command has no noise of its own; what moves it less than this moves no stem [1]
_COMMAND_STILL = 1e-3
_FEWEST = 5
# stretches this far above the median stretch hold a movement that no driver shows
_STRANGE = 4.0


@dataclass(frozen=True)
class Floor:
    """Noise of a signal told by the recording alone.

    Parameters
    ----------
    value : float or None
        Standard deviation, in the unit of the signal.
    rows : int
        Rows that it rests on.
    reason : str
        Why there is none; empty where there is.
    """

    value: float | None
    rows: int
    reason: str = ""


@dataclass(frozen=True, eq=False)
class Driver:
    """A signal that drives another one.

    Parameters
    ----------
    name : str
    values : ndarray of shape (n,)
    noise : float
        Standard deviation of what may move in it without anything having moved.
    """

    name: str
    values: np.ndarray
    noise: float


def drivers_of(recording: Recording, channel: str) -> tuple[Driver | None, list[Driver]]:
    """What drives a recorded signal.

    Parameters
    ----------
    recording : Recording
    channel : {"opening", "flow"}

    Returns
    -------
    valve : Driver or None
        Command or opening: what must rest. None where the recording has neither.
    beside : list of Driver
        Pressures, which seldom rest, and move a flow in proportion as long as they move little.
    """
    name = "opening" if channel == "flow" and "opening" in recording else "command"
    if name not in recording or recording.resolution(name) == 0.0:
        return None, []
    pressures = [r for r in ("p1", "p2") if channel == "flow" and r in recording]
    beside = [_driver(recording, r) for r in pressures if recording.resolution(r) > 0.0]
    return _driver(recording, name), beside


def _driver(recording: Recording, name: str) -> Driver:
    if name == "command":
        return Driver(name, recording[name], _COMMAND_STILL)
    noise = np.nan_to_num(noise_floor(recording[name]))
    return Driver(name, recording[name], max(noise, recording.resolution(name) / np.sqrt(12.0)))


def steady_starts(
    values: np.ndarray, driver: Driver, beside: Sequence[Driver] = (), every: int = 1
) -> np.ndarray:
    """First rows of stretches of `LENGTH` rows, the driver at rest since `SETTLING` rows before.

    Parameters
    ----------
    values : ndarray of shape (n,)
        The signal driven; stretches hold no gap of it.
    driver : Driver
    beside : sequence of Driver, default=()
        Other drivers, in which there must be no gap either.
    every : int, default=1
        Rows by which one stretch lies behind the other at least.

    Returns
    -------
    starts : ndarray of int
    """
    known = np.isfinite(values) & np.isfinite(driver.values)
    for other in beside:
        known &= np.isfinite(other.values)
    width = SETTLING + LENGTH
    if len(values) < width:
        return np.zeros(0, dtype=int)
    filled = np.where(known, driver.values, 0.0)
    scatter, drift = _about_lines(filled - filled[known].mean() if known.any() else filled, width)
    whole = np.convolve(known, np.ones(width), "valid") > width - 0.5
    rests = whole & (scatter <= _STILL * driver.noise**2)
    rests &= np.abs(drift) <= _FURTHEST * np.ptp(driver.values[known]) if known.any() else False
    starts: list[int] = []
    free = 0
    for k in np.flatnonzero(rests).tolist():
        if k >= free:
            starts.append(k + SETTLING)
            free = k + every
    return np.array(starts, dtype=int)


def _about_lines(values: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Variance about a straight line, and rise of that line, in every run of so many rows."""
    t = np.arange(width) - 0.5 * (width - 1)
    total, squares = (np.convolve(v, np.ones(width), "valid") for v in (values, values**2))
    slope = np.correlate(values, t, "valid") / (t @ t)
    left = squares - total**2 / width - slope**2 * (t @ t)
    return np.maximum(left, 0.0) / (width - 2), slope * (width - 1)


def steady_floor(
    values: np.ndarray, driver: Driver | None, beside: Sequence[Driver] = (), quantum: float = 0.0
) -> Floor:
    """Quick noise of a signal, from stretches in which what drives it rests.

    In each stretch the signal scatters about a straight line and about what the pressures beside do in
    proportion; the mean of that scatter's variances over the stretches is the noise's. Noise that wanders
    over more rows than a stretch has follows the line, and is not in it.

    Parameters
    ----------
    values : ndarray of shape (n,)
        The signal, evenly sampled.
    driver : Driver or None
        What must rest.
    beside : sequence of Driver, default=()
        What may move.
    quantum : float, default=0.0
        Resolution of the signal: its noise is no less than what rounding makes.

    Returns
    -------
    floor : Floor
    """
    if driver is None:
        return Floor(None, 0, "neither a command nor an opening that moves is recorded")
    starts = steady_starts(values, driver, beside, every=LENGTH)
    if len(starts) < _FEWEST:
        return Floor(
            None,
            len(starts) * LENGTH,
            f"the {driver.name} rests for {SETTLING + LENGTH} rows in {len(starts)} places; "
            f"{_FEWEST} are needed",
        )
    time = np.linspace(-1.0, 1.0, LENGTH)
    variances = []
    for k in starts:
        rows = slice(k, k + LENGTH)
        moving = [d.values[rows] - d.values[rows].mean() for d in beside]
        moving = [m / m.std() for m in moving if m.std() > 0.0]
        A = np.column_stack([np.ones(LENGTH), time, *moving])
        solution = np.linalg.lstsq(A, values[rows], rcond=1e-10)[0]
        left = values[rows] - A @ solution
        variances.append(left @ left / (LENGTH - A.shape[1]))
    variance = np.array(variances)
    usual = variance <= _STRANGE * np.median(variance)
    value = max(float(np.sqrt(variance[usual].mean())), quantum / np.sqrt(12.0))
    return Floor(value, int(usual.sum()) * LENGTH)
