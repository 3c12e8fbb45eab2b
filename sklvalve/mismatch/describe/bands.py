# SPDX-License-Identifier: BSD-3-Clause
"""Mean residual in every part of the operating range, with bands that hold for all parts at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm
from scipy.stats import t as student

from sklvalve.mismatch.describe.cells import Cells

if TYPE_CHECKING:
    from sklvalve.simulation.noise import NoiseModel
    from sklvalve.simulation.noise_of_pieces import NoiseOfPieces

    Noise = NoiseModel | NoiseOfPieces
    Part = tuple[Noise, np.ndarray, Sequence[np.ndarray], Sequence[Cells]]

# stretches whose scatter the bands are made of: longer than what whitening leaves of the noise's memory
_STRETCH_ROWS = 30
_FEWEST_STRETCHES, _MOST_STRETCHES = 24, 192
_DRAWS = 2000
# a spread seen in few stretches is held to that of all cells, as if seen in this many more
_HELD_BY = 40.0
# of the noise alone nothing is this large: a spike must not pass for a mean
_SPIKE = 4.0


@dataclass(frozen=True, eq=False)
class Band:
    """Mean residual in the cells of one partition.

    Attributes
    ----------
    cells : Cells
    mean : ndarray of shape (n_cells,)
        Mean residual of each cell, all cells fitted together by generalised least squares [SI].
    half : ndarray of shape (n_cells,)
        Half width of the simultaneous band.
    gain : float
        What the means of the cells explain of the whitened residual, half sum of squares.
    """

    cells: Cells
    mean: np.ndarray
    half: np.ndarray
    gain: float

    @property
    def beyond(self) -> np.ndarray:
        """By how much each mean is sure to differ from nought [SI]; zero inside the band."""
        return np.maximum(np.abs(self.mean) - self.half, 0.0)


def simultaneous_bands(
    parts: Sequence[Part], *, alpha: float, random_state: int = 0
) -> list[list[list[Band]]]:
    """Bands for the mean residuals of several channels, partitions and residuals.

    Parameters
    ----------
    parts : sequence of (noise, residual, several, partitions)
        For each channel its `NoiseModel`; the residual that is left when all is explained, whose scatter the
        bands are made of, ndarray of shape (n,), NaN in gaps; residuals to be looked at, a list of such
        arrays; a list of `Cells`.
    alpha : float
        Chance that any mean at all leaves its band where there is only noise.
    random_state : int, default=0

    Returns
    -------
    bands : list of list of list of Band
        By channel, residual and partition.

    Notes
    -----
    In each partition the whitened residual is fitted by the whitened indicators of all cells together, so
    that correlated noise counts as what it is, and a residual that the filter remembers after it has left one
    cell does not pass for one of the next. The largest standardised mean is drawn by multiplying the
    contributions of stretches by normal numbers (a block multiplier bootstrap; Chernozhukov, Chetverikov and
    Kato, Annals of Statistics 41 (2013) 2786), which keeps the correlation of overlapping cells and what
    whitening left of that of the rows.
    """
    fits = [_fits_of(*part) for part in parts]
    every = [fit for channel in fits for fit in channel]
    if not every:
        return [[[] for _ in several] for _, _, several, _ in parts]
    critical = _largest(every, alpha, random_state)
    return [
        [[fit.band(i, critical) for fit in channel] for i in range(len(several))]
        for channel, (_, _, several, _) in zip(fits, parts, strict=True)
    ]


def _fits_of(
    noise: Noise, residual: np.ndarray, several: Sequence[np.ndarray], partitions: Sequence[Cells]
) -> list[_Fit]:
    """Fits of one channel, partition by partition, with their spreads."""
    fits = [_Fit(noise, residual, several, cells) for cells in partitions]
    excess = max(1.0, float(np.mean(np.concatenate([fit.scatter for fit in fits] or [np.ones(1)]))))
    for fit in fits:
        fit.settle(excess)
    return fits


class _Fit:
    """Means of the cells of one partition, and what the stretches of a noise contribute to them."""

    def __init__(
        self, noise: Noise, residual: np.ndarray, several: Sequence[np.ndarray], cells: Cells
    ) -> None:
        self.cells = cells
        columns = np.stack([noise.whiten(_indicator(cells, k, residual)) for k in range(cells.count)], axis=1)
        gram = columns.T @ columns
        # cells in gaps alone hold nothing
        gram[np.diag_indices_from(gram)] += 1e-9 * np.trace(gram) / len(gram) + 1e-300
        self._inverse = np.linalg.inv(gram)
        left = noise.whiten(residual)
        spikes = left - np.clip(left, -_SPIKE, _SPIKE)
        starts = _stretches(len(left))
        self.stretches = self._inverse @ np.add.reduceat(columns * (left - spikes)[:, None], starts).T
        # how many stretches a mean rests on, were all rows alike
        weight = np.add.reduceat((columns @ self._inverse) ** 2, starts)
        self._rests_on = weight.sum(axis=0) ** 2 / np.maximum((weight**2).sum(axis=0), 1e-300)
        self.scatter = (self.stretches**2).sum(axis=1) / np.diag(self._inverse)
        towards = [columns.T @ (noise.whiten(each) - spikes) for each in several]
        self.means = [self._inverse @ each for each in towards]
        self.gains = [0.5 * float(each @ mean) for each, mean in zip(towards, self.means, strict=True)]

    def settle(self, excess: float) -> None:
        """Spreads of the means, held to the scatter of all cells where few stretches speak."""
        held = (self._rests_on * self.scatter + _HELD_BY * excess) / (self._rests_on + _HELD_BY)
        self.spread = np.sqrt(np.diag(self._inverse) * np.maximum(held, 1.0))

    def band(self, i: int, critical: float) -> Band:
        # a spread from few stretches is itself uncertain
        wide = student.isf(norm.sf(critical), self._rests_on + _HELD_BY)
        return Band(self.cells, self.means[i], wide * self.spread, self.gains[i])


def _indicator(cells: Cells, k: int, residual: np.ndarray) -> np.ndarray:
    return np.where(np.isfinite(residual), (cells.cell == k).astype(float), np.nan)


def _stretches(n: int) -> np.ndarray:
    """First row of each stretch."""
    many = int(np.clip(n // _STRETCH_ROWS, _FEWEST_STRETCHES, _MOST_STRETCHES))
    return np.unique(np.linspace(0, n, many, endpoint=False).astype(int))


def _largest(fits: list[_Fit], alpha: float, random_state: int) -> float:
    """Quantile of the largest standardised mean of any cell under noise alone."""
    drawn = np.concatenate([fit.stretches for fit in fits])
    drawn /= np.maximum(np.sqrt((drawn**2).sum(axis=1)), 1e-300)[:, None]
    normal = np.random.default_rng(random_state).standard_normal((drawn.shape[1], _DRAWS))
    return float(np.quantile(np.abs(drawn @ normal).max(axis=0), 1.0 - alpha))
