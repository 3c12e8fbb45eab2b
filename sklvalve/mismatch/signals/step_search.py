# SPDX-License-Identifier: BSD-3-Clause
"""What a step at any row explains of a residual, beside columns that are there throughout; compiled."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numba as nb
import numpy as np
from scipy.linalg import qr, solve_triangular

from sklvalve.mismatch.signals.tall import row_blocks, triangle

if TYPE_CHECKING:
    from sklvalve.simulation.noise import NoiseModel
    from sklvalve.simulation.noise_of_pieces import NoiseOfPieces

# deviations from which on a row counts less
_ROBUST = 3.0
# log likelihood that a response besides a level must gain
_FOR_A_RESPONSE = 6.0
# share of the rows that a posterior of change times holds to either side of its interval
_TAIL = 0.025
# of what a step is, so much must be left beside the columns, or rounding is all that is compared
_LEFT = 1e-10
# of its length, so much of a column must be no sum of the others, or it counts as one
_INDEPENDENT = 1e-9
# what a step's beginning changes of its whitened value is forgotten below this
_FORGOTTEN = 1e-12


class StepSearch:
    """Generalised least squares of a residual on its steady columns, and one step more at any row.

    Parameters
    ----------
    noise : NoiseModel or NoiseOfPieces
    left : ndarray of shape (n,)
        What a simulation leaves over [SI].
    steady : ndarray of shape (n, m)
        What may be wrong throughout.
    about : ndarray of shape (n,)
        The simulated signal, centred and scaled: how far the residual follows it may change as well. Rows
        at which it is not finite say nothing of that.
    """

    def __init__(
        self, noise: NoiseModel | NoiseOfPieces, left: np.ndarray, steady: np.ndarray, about: np.ndarray
    ) -> None:
        self.noise, self.left, self.steady = noise, left, steady
        self.about = np.where(np.isfinite(about), about, 0.0)
        self.response = 0.0
        white = noise.whiten(left)
        columns: np.ndarray = np.empty(steady.shape)
        for k, column in enumerate(steady.T):
            columns[:, k] = noise.whiten(column)
        self.weights = np.ones(len(left))
        for _ in range(2):
            self._project(white, columns)
            off = np.abs(self.white) / np.sqrt(self.weights)
            self.weights = 1.0 / np.sqrt(1.0 + (off / _ROBUST) ** 2)
        self._raw = white, columns
        self._project(white, columns)

    def _project(self, white: np.ndarray, columns: np.ndarray) -> None:
        self.basis = _orthonormal(columns, np.sqrt(self.weights))
        self.white = self._beside(white)

    def _beside(self, white: np.ndarray) -> np.ndarray:
        weighed = white * np.sqrt(self.weights)
        return weighed - self.basis @ (self.basis.T @ weighed)

    def gains(self, rows: np.ndarray, white: np.ndarray | None = None) -> np.ndarray:
        """Twice the log likelihood that a step of the level gains at each row, and one of the response too.

        Parameters
        ----------
        rows : ndarray of int, shape (k,)
        white : ndarray of shape (n,), default=None
            Whitened residual beside the columns; that of the search unless given.

        Returns
        -------
        gains : ndarray of shape (k, 2)
        """
        white = self.white if white is None else white
        rows, root = np.asarray(rows, dtype=np.int64), np.sqrt(self.weights)
        m = self.basis.shape[1]
        sums: Any = 0.0
        for low, high, gain, keep, spread in self.noise.pieces:
            part = slice(low, high)
            sums = sums + _step_sums(
                rows, low, gain, keep, spread, root[part], self.about[part], white[part], self.basis[part]
            )
        level, both, follows, seen, seen_too = sums[:, :5].T
        of_level, of_follows = sums[:, 5 : 5 + m], sums[:, 5 + m :]
        size = level - np.sum(of_level**2, axis=1)
        both -= np.sum(of_level * of_follows, axis=1)
        of_response = follows - np.sum(of_follows**2, axis=1)
        some = size > np.maximum(1e-9, _LEFT * level)
        share = np.divide(both, size, out=np.zeros(len(rows)), where=some)
        of_response -= share * both
        seen_too -= share * seen
        first = np.divide(seen**2, size, out=np.zeros(len(rows)), where=some)
        # at a join the level is free already, and the response may still change
        also = of_response > np.maximum(1e-6, _LEFT * follows)
        second = np.divide(seen_too**2, of_response, out=np.zeros(len(rows)), where=also)
        return np.stack([first, first + second], axis=1)

    def best(self, places: np.ndarray) -> tuple[int, float, bool]:
        """The likeliest row, twice its log likelihood, and whether the response changes as well."""
        top = int(np.argmax(_net_gains(self.gains(places))))
        low, high = places[max(top - 1, 0)], places[min(top + 1, len(places) - 1)]
        near = np.unique(np.linspace(low, high, min(high - low + 1, 160)).astype(int))
        scores = self.gains(near)
        top = int(np.argmax(_net_gains(scores)))
        both = scores[top, 1] - 2.0 * _FOR_A_RESPONSE > scores[top, 0]
        return int(near[top]), float(scores[top, int(both)]), bool(both)

    def split(self, row: int, response_too: bool) -> tuple[np.ndarray, np.ndarray]:
        """What the change makes of the signal, and what is left over without it and the steady columns."""
        white, columns = self._raw
        root = np.sqrt(self.weights)[:, None]
        after = (np.arange(len(self.left)) >= row).astype(float)
        steps = [after, after * self.about] if response_too else [after]
        last = np.stack([*(self.noise.whiten(s) for s in steps), white], axis=1)
        blocks = row_blocks(0, len(white))
        small = triangle(np.concatenate([columns[b], last[b]], axis=1) * root[b] for b in blocks)
        sizes = np.linalg.lstsq(small[:, :-1], small[:, -1], rcond=1e-10)[0]
        many = columns.shape[1]
        made = sum(size * s for size, s in zip(sizes[many:], steps, strict=True))
        self.response = float(sizes[-1]) if response_too else 0.0
        self.white_left = self._beside(self.noise.whiten(self.left - made))
        return made, self.left - self.steady @ sizes[:many] - made

    def inflation(self, places: np.ndarray) -> float:
        """How many times chance the steps at other times gain when the best is gone, at least once."""
        gained = self.gains(places[:: max(len(places) // 80, 1)], self.white_left)[:, 0]
        return max(1.0, float(np.mean(gained)))

    def interval(self, row: int, response_too: bool, spread: float) -> tuple[int, int]:
        """Rows between which the change lies with 95 %, of a posterior over rows around the likeliest."""
        n, reach = len(self.left), 8
        while True:
            near = np.unique(np.linspace(max(row - reach, 1), min(row + reach, n - 5), 121).astype(int))
            near = np.unique(np.append(near, row))
            gains = self.gains(near)[:, int(response_too)]
            weights = np.exp(0.5 * (gains - gains.max()) / spread) * np.gradient(near.astype(float))
            mass = np.cumsum(weights) / weights.sum()
            ends = np.interp([_TAIL, 1.0 - _TAIL], mass, near)
            inside = (near[0] + 2 < ends[0] or near[0] <= 1) and (ends[1] < near[-1] - 2 or near[-1] >= n - 5)
            if inside or reach > n:
                return int(np.floor(min(ends[0], row))), int(np.ceil(max(ends[1], row)))
            reach *= 4


def _orthonormal(columns: np.ndarray, root: np.ndarray) -> np.ndarray:
    """Orthonormal columns with the span of weighted ones; what sums of others leave is no direction."""
    blocks = row_blocks(0, len(columns))
    small = triangle(columns[b] * root[b, None] for b in blocks)
    length = np.linalg.norm(small, axis=0)
    some = np.flatnonzero(length > 0.0)
    _, left, order = qr(small[:, some] / length[some], mode="economic", pivoting=True)
    kept = np.count_nonzero(np.abs(np.diag(left)) > _INDEPENDENT)
    chosen = some[order[:kept]]
    made = columns[:, chosen]
    made *= root[:, None]
    made /= length[chosen]
    _make_orthonormal(made, left[:kept, :kept], blocks)
    # once more: what is left of columns that nearly are sums of others is rounded
    _make_orthonormal(made, triangle(made[b] for b in blocks), blocks)
    return made


def _make_orthonormal(columns: np.ndarray, small: np.ndarray, blocks: list[slice]) -> None:
    """Columns times the inverse of the R of their QR factors, in place."""
    inverse = solve_triangular(small, np.eye(len(small)))
    for b in blocks:
        columns[b] = columns[b] @ inverse


def _net_gains(scores: np.ndarray) -> np.ndarray:
    return np.maximum(scores[:, 0], scores[:, 1] - 2.0 * _FOR_A_RESPONSE)


@nb.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "nsz"})
def _step_sums(
    rows: np.ndarray,
    begin: int,
    gain: np.ndarray,
    keep: np.ndarray,
    spread: np.ndarray,
    root: np.ndarray,
    about: np.ndarray,
    white: np.ndarray,
    basis: np.ndarray,
) -> np.ndarray:
    """Of each row's step, whitened from that row on: its squares, and its products with all else.

    Columns: level², level follows, follows², level white, follows white, level basis (m), follows basis (m).
    Once the noise has forgotten when a step began it is whitened as one from the first row on: what follows
    is summed for all steps at once.
    """
    n, m = basis.shape
    sums, alike = np.zeros((len(rows), 5 + 2 * m)), np.full(len(rows), n)
    states, scale = _whitened_from_the_first(gain, keep, spread, about), np.max(np.abs(about))
    for j in range(len(rows)):
        f = s = g = u = 0.0
        for k in range(max(rows[j] - begin, 0), n):
            known = spread[k] != np.inf
            left, too, f, s, g, u = _whitened(known, about[k], gain[k], keep[k], f, s, g, u)
            if not known:
                continue
            weight = root[k] / spread[k]
            _add(sums[j], left * weight, too * weight, white[k], basis[k])
            off = abs(f - states[k, 2]) + abs(s - states[k, 3])
            off_too = abs(g - states[k, 4]) + abs(u - states[k, 5])
            if off <= _FORGOTTEN and off_too <= _FORGOTTEN * scale:
                alike[j] = k + 1
                break
    last, left_over = np.argsort(-alike), np.zeros(5 + 2 * m)
    k = n
    for j in last:
        while k > alike[j]:
            k -= 1
            if spread[k] != np.inf:
                weight = root[k] / spread[k]
                _add(left_over, states[k, 0] * weight, states[k, 1] * weight, white[k], basis[k])
        sums[j] += left_over
    return sums


@nb.njit(cache=True, nogil=True, inline="always")
def _add(sums: np.ndarray, left: float, too: float, white: float, basis: np.ndarray) -> None:
    """Add a row to the sums of `_step_sums`, in place."""
    m = len(basis)
    sums[0] += left * left
    sums[1] += left * too
    sums[2] += too * too
    sums[3] += left * white
    sums[4] += too * white
    for i in range(m):
        sums[5 + i] += left * basis[i]
        sums[5 + m + i] += too * basis[i]


@nb.njit(cache=True, nogil=True)
def _whitened_from_the_first(
    gain: np.ndarray, keep: np.ndarray, spread: np.ndarray, about: np.ndarray
) -> np.ndarray:
    """A step of level and one of response in the first row, whitened but for its scale, and their states.

    Columns: level, follows, the two states of the level, the two of what follows.
    """
    made = np.zeros((len(about), 6))
    f = s = g = u = 0.0
    for k in range(len(about)):
        made[k, 0], made[k, 1], f, s, g, u = _whitened(
            spread[k] != np.inf, about[k], gain[k], keep[k], f, s, g, u
        )
        made[k, 2], made[k, 3], made[k, 4], made[k, 5] = f, s, g, u
    return made


@nb.njit(cache=True, nogil=True, inline="always")
def _whitened(
    known: bool, about: float, gain: np.ndarray, keep: np.ndarray, f: float, s: float, g: float, u: float
) -> tuple[float, float, float, float, float, float]:
    """One row of a step of level and one of response, whitened but for its scale, and the states after it."""
    f *= keep[0]
    s *= keep[1]
    g *= keep[0]
    u *= keep[1]
    left = too = 0.0
    if known:
        left, too = 1.0 - f - s, about - g - u
        f += gain[0] * left
        s += gain[1] * left
        g += gain[0] * too
        u += gain[1] * too
    return left, too, f, s, g, u
