# SPDX-License-Identifier: BSD-3-Clause
"""Whether a hypothesis explains a flow down to its noise: one that only imitates what is missing does not.

An effect of no catalogue takes the name of the one that imitates it best, and the noise model hides what the
imitation leaves: learnt from that very residual, it takes it for wander. So the residual is held against
noise in which no hypothesis has a part, that of stretches in which the valve rests.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2

from sklvalve.mismatch.constants import LEAST_P_VALUE, SHARE_WRONG, TIMES_ALLOWED
from sklvalve.mismatch.search.screening import FITTED, screened
from sklvalve.mismatch.signals.steady import drivers_of, steady_floor
from sklvalve.recording.dead_bands import step_of
from sklvalve.simulation.calibration import drop_is_unknown
from sklvalve.simulation.slow_residual import LENGTH, by_stretches, moves_little, slow_means

if TYPE_CHECKING:
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.explain import Explanation
    from sklvalve.mismatch.search.rivals import Finding
    from sklvalve.recording import Recording

# a healthy simulation is slowly wrong by this share of what counts as an effect
_INADEQUACY = 0.25
# a hypothesis that leaves too much is doubtful, and with this p-value not what happened
_CLEARLY = 0.05
# where no effect was found at all, wander of a meter is likelier: it may be so many times the quick noise,
# and the alarm, which nothing else raises, asks for this share of alpha
_WANDER, _OF_ALPHA = 1.5, 0.1
#: A slow residual is known from so many stretches at least.
FEWEST = 8
# what is left over says nothing against a judgement, makes it doubtful, or refutes it
FINE, DOUBTFUL, REFUTED = "fine", "doubtful", "refuted"
# correlations below this are chance
_CHANCE = 0.05


@dataclass(frozen=True)
class LeftOver:
    """What a hypothesis leaves over of the flow, slowly.

    Attributes
    ----------
    channel : str
    size : float
        Rms of the residual's means over stretches in which the flow moves little, share of span [1].
    noise : float
        Quick noise of the flow, share of span [1].
    allowed : float
        What may be left over, share of span [1].
    many : float
        Number of independent values that its size is known from.
    """

    channel: str
    size: float
    noise: float
    allowed: float
    many: float

    @property
    def times(self) -> float:
        """How many times what is allowed."""
        return self.size / self.allowed

    @property
    def beyond_noise(self) -> dict[str, float]:
        """Size, noise and what may be left over, shares of span [1]."""
        return {"size": self.size, "noise": self.noise, "allowed": self.allowed}

    @property
    def p_value(self) -> float:
        """Chance of a residual of this size or more where the true one is as large as is allowed."""
        return max(self._chance_of(self.times), LEAST_P_VALUE)

    def _chance_of(self, times: float) -> float:
        return float(chi2.sf(self.many * times**2, self.many))

    @property
    def too_much(self) -> bool:
        """Whether a hypothesis that leaves this may not be named."""
        return self.times > TIMES_ALLOWED

    @property
    def clearly(self) -> bool:
        """Whether that much is more than the few slow turns of a wander may come to."""
        return self.too_much and self.p_value < _CLEARLY

    def is_no_wander(self, alpha: float) -> bool:
        """Whether a simulation without any effect that leaves this lacks something."""
        wide = np.sqrt(self.allowed**2 + (_WANDER**2 - 1.0) * self.noise**2)
        return bool(self.size > wide and self._chance_of(self.size / wide) < _OF_ALPHA * alpha)


def held_against_noise(
    problem: Problem, explanation: Explanation, model: Model, findings: Sequence[Finding], alpha: float
) -> tuple[LeftOver | None, str]:
    """What a hypothesis leaves over of the flow, and what that says of the findings, or of there being none.

    Parameters
    ----------
    problem : Problem
    explanation : Explanation
    model : Model
        The hypothesis that was searched out.
    findings : list of Finding
        What stands of it.
    alpha : float
        Level of the test.

    Returns
    -------
    left : LeftOver or None
    said : {"fine", "doubtful", "refuted"}
        Where no effect on the flow is named, one of the catalogue that would explain what is left over makes
        it doubtful that there is something else.
    """
    left = left_over(problem, model, explanation.nominal)
    if imitates_any_time_profile(findings):
        return left, REFUTED
    if left is None or _leaves_little(problem, left, findings, alpha):
        return left, FINE
    if _of_flow(problem, findings):
        return left, REFUTED if left.clearly else DOUBTFUL
    known = known_effect_explains(problem, explanation.nominal, explanation.effects)
    return left, DOUBTFUL if known else REFUTED


def _leaves_little(
    problem: Problem, left: LeftOver | None, findings: Sequence[Finding], alpha: float
) -> bool:
    if left is None or not left.too_much:
        return True
    return not _of_flow(problem, findings) and not left.is_no_wander(alpha)


def _of_flow(problem: Problem, findings: Sequence[Finding]) -> bool:
    return "flow" in problem.touched_by(f.term for f in findings)


def known_effect_explains(problem: Problem, nominal: Model, effects: Sequence[Effect]) -> bool:
    """Whether one effect of the catalogue leaves no more than it may, however little noise it is given.

    The search judges by noise that may wander; what is rare, small or slow can hide in that.

    Parameters
    ----------
    problem : Problem
    nominal : Model
    effects : sequence of Effect
    """
    able = [e for e in effects if "flow" in problem.channels_touched(e)]
    white = problem.homoscedastic(nominal)
    best: dict[str, Model] = {}
    for m in screened(white, white.fit((), start=nominal, max_steps=6), able):
        best.setdefault(m.terms[-1].effect.key, m)
    fits = [white.fit(m.terms, start=m, max_steps=10) for m in list(best.values())[:FITTED]]
    residuals = [left_over(problem, m, nominal) for m in fits]
    return any(left is not None and not left.too_much for left in residuals)


def left_over(problem: Problem, model: Model, nominal: Model) -> LeftOver | None:
    r"""What a hypothesis leaves over of the flow beside what it may.

    With :math:`\sigma` the quick noise of the flow, :math:`c` the size from which on an effect counts and
    :math:`E` what the hypothesis explains (`Problem.baseline`), rms of the same means, the residual may be
    as large as

    .. math:: \sqrt{\sigma^2 + (0.25 c)^2 + (0.15 E)^2}

    so that a meter may wander by as much as it jitters, and a simulation may get a share of an effect wrong.

    Parameters
    ----------
    problem : Problem
    model, nominal : Model
        The hypothesis, and the calibrated simulation without any effect (the same where none was found).

    Returns
    -------
    left : LeftOver or None
        None where nothing can be said: without flow or position, where nothing tells the pressure drop, or
        where too few rows are at rest.
    """
    recording = problem.recording
    if "flow" not in problem.channels or problem.coupled or drop_is_unknown(recording):
        return None
    span = problem.spans["flow"]
    residual = problem.residuals(model)["flow"] / span
    shown = model.predictions["flow"] / span
    quiet = moves_little(shown, 1.0)
    slow = slow_means(residual, quiet)
    if np.isfinite(slow).sum() < FEWEST:
        return None
    noise = _quick_noise(recording, residual, quiet, span)
    if noise is None:
        return None
    bare = problem.baseline(model, (), nominal).predictions["flow"] / span
    explained = _rms(slow_means(shown - bare, quiet))
    if problem.history is not None:
        # what the healthy valve left over is no mismatch, whatever made it
        noise = max(noise, problem.history.left("flow") / span)
    parts = noise, _INADEQUACY * problem.least("flow"), SHARE_WRONG * explained
    allowed, size = float(np.sqrt(np.sum(np.square(parts)))), _rms(slow)
    return LeftOver("flow", size, noise, allowed, effective_number(slow))


def imitates_any_time_profile(findings: Sequence[Finding]) -> bool:
    """Whether several effects are named that follow time or temperature and nothing else.

    Two slow time profiles add up to nearly any third, each with a size of its own: they are found together
    where something else warms, grows or drifts, while valves rarely have two such faults at once.

    Parameters
    ----------
    findings : list of Finding
    """
    slow = [f for f in findings if f.term.effect.grows or "temperature" in f.term.effect.needs]
    return len(slow) > 1


def effective_number(series: np.ndarray) -> float:
    """Number of independent values that tell the variance of a correlated series as well (Bartlett).

    Parameters
    ----------
    series : ndarray of shape (n,)
        With a mean near zero; NaN in gaps.

    Returns
    -------
    number : float
    """
    known = np.isfinite(series)
    filled = np.where(known, series, 0.0)
    variance, squares = np.sum(filled**2) / max(known.sum(), 1), 0.0
    for lag in range(1, len(series) // 3):
        both = np.sum(known[lag:] & known[:-lag])
        correlation = np.sum(filled[lag:] * filled[:-lag]) / max(both * variance, 1e-300)
        # beyond the first lag at which nothing is left there is chance only
        if both < FEWEST // 2 or correlation < _CHANCE:
            break
        squares += correlation**2
    return float(known.sum() / (1.0 + 2.0 * squares))


def _quick_noise(recording: Recording, residual: np.ndarray, quiet: np.ndarray, span: float) -> float | None:
    """Quick noise of the flow, share of span: of stretches at rest, or else what the residual jitters."""
    driver, beside = drivers_of(recording, "flow")
    steady = steady_floor(recording["flow"], driver, beside, step_of(recording, "flow")).value
    if steady is not None:
        return steady / span
    variances = _variances_about_lines(np.where(quiet, residual, np.nan))
    # what a hypothesis gets wrong of the quick movement is no noise: the calmer stretches tell
    return float(np.sqrt(np.quantile(variances, 0.25))) if len(variances) >= FEWEST else None


def _variances_about_lines(values: np.ndarray) -> np.ndarray:
    """Scatter of stretches without a gap about a straight line each."""
    table = by_stretches(values)
    table = table[np.isfinite(table).all(axis=1)]
    table = table - table.mean(axis=1, keepdims=True)
    along = np.linspace(-1.0, 1.0, LENGTH)
    slopes = table @ along / (along @ along)
    return np.sum((table - slopes[:, None] * along) ** 2, axis=1) / (LENGTH - 2)


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.nanmean(values**2)))
