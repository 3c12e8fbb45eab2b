# SPDX-License-Identifier: BSD-3-Clause
"""What no effect of the catalogue explains: whether the rest can be predicted, from what, and how much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.mismatch.residual.cycles import find_cycle
from sklvalve.mismatch.residual.low_pass_residual import held_out_errors, low_pass_residual, skills, tuned
from sklvalve.mismatch.search.relevance import standardized_effect_size
from sklvalve.simulation.calibration import drop_is_unknown

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.residual.low_pass_residual import TunedResidual

_MOST_SHIFTS = 100
# share of the variance of the slow rest that must be predicted
_LEAST_SKILL = 0.1


@dataclass(frozen=True, eq=False)
class Unknown:
    """A predictable rest.

    Attributes
    ----------
    channel : str
    inputs : tuple of str
        Signals it depends on.
    size : float
        Rms of its prediction on held-out blocks where it acts, share of span [1].
    skill : float
        Share of the rest's slow variance that is predicted on held-out blocks [1].
    p_value : float
        Share of time-shifted inputs that predict as well.
    correction : dict
        Plain arrays of the fitted LS-SVM: centre, scale, support, coefficients, intercept, gamma.
    period : float, default=None
        Of a rest that comes back in time, and follows from nothing else [s].
    """

    channel: str
    inputs: tuple[str, ...]
    size: float
    skill: float
    p_value: float
    correction: dict[str, Any]
    period: float | None = None


def look_for_residual(
    problem: Problem,
    model: Model,
    *,
    alpha: float,
    random_state: int = 0,
    channels: Sequence[str] | None = None,
) -> tuple[Unknown | None, float | None]:
    """Look for a predictable rest in each channel.

    The rest is averaged over short stretches in which nothing moves fast, and predicted from slow signals by
    an LS-SVM on contiguous blocks that it was not fitted to. Chance is judged by the same prediction from
    inputs shifted in time against it, which keeps every correlation but the one in question.

    Parameters
    ----------
    problem : Problem
    model : Model
    alpha : float
        Level of the test.
    random_state : int
    channels : sequence of str, default=None
        Where to look; in all channels of the problem unless given.

    Returns
    -------
    unknown : Unknown or None
        The largest one that is significant and large enough to count; never one of the flow where nothing
        tells the pressure drop.
    strength : float or None
        Of the strongest rest, one that counts or not; None where none could be learnt.
    """
    rng = np.random.default_rng(random_state)
    best: Unknown | None = None
    effect_sizes: list[float] = []
    for channel in problem.channels if channels is None else channels:
        if channel == "flow" and drop_is_unknown(problem.recording):
            # without a recorded pressure drop, a flow residual mostly reflects the unmeasured drop
            continue
        slow = low_pass_residual(problem, model, channel)
        in_channel = None
        if slow is not None:
            learnt = tuned(slow)
            chance = _by_chance(learnt, rng)
            effect_sizes.append(_evidence_of(problem, channel, learnt, chance))
            in_channel = _in_channel(problem, channel, learnt, chance, alpha)
        for candidate in (in_channel, _cycle_in(problem, model, channel, alpha)):
            if candidate is not None and (best is None or candidate.size > best.size):
                best = candidate
    return best, max(effect_sizes, default=None)


def _by_chance(learnt: TunedResidual, rng: np.random.Generator) -> np.ndarray:
    """Skills with the rest shifted against its inputs: the inputs, and all that is dear about them, stay."""
    y = learnt.slow.y
    possible = np.arange(len(y) // 8, len(y) - len(y) // 8)
    shifts = rng.choice(possible, size=min(_MOST_SHIFTS, len(possible)), replace=False)
    return skills(learnt.held_out, np.column_stack([np.roll(y, s) for s in shifts]))[0]


def _evidence_of(problem: Problem, channel: str, learnt: TunedResidual, chance: np.ndarray) -> float:
    deviations = (learnt.skill - chance.mean()) / max(float(chance.std()), 1e-12)
    # without a kink where the skill is that of chance, so that no two recordings are alike
    deviations = np.logaddexp(0.0, deviations)
    return standardized_effect_size(deviations, _acting_rms(learnt.predicted) / problem.least(channel))


def _in_channel(
    problem: Problem, channel: str, best: TunedResidual, chance: np.ndarray, alpha: float
) -> Unknown | None:
    size = _acting_rms(best.predicted)
    if size < problem.least(channel) or best.skill < _LEAST_SKILL:
        return None
    p_value = (1.0 + np.sum(chance >= best.skill)) / (1.0 + len(chance))
    # no number of shifts that is cheap can show less than one in their number
    if p_value > max(alpha, 1.5 / (1.0 + len(chance))):
        return None
    matter = _inputs_that_matter(best)
    correction = best.correction(channel, problem.spans[channel])
    return Unknown(channel, matter, size, float(best.skill), float(p_value), correction)


def _cycle_in(problem: Problem, model: Model, channel: str, alpha: float) -> Unknown | None:
    """A rest of the flow that comes back in time; what makes a stem swing, the actuator's effects say."""
    cycle = find_cycle(problem, model, channel) if channel == "flow" else None
    if cycle is None or cycle.p_value > alpha:
        return None
    slow = low_pass_residual(problem, model, channel, period=cycle.period)
    if slow is None:
        return None
    best = tuned(slow)
    size = _acting_rms(best.predicted)
    if size < problem.least(channel) or best.skill < _LEAST_SKILL:
        return None
    correction = best.correction(channel, problem.spans[channel])
    inputs = (f"a cycle of {cycle.period:.3g} s", *best.names[2:])
    return Unknown(channel, inputs, size, best.skill, cycle.p_value, correction, cycle.period)


def _acting_rms(predicted: np.ndarray) -> float:
    size = np.abs(predicted)
    acting = size > 0.25 * np.quantile(size, 0.99)
    return float(np.sqrt(np.mean(predicted[acting] ** 2))) if acting.any() else 0.0


def _inputs_that_matter(tuned: TunedResidual) -> tuple[str, ...]:
    """Inputs whose loss costs a good part of the skill."""
    names, skill = tuned.names, tuned.skill
    if len(names) == 1:
        return names
    lost = []
    for i in range(len(names)):
        without = tuned.Z.copy()
        without[:, i] = 0.0
        lost.append(
            skill - skills(held_out_errors(tuned.regressor, without, tuned.slow), tuned.slow.y[:, None])[0][0]
        )
    return tuple(n for n, gone in zip(names, lost, strict=True) if gone > 0.2 * skill) or (
        names[int(np.argmax(lost))],
    )
