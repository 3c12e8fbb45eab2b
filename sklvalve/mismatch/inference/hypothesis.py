# SPDX-License-Identifier: BSD-3-Clause
"""What is fitted: a set of effects, each from its onset on, and what the fit made of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.effects.base import Effect
from sklvalve.simulation.chain import Chain

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from sklvalve.mismatch.inference.problem import Problem

# what an onset must gain, and every other switch: it is one of as many as there are rows
SWITCH_PENALTY = 10.0

# an onset is looked for between these shares of the record: before and after there is too little to compare
FIRST_ONSET, LAST_ONSET = 0.04, 0.96


@dataclass(frozen=True, eq=False)
class Term:
    """An effect in a hypothesis.

    Parameters
    ----------
    effect : Effect
    onset : float or None
        Absolute time from which on it acts [s]; None from before the recording.
    switches : tuple of float
        Later times at which it stops, begins again, and so on [s, absolute].
    """

    effect: Effect
    onset: float | None = None
    switches: tuple[float, ...] = ()

    @property
    def sign(self) -> tuple[str, float | None, tuple[float, ...]]:
        """What tells this term from others."""
        return (self.effect.key, self.onset, self.switches)

    @property
    def times(self) -> Any:
        """When it begins, or begins, stops, begins again [s, absolute]; None from before the recording on."""
        return self.onset if not self.switches else (self.onset, *self.switches)


def may_come_and_go(effect: Effect) -> bool:
    """Whether an effect may act in spells.

    What grows has a time profile of its own.
    """
    return effect.may_begin and not effect.grows


def begun(effect: Effect, times: ArrayLike | None) -> Term:
    """Term of an effect that acts as `Term.times` of another one says, as far as it can."""
    if not effect.may_begin:
        return Term(effect)
    first, *later = np.atleast_1d(times).tolist() if times is not None else (None,)
    return Term(effect, first, tuple(later) if may_come_and_go(effect) else ())


@dataclass(frozen=True, eq=False)
class Model:
    """A hypothesis fitted jointly with the calibration.

    Attributes
    ----------
    terms : tuple of Term
    chain : Chain
    values : dict
        Every parameter's value.
    predictions : dict
        Channel -> simulated signal.
    log_likelihood : float
    spreads : dict
        Parameter name -> standard deviation, of the logarithm where the parameter moves by that.
    """

    terms: tuple[Term, ...]
    chain: Chain
    values: dict[str, float]
    predictions: dict[str, np.ndarray]
    log_likelihood: float
    spreads: dict[str, float]

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of its effects."""
        return tuple(m.effect.key for m in self.terms)


def is_in(effect: Effect, terms: Iterable[Term]) -> bool:
    """Whether an effect, or one of the same equation, is among the terms of a hypothesis."""
    return any(
        effect.name == m.effect.name or (effect.family and effect.family == m.effect.family) for m in terms
    )


def parameter_values(term: Term, model: Model) -> dict[str, float]:
    """Parameters of one effect in a fitted model, by their short names."""
    return {q.name: model.values[f"{term.effect.key}.{q.name}"] for q in term.effect.parameters}


def complexity_penalty(problem: Problem, term: Term) -> float:
    """Log likelihood that the parameters of an effect must earn (half a log of the rows for each)."""
    rows = max(len(problem.recording), 50)
    cost = 0.5 * len(term.effect.parameters) * np.log(rows)
    return cost + SWITCH_PENALTY * switches_of(term)


def switches_of(term: Term) -> int:
    """Number of times at which an effect begins or stops within the recording."""
    return 0 if term.onset is None else 1 + len(term.switches)


def penalised_likelihood(problem: Problem, model: Model) -> float:
    """Log likelihood of a hypothesis less the price of its effects."""
    return model.log_likelihood - sum(complexity_penalty(problem, m) for m in model.terms)
