# SPDX-License-Identifier: BSD-3-Clause
"""Hypotheses with one effect more: all are screened, the most promising fitted."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from sklvalve.mismatch.inference.calibrating import expected_values
from sklvalve.mismatch.inference.hypothesis import Model, is_in, penalised_likelihood
from sklvalve.mismatch.search.intermittent import intermittent
from sklvalve.mismatch.search.onset import fit_with_onset
from sklvalve.mismatch.search.onset_sample import to_the_sample
from sklvalve.mismatch.search.screening import FITTED, screened
from sklvalve.simulation.given import ACTUATOR_STAGES
from sklvalve.simulation.parallel_map import parallel_map

if TYPE_CHECKING:
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.inference.problem import Problem

    Report = Callable[[float], object]

# of those begun where a history expects the valve so many are fitted
_FROM_WHAT_IS_KNOWN = 2


def extended(
    problem: Problem, model: Model, effects: Sequence[Effect], report: Report | None, done: float
) -> tuple[list[Model], list[Model]]:
    """Hypotheses with one effect more, best first: all screened, the most promising fitted.

    Of each effect the best one; and all whose effect acts throughout, the likeliest first.
    """
    usable = [e for e in effects if not is_in(e, model.terms)]
    shown = report and (lambda share: report(done + 0.1 * share))
    every = screened(problem, model, usable, also=_of_a_sound_stem(problem, model, usable), report=shown)
    if problem.history is not None:
        every += _from_what_is_known(problem, model, usable)
    rough = _best_of_each(problem, every)
    onset = rough[0].terms[-1].onset if rough else None
    refined: list[Model] = []
    for m in parallel_map(lambda m: _refine(problem, model, m, onset), rough[:FITTED]):
        refined.append(m)
        if report:
            report(done + 0.1 + 0.1 * len(refined) / FITTED)
    acting = [m for m in (*every, *refined) if m.terms[-1].onset is None]
    tried = refined + rough[FITTED:]
    best = sorted(tried, key=lambda m: penalised_likelihood(problem, m), reverse=True)
    return best, sorted(acting, key=lambda m: m.log_likelihood, reverse=True)


def _of_a_sound_stem(
    problem: Problem, model: Model, effects: Sequence[Effect]
) -> list[tuple[Model, list[Effect]]]:
    """The actuator as most rows have it, with the effects to be screened from there.

    Calibrated to what lacks an effect, an actuator may lie where that effect no longer helps.
    """
    bent = [e for e in effects if e.stage in ACTUATOR_STAGES]
    if not bent or any(m.effect.stage in ACTUATOR_STAGES for m in model.terms):
        return []
    return [(problem.sound(model), bent)]


def _from_what_is_known(problem: Problem, model: Model, effects: Sequence[Effect]) -> list[Model]:
    """The likeliest two hypotheses with one effect more, fitted from where a history expects the valve.

    Calibrated to what lacks an effect, all that a history knows sharply may lie where the effect no longer
    helps. What effects gain there, before anything else has moved, tells them apart best.
    """
    base = problem.judged(problem.simulate(model.terms, model.values | expected_values(problem)))
    best = _best_of_each(problem, screened(problem, base, effects))[:_FROM_WHAT_IS_KNOWN]
    return list(parallel_map(lambda m: problem.fit(m.terms, start=m), best))


def _best_of_each(problem: Problem, tried: Iterable[Model]) -> list[Model]:
    """Of every effect its best hypothesis, the best first."""
    best: dict[str, Model] = {}
    for m in sorted(tried, key=lambda m: penalised_likelihood(problem, m), reverse=True):
        best.setdefault(m.terms[-1].effect.key, m)
    return list(best.values())


def _refine(problem: Problem, before: Model, model: Model, other_onset: float | None) -> Model:
    """The last effect with the whole calibration free; one that begins, also from where the best one does."""
    last = model.terms[-1]
    if last.onset is None:
        return intermittent(problem, problem.fit(model.terms, start=model))
    without = Model(before.terms, before.chain, model.values, before.predictions, before.log_likelihood, {})
    onsets = {last.onset, last.onset if other_onset is None else other_onset}
    fits = [fit_with_onset(problem, without, last.effect, onset=o, max_steps=15) for o in sorted(onsets)]
    best = to_the_sample(problem, max(fits, key=lambda m: m.log_likelihood))
    return intermittent(problem, best)
