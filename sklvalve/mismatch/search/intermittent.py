# SPDX-License-Identifier: BSD-3-Clause
"""Effects that come and go: their spells, found one switch after the other."""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

import numba as nb
import numpy as np

from sklvalve.mismatch.inference.hypothesis import (
    SWITCH_PENALTY,
    Model,
    Term,
    begun,
    may_come_and_go,
    penalised_likelihood,
)
from sklvalve.simulation.robust import ROBUST_FROM, robust_cost

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

# a spell, or a pause, is at least so many rows; more of them than this are noise
_FEWEST_ROWS, _MOST = 20, 16
# rows between two places at which a switch is tried first
_EVERY = 10
# rows behind a switch that speak of it
_BEHIND = 150
# a switch gains this share of what the best one gains, and so many times its price
_SHARE, _CLEAR = 0.1, 1.5
# rounds of finding the spells and fitting the size within them
_ROUNDS = 3
# places at which a spell or a pause more may begin and end, and those between two of them
_PLACES, _BETWEEN = 36, 10


def intermittent(problem: Problem, model: Model) -> Model:
    """The same hypothesis with its last effect acting in spells, where that is worth the switches.

    Parameters
    ----------
    problem : Problem
    model : Model

    Returns
    -------
    model : Model
        The one given where nothing is gained.
    """
    *others, last = model.terms
    if not may_come_and_go(last.effect):
        return model
    for _ in range(_ROUNDS):
        term = episodes_of(problem, model)
        if term is None or term.sign == model.terms[-1].sign:
            break
        fitted = problem.fit((*others, term), start=model)
        if penalised_likelihood(problem, fitted) <= penalised_likelihood(problem, model) + SWITCH_PENALTY:
            break
        model = fitted
    if len(model.terms[-1].switches) > 1:
        model = _with_further_episodes(problem, model)
    return _without_needless(problem, model)


def _with_further_episodes(problem: Problem, model: Model) -> Model:
    """The same with more spells, or pauses, the likeliest first, as long as they are worth their switches.

    An end that little shows, as where little flows, is not clear by itself; with the beginning that follows
    it may be.
    """
    *others, last = model.terms
    while True:
        switches = _SwitchSearch(problem, model, tuple(others), last).toggled(last)
        if not 0 < len(switches) <= _MOST:
            return model
        fitted = problem.fit((*others, begun(last.effect, model.chain.clock[switches])), start=model)
        if penalised_likelihood(problem, fitted) <= penalised_likelihood(problem, model):
            return model
        model, last = fitted, fitted.terms[-1]


def _without_needless(problem: Problem, model: Model) -> Model:
    """The same without spells, and pauses, that are not worth their switches."""
    *others, last = model.terms
    k = 0
    # one beginning is left at least
    while k < len(last.switches) and len(last.switches) > 1:
        times = (*last.times[:k], *last.times[k + 2 :])
        fewer = problem.fit((*others, begun(last.effect, times)), start=model)
        if penalised_likelihood(problem, fewer) > penalised_likelihood(problem, model):
            model, last = fewer, fewer.terms[-1]
        else:
            k += 1
    return model


def episodes_of(problem: Problem, model: Model) -> Term | None:
    """The last effect, switched on and off where the recording jumps as much; None where it does once.

    A noise model with wander follows whatever lasts, so that only the rows after a switch speak of it. The
    next switch is the first one that is clear.

    Parameters
    ----------
    problem : Problem
    model : Model

    Returns
    -------
    term : Term or None
    """
    *others, last = model.terms
    search = _SwitchSearch(problem, model, tuple(others), last)
    switches: list[int] = []
    state = last.onset is None
    while len(switches) <= _MOST:
        k = search.next_switch(switches[-1] + _FEWEST_ROWS if switches else _FEWEST_ROWS, state)
        if k is None:
            break
        search.switch(k, state)
        switches.append(k)
        state = not state
    if last.onset is None and switches:
        switches.insert(0, 0)
    if not 2 <= len(switches) <= _MOST:
        return None
    return begun(last.effect, model.chain.clock[switches])


class _SwitchSearch:
    """Residuals of a hypothesis while the switches of its last effect are searched, from the first row on."""

    def __init__(self, problem: Problem, model: Model, others: tuple[Term, ...], last: Term) -> None:
        self.noise, self.channels = problem.noise, problem.channels_touched(last.effect)
        off, on = (problem.simulate(terms, model.values) for terms in (others, (*others, Term(last.effect))))
        left = [problem.residuals(m) for m in (off, on)]
        self.rows = len(problem.recording)
        # what the effect adds to the simulation, where both are known
        self.adds = {c: left[0][c] - left[1][c] for c in self.channels}
        self.left = {c: left[last.onset is None][c].copy() for c in self.channels}
        self._off, self._on, self._clock = left[0], left[1], model.chain.clock

    def _gains(self, rows: np.ndarray, state: bool) -> np.ndarray:
        """What a switch at each row gains over the rows behind it; what comes later may be the next one's."""
        gains, sign = np.zeros(len(rows)), 1.0 if state else -1.0
        for c in self.channels:
            white, adds = self.noise[c].whiten(self.left[c]), self.adds[c] + 0.0 * self.left[c]
            for low, high, gain, keep, spread in self.noise[c].pieces:
                part = slice(low, high)
                gains += _gains_behind(rows - low, gain, keep, spread, white[part], sign * adds[part])
        return gains

    def next_switch(self, first: int, state: bool) -> int | None:
        """Row of the next switch; None where none gains its price."""
        places = np.arange(first, self.rows - _FEWEST_ROWS, _EVERY)
        if not len(places):
            return None
        gains = self._gains(places, state)
        enough = max(_SHARE * gains.max(), _CLEAR * SWITCH_PENALTY)
        if gains.max() < enough:
            return None
        k = int(np.argmax(gains >= enough))
        while k + 1 < len(gains) and gains[k + 1] > gains[k]:
            k += 1
        near = np.arange(max(places[k] - _EVERY, first), min(places[k] + _EVERY, self.rows - 1) + 1)
        return int(near[np.argmax(self._gains(near, state))])

    def toggled(self, term: Term) -> np.ndarray:
        """Rows at which a term switches with the spell, or pause, more that leaves the least loss."""
        rows, begins = np.arange(self.rows), np.searchsorted(self._clock, term.times)
        state = np.searchsorted(begins, rows, side="right") % 2 == 1

        def least(first: np.ndarray, last: np.ndarray) -> tuple[int, int]:
            pairs = [(a, b) for a in first for b in last if b - a >= _FEWEST_ROWS]
            return min(pairs, key=lambda each: self._loss(state ^ ((rows >= each[0]) & (rows < each[1]))))

        places = np.linspace(0, self.rows, _PLACES + 1).astype(int)
        near = np.linspace(-1.0, 1.0, 2 * _BETWEEN + 1) * self.rows / _PLACES
        around = [np.clip(k + near.astype(int), 0, self.rows) for k in least(places, places)]
        begin, end = least(*around)
        return np.flatnonzero(np.diff(state ^ ((rows >= begin) & (rows < end)), prepend=False))

    def _loss(self, acts: np.ndarray) -> float:
        """Robust loss where the effect acts in some rows."""
        left = (self.noise[c].whiten(np.where(acts, self._on[c], self._off[c])) for c in self.channels)
        return float(sum(robust_cost(each) for each in left))

    def switch(self, k: int, state: bool) -> None:
        """Keep a switch: from a row on the effect is in the other state."""
        sign = 1.0 if state else -1.0
        for c in self.channels:
            self.left[c][k:] += sign * self.adds[c][k:]


@nb.njit(cache=True, nogil=True)
def _gains_behind(
    rows: np.ndarray,
    gain: np.ndarray,
    keep: np.ndarray,
    spread: np.ndarray,
    white: np.ndarray,
    adds: np.ndarray,
) -> np.ndarray:
    """Robust loss that something added from a row on takes off the rows next behind it, for each row.

    A filter is linear: what is added is whitened from its row on and laid over the whitened residual.
    """
    gains = np.zeros(len(rows))
    for j in range(len(rows)):
        fast = slow = total = 0.0
        for k in range(max(rows[j], 0), min(rows[j] + _BEHIND, len(white))):
            fast *= keep[k, 0]
            slow *= keep[k, 1]
            if spread[k] == np.inf or adds[k] != adds[k]:
                continue
            left = adds[k] - fast - slow
            fast += gain[k, 0] * left
            slow += gain[k, 1] * left
            new = (white[k] + left / spread[k]) / ROBUST_FROM
            old = white[k] / ROBUST_FROM
            total += sqrt(1.0 + old * old) - sqrt(1.0 + new * new)
        gains[j] = ROBUST_FROM**2 * total
    return gains
