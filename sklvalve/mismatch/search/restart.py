# SPDX-License-Identifier: BSD-3-Clause
"""Actuator effects tried from a restart, where the calibration has bent to make up for one.

What is open in the response of an actuator is enough to hide half of an effect. The calibration then lies in
a valley of its own, from where the effect seems to help little, and what it leaves over passes for noise that
lasts. Where much of the opening is left, the effects are tried without regard to either: under white noise,
so that a stroke missed for long weighs as much as it is wide, and also from a sound actuator.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.inference.hypothesis import Model, penalised_likelihood
from sklvalve.mismatch.search.onset import fit_with_onset
from sklvalve.mismatch.search.onset_sample import to_the_sample
from sklvalve.mismatch.search.screening import FITTED, screened
from sklvalve.simulation.given import ACTUATOR_STAGES
from sklvalve.simulation.parallel_map import parallel_map

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

# steps of a rough fit
_STEPS = 6
# what explains a residual this large leaves this share of it at most, mean square
_LEFT = 0.5


def much_is_left(problem: Problem, model: Model) -> bool:
    """Whether a hypothesis without any actuator effect leaves more of the opening than counts.

    Parameters
    ----------
    problem : Problem
    model : Model

    Returns
    -------
    much : bool
    """
    if "opening" not in problem.channels or any(m.effect.stage in ACTUATOR_STAGES for m in model.terms):
        return False
    return _left_of_opening(problem, model) > problem.least("opening") ** 2


def restarted(problem: Problem, model: Model, effects: Sequence[Effect]) -> list[Model]:
    """Hypotheses with one actuator effect more, wherever the calibration of the hypothesis so far lies.

    Parameters
    ----------
    problem : Problem
    model : Model
        The hypothesis so far.
    effects : sequence of Effect
        Candidates.

    Returns
    -------
    found : list of Model
        Those that leave half of the opening's residual or less (mean square), what leaves least first, under
        the noise of the problem.
    """
    bent = [e for e in effects if e.stage in ACTUATOR_STAGES]
    if not bent:
        return []
    bases = [model, *([problem.sound(model)] if problem.sound_values else [])]
    met: dict[str, list[Model]] = {}
    white = problem.homoscedastic(model)
    for base in bases:
        begin = white.fit(model.terms, start=base, max_steps=_STEPS)
        # each from every calibration: none leaves a race in which it stands once
        for m in screened(white, begin, bent, always=bent):
            met.setdefault(m.terms[-1].effect.key, []).append(m)
    best = sorted(
        met.values(), key=lambda each: max(penalised_likelihood(white, m) for m in each), reverse=True
    )
    near = [m for each in best[:FITTED] for m in each]
    rough = list(parallel_map(lambda m: white.fit(m.terms, start=m, max_steps=_STEPS), near))
    chosen: dict[str, Model] = {}
    for m in sorted(rough, key=lambda m: penalised_likelihood(white, m), reverse=True):
        chosen.setdefault(m.terms[-1].effect.key, m)
    fitted = list(parallel_map(lambda m: _to_the_end(white, model, m), chosen.values()))
    fitted = list(parallel_map(lambda m: _judged(problem, m), fitted))
    most = _LEFT * _left_of_opening(problem, model)
    left = [(_left_of_opening(problem, m), m) for m in fitted]
    return [m for size, m in sorted(left, key=lambda each: each[0]) if size <= most]


def _judged(problem: Problem, model: Model) -> Model:
    """A hypothesis under the noise of the problem, fitted from more than where white noise has led it.

    Where the simulated stem hunts, no step of a fit gains anything: so the positioner is begun anew too, as
    it stands in a data sheet and as most rows have it.
    """
    anew = {name: value for name, value in model.values.items() if name != "actuator_loop"}
    starts = [model.values, anew]
    if problem.sound_values:
        starts.append(model.values | problem.sound_values)
    fits = [problem.fit(model.terms, start=replace(model, values=values)) for values in starts]
    most = max(2.0 * _left_of_opening(problem, model), 0.0)
    near = [m for m in fits if _left_of_opening(problem, m) <= most]
    return max(near or fits[:1], key=lambda m: m.log_likelihood)


def _left_of_opening(problem: Problem, model: Model) -> float:
    """Mean square of what a hypothesis leaves of the opening, beyond the sensor's own noise."""
    floor = problem.noise["opening"].floor
    return float(np.nanmean(problem.residuals(model)["opening"] ** 2)) - floor**2


def _to_the_end(problem: Problem, model: Model, rough: Model) -> Model:
    last = rough.terms[-1]
    fitted = problem.fit(rough.terms, start=rough)
    if last.onset is None:
        return fitted
    answered = replace(model, values=fitted.values)
    begun = fit_with_onset(problem, answered, last.effect, onset=last.onset, max_steps=15)
    return to_the_sample(problem, max(fitted, begun, key=lambda m: m.log_likelihood))
