# SPDX-License-Identifier: BSD-3-Clause
"""Which effects are worth a fit: each at several finite sizes, the calibration answering to first order.

A score test asks what an infinitely small effect would gain. A dead band has no slope at zero, and of a full
fit for every effect, size and onset most would be wasted. In between: the effect's own few parameters are
fitted by simulation, while the calibration, some twenty parameters, answers through the derivatives of the
calibrated simulation, taken once and kept within the bounds of the data sheet.

It is a race: before every step those leave that cannot come among the best any more, most before the first.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.inference.hypothesis import Model, Term, begun, complexity_penalty
from sklvalve.mismatch.inference.linearised import Linearised
from sklvalve.simulation.fitting import Misfit
from sklvalve.simulation.parallel_map import parallel_map

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

# steps of an effect's own parameters; a fit of all that is promising follows
_STEPS = 3
#: Of the effects screened so many are fitted, by whoever asks: none of these may be lost.
FITTED = 4
# so many times what its start promises a trial comes to at most: 2.5 times in 98 % of those among the best
_AT_MOST = 3.0


def screened(
    problem: Problem,
    model: Model,
    effects: Sequence[Effect],
    *,
    onset: Any = False,
    also: Sequence[tuple[Model, Sequence[Effect]]] = (),
    always: Sequence[Effect] = (),
    report: Callable[[float], object] | None = None,
) -> list[Model]:
    """Hypotheses with one effect more, to first order in the calibration, the most likely first.

    Parameters
    ----------
    problem : Problem
    model : Model
        A fitted hypothesis.
    effects : sequence of Effect
    onset : float, tuple, None or False, default=False
        When the effects begin, stop, begin again [s, absolute], None from before the recording; by default
        each effect is tried throughout and, where it may begin within the recording, from its likeliest onset
        on.
    also : sequence of (Model, sequence of Effect), default=()
        Other calibrations, and the effects that are tried from there too.
    always : sequence of Effect, default=()
        Those that are fitted later whatever they promise.
    report : callable, default=None
        Called with the share done.

    Returns
    -------
    tried : list of Model
        One or two for each effect and calibration, their log likelihoods to first order; without those that
        cannot come among the best.
    """
    starts = [each for base in ((model, effects), *also) for each in _lines(problem, *base)]
    left: list[Trial] = []
    staying = {e.key for e in always}
    for i, trials in enumerate(parallel_map(lambda each: _of_one_effect(problem, each, onset), starts)):
        left += trials
        if report:
            # the starts take about as long as all steps
            report(0.5 * (i + 1) / len(starts))
    for k in range(_STEPS):
        left = _within_reach(left, staying)
        for _ in parallel_map(Trial.step, left):
            pass
        if report:
            report(0.5 + 0.5 * (k + 1) / _STEPS)
    return sorted((t.hypothesis() for t in left), key=lambda m: m.log_likelihood, reverse=True)


def _lines(
    problem: Problem, model: Model, effects: Sequence[Effect]
) -> list[tuple[Model, Linearised, Effect]]:
    """Each effect that changes a channel with the hypothesis, linearised for the channels that it changes."""
    touched = {e.key: problem.channels_touched(e) for e in effects}
    lines = {t: Linearised(problem, model, t) for t in dict.fromkeys(touched.values()) if t}
    return [(model, lines[touched[e.key]], e) for e in effects if touched[e.key]]


def _of_one_effect(problem: Problem, start: tuple[Model, Linearised, Effect], onset: Any) -> list[Trial]:
    model, line, effect = start
    fixed = onset is not False
    trial = Trial(problem, model, line, begun(effect, onset) if fixed else Term(effect))
    starts = trial.starts()
    made = trial.simulated(starts)
    gains = [line.gain_at_any_size(errors) for _, errors in made]
    k = int(np.argmax([gain for gain, _ in gains]))
    trial.begin(starts[k], made[k][0], gains[k][0], max(promise for _, promise in gains))
    if not effect.may_begin or fixed:
        return [trial]
    best = [line.likeliest_onset(errors, effect.grows) for _, errors in made]
    k = int(np.argmax([gain for gain, _ in best]))
    late = Trial(problem, model, line, Term(effect, best[k][1]))
    [(predictions, errors)] = late.simulated([starts[k]])
    late.begin(starts[k], predictions, *line.gain_at_any_size(errors))
    return [trial, late]


def _within_reach(trials: Sequence[Trial], staying: set[str]) -> list[Trial]:
    """Trials that may yet come among the best, as far as they promise, and those of effects that stay."""
    best: dict[str, float] = {}
    for t in trials:
        best[t.key] = max(t.penalised_likelihood, best.get(t.key, -np.inf))
    last = min(sorted(best.values())[-FITTED:], default=-np.inf)
    return [t for t in trials if t.reach >= last or t.key in staying]


class Trial:
    """An effect added to a linearised hypothesis, and how far the fit of its own parameters has come.

    Parameters
    ----------
    problem : Problem
    model : Model
    line : Linearised
    term : Term

    Attributes
    ----------
    gain : float
        Log likelihood that the effect adds to the hypothesis.
    promise : float
        What it would add if it went on as it begins, at any size of either sign.
    """

    def __init__(self, problem: Problem, model: Model, line: Linearised, term: Term) -> None:
        self.model, self.line, self.term = model, line, term
        self.chain = problem.chain((*model.terms, term))
        self.quantities = term.effect.quantities(self.chain)
        self.misfit = self._misfit(problem, 0)
        self._problem, self._penalty = problem, complexity_penalty(problem, term)
        self._settled = False
        self._cost: float | None = None

    def _misfit(self, problem: Problem, attempt: int) -> Misfit:
        parameters = [q.parameter_of(self.key, attempt) for q in self.quantities]
        return Misfit(
            self.chain,
            parameters,
            self.line.channels,
            problem.noise,
            fixed=self.model.values,
            rows=problem.rows,
        )

    @property
    def key(self) -> str:
        """Key of its effect."""
        return self.term.effect.key

    @property
    def penalised_likelihood(self) -> float:
        """Log likelihood of the hypothesis with the effect, less its price."""
        return self.model.log_likelihood + self.gain - self._penalty

    @property
    def reach(self) -> float:
        """What it may come to be worth."""
        return self.model.log_likelihood + _AT_MOST * max(self.gain, self.promise) - self._penalty

    def starts(self) -> list[np.ndarray]:
        """Where the effect's own fits begin."""
        many = max(len(q.starts) for q in self.quantities)
        return [self._inside(self._misfit(self._problem, k).vector.pack({})) for k in range(many)]

    def _inside(self, z: np.ndarray) -> np.ndarray:
        vector = self.misfit.vector
        inside = 1e-6 * (vector.high - vector.low)
        return np.clip(z, vector.low + inside, vector.high - inside)

    def simulated(self, several: Sequence[np.ndarray]) -> list[tuple[dict[str, np.ndarray], np.ndarray]]:
        """Predictions and whitened residuals with the effect's parameters at several points."""
        if "opening" in self.line.channels:
            self.chain.free_runs_ahead([self.misfit.values(z) for z in several])
        made = [self.misfit.predictions(z) for z in several]
        return [(predictions, self._errors_of(predictions)) for predictions in made]

    def _errors_of(self, predictions: dict[str, np.ndarray]) -> np.ndarray:
        return self.line.with_priors(self.misfit.whitened(predictions))

    def begin(self, z: np.ndarray, predictions: dict[str, np.ndarray], gain: float, promise: float) -> None:
        """Put the effect's parameters at a start that was simulated."""
        self._z, self._predictions, self.gain, self.promise = z, predictions, gain, promise

    def step(self) -> None:
        """One step of the effect's own parameters."""
        if self._settled:
            return
        line, vector, z, errors = self.line, self.misfit.vector, self._z, self._errors_of(self._predictions)
        if self._cost is None:
            self._cost, self._answer = line.answered(errors)
        before = self._cost
        moved, reach = self.misfit.neighbours(z)
        beside = [self._errors_of(self.misfit.predictions(m)) for m in moved]
        columns = np.stack([(e - errors) / r for e, r in zip(beside, reach, strict=True)], axis=1)
        _, joint = line.answered(errors, columns, vector.low - z, vector.high - z)
        for share in (1.0, 0.3):
            if self._moved_to(self._inside(z + share * joint[-len(z) :])):
                break
        self.gain = line.cost - self._cost
        self._settled = before - self._cost < 0.5 + 1e-3 * self._cost

    def _moved_to(self, z: np.ndarray) -> bool:
        """Whether another point is likelier; if so, the trial stands there."""
        [(predictions, errors)] = self.simulated([z])
        cost, answer = self.line.answered(errors)
        assert self._cost is not None
        if cost >= self._cost:
            return False
        self._z, self._predictions, self._cost, self._answer = z, predictions, cost, answer
        return True

    def hypothesis(self) -> Model:
        """The hypothesis with the effect as far as it has come."""
        values = self.model.values | self.line.values(self._answer) | self.misfit.vector.values(self._z)
        made = self.line.predictions(self._predictions, self._answer)
        return Model(
            (*self.model.terms, self.term),
            self.chain,
            values,
            self.model.predictions | made,
            self.model.log_likelihood + self.gain,
            {},
        )
