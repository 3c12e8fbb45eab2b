# SPDX-License-Identifier: BSD-3-Clause
"""A fitted hypothesis and how its calibration would answer a change, to first order and within its bounds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.inference.hypothesis import FIRST_ONSET, LAST_ONSET, Model
from sklvalve.mismatch.inference.whitened_onset import WhitenedOnset
from sklvalve.simulation.fitting import Misfit
from sklvalve.simulation.robust import least_within, normal_equations, robust_cost, robust_weights

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

# of a step to first order so much is tried, as long as it makes the rows worse that it should make better
_SHARES = (1.0, 0.3, 0.1, 0.03)


class Linearised:
    """A fitted hypothesis and, to first order, what its calibration can do about a change of some channels.

    Parameters
    ----------
    problem : Problem
    model : Model
    touched : sequence of str
        Channels that change.

    Attributes
    ----------
    channels : tuple of str
        Those touched, and those that share parameters with them.
    errors : ndarray of shape (n_errors,)
        Whitened residuals of the channels, one after the other, then distances from the priors.
    cost : float
        Robust cost of the errors.
    """

    def __init__(self, problem: Problem, model: Model, touched: Sequence[str]) -> None:
        self._misfits = misfits = problem.misfits(model, touched)
        self.channels = tuple(c for m in misfits for c in m.channels)
        self.clock, self.n = model.chain.clock, len(model.chain.clock)
        self._names, parts = [], []
        for misfit in misfits:
            parts.append(_derivatives(misfit))
            self._names += list(misfit.vector.names)
        self._assemble(parts)
        self.cost = robust_cost(self.errors)
        self._weights = robust_weights(self.errors)
        _, hessian = normal_equations(self._slopes, self._weights, self.errors)
        self._inverse = np.linalg.pinv(hessian, rcond=1e-10, hermitian=True)

    def _assemble(self, parts: list[dict[str, Any]]) -> None:
        """One system of all groups: they share no parameter, so their derivatives stand block by block."""
        rows = [len(p["whitened"]) for p in parts]
        width = [len(p["z"]) for p in parts]
        priors = [p["slopes"].shape[1] - r for p, r in zip(parts, rows, strict=True)]
        slopes = np.zeros((sum(width), sum(rows) + sum(priors)))
        row, prior, column = 0, sum(rows), 0
        self._raw = {}
        for part, r, w, q in zip(parts, rows, width, priors, strict=True):
            span = slice(column, column + w)
            slopes[span, row : row + r] = part["slopes"][:, :r]
            slopes[span, prior : prior + q] = part["slopes"][:, r:]
            for channel, raw in part["raw"].items():
                self._raw[channel] = (span, raw)
            row, prior, column = row + r, prior + q, column + w
        self._slopes = slopes
        self._priors = np.concatenate([p["priors"] for p in parts])
        self.errors = np.concatenate([*(p["whitened"] for p in parts), self._priors])
        self._z = np.concatenate([p["z"] for p in parts])
        self._low = np.concatenate([p["low"] for p in parts]) - self._z
        self._high = np.concatenate([p["high"] for p in parts]) - self._z

    def with_priors(self, whitened: np.ndarray) -> np.ndarray:
        """Errors of a changed simulation whose calibration stands as it was."""
        return np.concatenate([whitened, self._priors])

    def towards(self, rows: np.ndarray) -> list[np.ndarray]:
        """The step that is best to first order where only some rows count, and shares of it.

        Parameters
        ----------
        rows : ndarray of bool, shape (n,)
        """
        counts = self._counting(rows)
        errors, slopes = (np.where(counts, each, 0.0) for each in (self.errors, self._slopes))
        step = least_within(slopes, errors, self._low, self._high)[1]
        return [share * step for share in _SHARES]

    def refitted(self, rows: np.ndarray) -> dict[str, float]:
        """Values of the calibration when only some rows count: the first step `towards` them that helps.

        Where none lessens their cost, it stays as it is.

        Parameters
        ----------
        rows : ndarray of bool, shape (n,)
        """
        counts = self._counting(rows)
        least = robust_cost(np.where(counts, self.errors, 0.0))
        for steps in self.towards(rows):
            if robust_cost(np.where(counts, self._errors_after(steps), 0.0)) <= least:
                return self.values(steps)
        return self.values(np.zeros(len(self._z)))

    def _counting(self, rows: np.ndarray) -> np.ndarray:
        """Which of the errors count where only some rows do; the priors always."""
        return np.concatenate([np.tile(rows, len(self.channels)), np.ones(len(self._priors), dtype=bool)])

    def _errors_after(self, steps: np.ndarray) -> np.ndarray:
        """Errors of the simulation itself after steps of the calibration, as `errors` has them."""
        moved = list(self._after(steps))
        whitened = (misfit.whitened(misfit.predictions(z)) for misfit, z in moved)
        return np.concatenate([*whitened, *(misfit.vector.prior_residuals(z) for misfit, z in moved)])

    def _after(self, steps: np.ndarray) -> Iterator[tuple[Misfit, np.ndarray]]:
        """Each group and where its calibration is after steps."""
        moved, at = self._z + steps[: len(self._z)], 0
        for misfit in self._misfits:
            yield misfit, moved[at : at + len(misfit.vector)]
            at += len(misfit.vector)

    def answered(
        self,
        errors: np.ndarray,
        columns: np.ndarray | None = None,
        low: np.ndarray | None = None,
        high: np.ndarray | None = None,
    ) -> tuple[float, np.ndarray]:
        """Least cost of changed errors when the calibration, and `columns` beside it, may answer in bounds.

        Parameters
        ----------
        errors : ndarray of shape (n_errors,)
        columns : ndarray of shape (n_errors, m), default=None
            Derivatives with regard to something else that may move.
        low, high : ndarray of shape (m,), default=None
            How far that may move.

        Returns
        -------
        cost : float
        steps : ndarray of shape (n_parameters + m,)
        """
        if columns is None:
            return least_within(self._slopes, errors, self._low, self._high)
        lowest, highest = np.concatenate([self._low, low]), np.concatenate([self._high, high])
        return least_within(np.vstack([self._slopes, columns.T]), errors, lowest, highest)

    def gain_at_any_size(self, errors: np.ndarray) -> tuple[float, float]:
        """What a change gains at the best share of it up to one and a half, and at the best whatsoever."""
        change = (errors - self.errors)[:, None]
        if not np.any(change):
            return 0.0, 0.0
        cost, steps = self.answered(errors, change, np.array([-np.inf]), np.array([np.inf]))
        # it gains nothing at no size at least
        promised = max(self.cost - cost, 0.0)
        if -1.0 <= steps[-1] <= 0.5:
            return promised, promised
        cost, _ = self.answered(errors, change, np.array([-1.0]), np.array([0.5]))
        return self.cost - cost, promised

    def share_of(self, errors: np.ndarray) -> tuple[float, float]:
        """Best share of a change, of either sign, and its standard deviation, the calibration answering.

        Parameters
        ----------
        errors : ndarray of shape (n_errors,)
            With the change.

        Returns
        -------
        share, deviation : float
            The deviation is infinite where the calibration can do all that the change does.
        """
        change = errors - self.errors
        shared = self._slopes @ (self._weights * change)
        square = float(self._weights @ change**2)
        information = square - float(shared @ self._inverse @ shared)
        if information <= 1e-6 * square or information <= 0.0:
            return 0.0, np.inf
        towards = -float((self._weights * change) @ self.errors)
        towards += float(shared @ self._inverse @ (self._slopes @ (self._weights * self.errors)))
        return towards / information, information**-0.5

    def likeliest_onset(self, errors: np.ndarray, grows: bool = False) -> tuple[float, float]:
        """From when on a change gains most at the best share of it, and what, to second order.

        What grows from its onset on begins with no jump there: whitened it is, from some rows on, as if it
        had grown from the first row on.
        """
        towards, square = np.zeros(self.n), np.zeros(self.n)
        shared = np.zeros((len(self._slopes), self.n))
        changes = self._by_channel(errors - self.errors)
        for change, (onset, columns, answers) in zip(changes, self._onsets, strict=True):
            states = np.zeros((self.n, 2)) if grows else onset.states(change)
            square += onset.squares(change, states)
            products = onset.products(change, states, columns, answers)
            towards -= products[0]
            shared += products[1:]
        left = square - np.einsum("ji,jk,ki->i", shared, self._inverse, shared, optimize=True)
        left = np.maximum(left, 1e-3 * square + 1e-12)
        share = np.clip(towards / left, 0.0, 1.5)
        gains = share * towards - 0.5 * share**2 * left
        first, last = int(FIRST_ONSET * self.n), int(LAST_ONSET * self.n)
        k = first + int(np.argmax(gains[first:last]))
        return float(gains[k]), float(self.clock[k])

    @cached_property
    def _onsets(self) -> list[tuple[WhitenedOnset, np.ndarray, np.ndarray]]:
        """Of each channel the sums from an onset on, its errors and derivatives, and their answers."""
        noises = [misfit.noise[c] for misfit in self._misfits for c in misfit.channels]
        weights, errors = self._by_channel(self._weights), self._by_channel(self.errors)
        onsets = []
        for noise, weight, error, *slopes in zip(
            noises, weights, errors, *map(self._by_channel, self._slopes), strict=True
        ):
            onset, columns = WhitenedOnset(noise, weight), np.stack([error, *slopes])
            onsets.append((onset, columns, onset.answers(columns)))
        return onsets

    def _by_channel(self, each: np.ndarray) -> np.ndarray:
        """Rows of errors, channel by channel, without the priors."""
        return each[: len(self.errors) - len(self._priors)].reshape(-1, self.n)

    def values(self, steps: np.ndarray) -> dict[str, float]:
        """Values of the calibration after steps."""
        values: dict[str, float] = {}
        for misfit, z in self._after(steps):
            values |= misfit.vector.values(z)
        return values

    def predictions(self, changed: dict[str, np.ndarray], steps: np.ndarray) -> dict[str, np.ndarray]:
        """Changed predictions after steps of the calibration."""
        return {c: changed[c] + steps[span] @ raw for c, (span, raw) in self._raw.items()}


def _derivatives(misfit: Misfit) -> dict[str, Any]:
    """Errors of one group at its calibration, and their derivatives, whitened and raw."""
    vector = misfit.vector
    z = vector.pack(misfit.fixed)
    base = misfit.predictions(z)
    whitened, priors = misfit.whitened(base), vector.prior_residuals(z)
    moved, reach = misfit.neighbours(z)
    slopes = np.empty((len(z), len(whitened) + len(priors)))
    raw = {c: np.empty((len(z), len(base[c]))) for c in misfit.channels}
    for j, (m, r) in enumerate(zip(moved, reach, strict=True)):
        beside = misfit.predictions(m)
        slopes[j, : len(whitened)] = (misfit.whitened(beside) - whitened) / r
        slopes[j, len(whitened) :] = (vector.prior_residuals(m) - priors) / r
        for c in misfit.channels:
            raw[c][j] = (beside[c] - base[c]) / r
    return {
        "z": z,
        "low": vector.low,
        "high": vector.high,
        "whitened": whitened,
        "priors": priors,
        "slopes": slopes,
        "raw": raw,
    }
