# SPDX-License-Identifier: BSD-3-Clause
"""What whitening makes of a change that begins at any row: exact for all rows at once; compiled.

Of a change that was whitened as one from the first row on, the rows from an onset on are not that change
whitened with this onset: the filter has taken part of it for wander by then. Beside a noise that wanders
slowly nearly all that tells of a step is in its first rows, which are lost so. The filter is linear, and what
the two differ by is its answer to the state that it has at the onset: two numbers, forgotten row by row.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba as nb
import numpy as np

from sklvalve.simulation.robust import ROBUST_FROM

if TYPE_CHECKING:
    from sklvalve.simulation.noise import NoiseModel
    from sklvalve.simulation.noise_of_pieces import NoiseOfPieces

# share of an innovation's standard deviation below which what a state makes of it is small: of second order
_SMALL = 0.1


class WhitenedOnset:
    r"""Sums over all rows from an onset on, for every onset, of one channel's whitened changes.

    A change :math:`\delta` that begins at row k is whitened to

    .. math:: (W \delta)_t + c_t^\top M_{t-1} \dots M_k\, x_k, \qquad t \ge k

    with :math:`x_k` minus the state that the Kalman filter has of the whole change before row k, M its closed
    loop, and c the weight of a state in an innovation. Sums over t are taken backwards, once for all k.

    Parameters
    ----------
    noise : NoiseModel or NoiseOfPieces
        Rows in which a residual has no value are gaps of it.
    weights : ndarray of shape (n,)
        Of the rows' squares.
    """

    def __init__(self, noise: NoiseModel | NoiseOfPieces, weights: np.ndarray) -> None:
        self.noise, self.weights = noise, weights
        self._squares = np.zeros((len(weights), 3))
        for low, high, *filters in noise.pieces:
            self._squares[low:high] = _squares_from(weights[low:high], *filters)

    def states(self, white: np.ndarray) -> np.ndarray:
        """What the filter lacks of a change that begins at each row, beside one from the first row on.

        Parameters
        ----------
        white : ndarray of shape (n,)
            The change throughout, whitened.

        Returns
        -------
        states : ndarray of shape (n, 2)
        """
        return _states_of(self.noise, white)

    def answers(self, columns: np.ndarray) -> np.ndarray:
        """Weighted products of columns with the answer to a state, of either of its numbers, at each row.

        Parameters
        ----------
        columns : ndarray of shape (m, n)

        Returns
        -------
        answers : ndarray of shape (m, n, 2)
        """
        answers = np.zeros((*columns.shape, 2))
        weighted = np.ascontiguousarray(columns * self.weights)
        for low, high, *filters in self.noise.pieces:
            for j, column in enumerate(weighted):
                answers[j, low:high] = _answers_from(column[low:high], *filters)
        return answers

    def squares(self, white: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Weighted squares of a change from each row on, if it begins there, of shape (n,)."""
        both = np.einsum("ik,ik->i", self.answers(white[None])[0], states)
        x, y = states.T
        first, mixed, second = self._squares.T
        answered = first * x**2 + 2.0 * mixed * x * y + second * y**2
        return sums_from_here(self.weights * white**2) + 2.0 * both + answered

    def products(
        self, white: np.ndarray, states: np.ndarray, columns: np.ndarray, answers: np.ndarray
    ) -> np.ndarray:
        """Weighted products of a change with columns from each row on, if it begins there, of shape (m, n).

        Parameters
        ----------
        white : ndarray of shape (n,)
            The change throughout, whitened.
        states : ndarray of shape (n, 2)
            Its `states`.
        columns : ndarray of shape (m, n)
        answers : ndarray of shape (m, n, 2)
            Their `answers`.
        """
        return sums_from_here(self.weights * white * columns) + np.einsum("mik,ik->mi", answers, states)


def losses_from_here(
    noise: NoiseModel | NoiseOfPieces, without: np.ndarray, acting: np.ndarray
) -> np.ndarray:
    """Robust loss of a residual that changes from one hypothesis to another at each row, from that row on.

    Parameters
    ----------
    noise : NoiseModel or NoiseOfPieces
    without, acting : ndarray of shape (n,)
        Whitened residuals of the hypotheses before the change and after it.

    Returns
    -------
    losses : ndarray of shape (n,)
    """
    root = np.sqrt(1.0 + (acting / ROBUST_FROM) ** 2)
    losses, states = sums_from_here(ROBUST_FROM**2 * (root - 1.0)), _states_of(noise, acting - without)
    # the loss, its slope and its curvature: what a state makes of the rows once it is small
    slopes, curvatures = acting / root, root**-3.0
    for low, high, *filters in noise.pieces:
        rows = slice(low, high)
        towards = _answers_from(slopes[rows], *filters)
        squares = _squares_from(curvatures[rows], *filters)
        losses[rows] += _lost_by_states(acting[rows], states[rows], towards, squares, *filters)
    return losses


def _states_of(noise: NoiseModel | NoiseOfPieces, white: np.ndarray) -> np.ndarray:
    """Minus the states of the filter before each row of a whitened change, zero where it has none."""
    states = np.zeros((len(white), 2))
    for low, high, *filters in noise.pieces:
        states[low:high] = _states_before(white[low:high], *filters)
    return states


def sums_from_here(each: np.ndarray) -> np.ndarray:
    """Sum of every row and all behind it, along the last axis."""
    return np.cumsum(each[..., ::-1], axis=-1)[..., ::-1]


@nb.njit(cache=True, nogil=True)
def _states_before(white: np.ndarray, gain: np.ndarray, keep: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Minus the states of the filter before each row, told by the innovations."""
    out = np.empty((len(white), 2))
    f = s = 0.0
    for k in range(len(white)):
        out[k, 0], out[k, 1] = -f, -s
        f *= keep[k, 0]
        s *= keep[k, 1]
        if spread[k] != np.inf:
            f += gain[k, 0] * white[k] * spread[k]
            s += gain[k, 1] * white[k] * spread[k]
    return out


@nb.njit(cache=True, nogil=True)
def _answers_from(column: np.ndarray, gain: np.ndarray, keep: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Sum over all rows from each on of a column times the innovation that a state before it makes."""
    out = np.empty((len(column), 2))
    a = b = 0.0
    for k in range(len(column) - 1, -1, -1):
        innovation = 0.0
        if spread[k] != np.inf:
            innovation = gain[k, 0] * a + gain[k, 1] * b + column[k] / spread[k]
        a = keep[k, 0] * (a - innovation)
        b = keep[k, 1] * (b - innovation)
        out[k, 0], out[k, 1] = a, b
    return out


@nb.njit(cache=True, nogil=True)
def _squares_from(weights: np.ndarray, gain: np.ndarray, keep: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Weighted squares of the innovations that a state before each row makes: three numbers of a form."""
    out = np.empty((len(weights), 3))
    p = q = r = 0.0
    for k in range(len(weights) - 1, -1, -1):
        # of the closed loop I - g 1', then of what is kept
        if spread[k] != np.inf:
            g, h = gain[k, 0], gain[k, 1]
            pg, qg = p * g + q * h, q * g + r * h
            both = g * pg + h * qg + weights[k] / spread[k] ** 2
            p, q, r = p - 2.0 * pg + both, q - pg - qg + both, r - 2.0 * qg + both
        p *= keep[k, 0] ** 2
        q *= keep[k, 0] * keep[k, 1]
        r *= keep[k, 1] ** 2
        out[k, 0], out[k, 1], out[k, 2] = p, q, r
    return out


@nb.njit(cache=True, nogil=True)
def _lost_by_states(
    white: np.ndarray,
    states: np.ndarray,
    towards: np.ndarray,
    squares: np.ndarray,
    gain: np.ndarray,
    keep: np.ndarray,
    spread: np.ndarray,
) -> np.ndarray:
    """What the rows from each on lose more by the answer to a state before it."""
    n = len(white)
    out = np.zeros(n)
    for k in range(n - 1, -1, -1):
        if spread[k] == np.inf:
            # nothing is seen in a gap: what begins there begins at its end
            out[k] = out[k + 1] if k + 1 < n else 0.0
            continue
        f, s = states[k]
        for i in range(k, n):
            f *= keep[i, 0]
            s *= keep[i, 1]
            if spread[i] == np.inf:
                continue
            left = -f - s
            f += gain[i, 0] * left
            s += gain[i, 1] * left
            changed = white[i] + left / spread[i]
            before = np.sqrt(1.0 + (white[i] / ROBUST_FROM) ** 2)
            out[k] += ROBUST_FROM**2 * (np.sqrt(1.0 + (changed / ROBUST_FROM) ** 2) - before)
            if abs(f) + abs(s) <= _SMALL * spread[i]:
                if i + 1 < n:
                    p, q, r = squares[i + 1]
                    out[k] += towards[i + 1, 0] * f + towards[i + 1, 1] * s
                    out[k] += 0.5 * (p * f * f + 2.0 * q * f * s + r * s * s)
                break
    return out
