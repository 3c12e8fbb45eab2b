# SPDX-License-Identifier: BSD-3-Clause
"""What a recording in which nothing was found would have shown, and what it would not.

"Nothing is missing" is said of a recording: of its noise, of what its data sheet or history leaves open, and
of how its valve moved. Each effect is put into the calibrated simulation at several sizes, the calibration
answers, and what is left is held against the rules that every difference must pass. The least size that
passes them all is the effect's limit of detection. Other looks, such as that of a black box, may notice less.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2

from sklvalve.mismatch.decide.detect import in_counts, law_for, p_value_of_looks
from sklvalve.mismatch.decide.null_reference import survival
from sklvalve.mismatch.inference.hypothesis import Model, Term
from sklvalve.mismatch.inference.linearised import Linearised
from sklvalve.mismatch.search.relevance import beyond_tolerance, standardized_effect_size
from sklvalve.mismatch.search.scatter import OverTime
from sklvalve.mismatch.search.screening import Trial
from sklvalve.simulation.given import ACTUATOR_STAGES
from sklvalve.simulation.parallel_map import parallel_map

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.case import Case
    from sklvalve.mismatch.decide.null_reference import Covariates
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.effects.base import Quantity
    from sklvalve.mismatch.inference.problem import Problem

# sizes tried lie so far below what is physically possible, and so many of them on the way there
_DECADES, _SIZES = 3.0, 7
# no effect size is looked for beyond this
_LARGEST = 1e4
# halvings in which a limit is found between two sizes, and the edge of what a data sheet leaves open
_HALVINGS, _HALVINGS_OF_EDGE = 3, 20
#: Predictions with an effect, and what it changes in the errors of a recording.
_Made = tuple[dict[str, np.ndarray], np.ndarray]
# stages of the chain in which a recorded signal is read: an effect there undoes what a sensor does wrong
_READ = ("position_sensor",)
# of these there is no limit: a calibration follows the drop further than to first order, so that limits of a
# pressure sensor came out too small, up to three times
_LEFT_OUT = ("pressures",)


@dataclass(frozen=True)
class DetectionLimit:
    """What of one effect might have gone unnoticed, were it there throughout the recording.

    Attributes
    ----------
    name, form : str
        Of the effect, and of this form of it.
    parameter, unit : str
        What its size is.
    low, high : float or None
        Sizes from `low` to `high` might not have been noticed [unit]; None where no size beyond, as far as it
        is physically possible, would have been either.
    """

    name: str
    form: str
    parameter: str
    unit: str
    low: float | None
    high: float | None


def detection_limits(case: Case) -> tuple[DetectionLimit, ...]:
    """What of each effect might have gone unnoticed.

    Parameters
    ----------
    case : Case
        In which nothing was found.

    Returns
    -------
    limits : tuple of DetectionLimit
        In the order of the candidates, without pressure sensors, and without those of which any size would
        have been noticed.
    """
    problem, nominal = case.problem, case.explanation.nominal
    effects = [e for e in case.explanation.effects if e.stage not in _LEFT_OUT]
    touched = {e.key: problem.channels_touched(e) for e in effects}
    lines = {t: Linearised(problem, nominal, t) for t in dict.fromkeys(touched.values()) if t}
    needed = _needed(problem, case.covariates, case.alpha)
    looks = [
        _Look(problem, nominal, lines[touched[e.key]], e, needed, case.alpha)
        for e in effects
        if touched[e.key]
    ]
    return tuple(limit for limit in parallel_map(_Look.limit, looks) if limit is not None)


def _needed(problem: Problem, covariates: Covariates, alpha: float) -> dict[str, float]:
    """Look at what acts throughout -> effect size that few healthy recordings have, alpha of them."""
    law = law_for(problem)

    def excess(effect_size: float, look: str) -> float:
        nothing = dict.fromkeys(law.tables, 1.0)
        seen = {look: survival(law.tables[look], effect_size, covariates)}
        return float(np.log(p_value_of_looks(nothing | seen) / alpha))

    return {
        look: float(brentq(excess, 0.0, _LARGEST, args=(look,), xtol=1e-3))
        if excess(_LARGEST, look) < 0.0
        else np.inf
        for look in ("throughout", "stem")
    }


class _Look:
    """One effect in the calibrated simulation, and how far each size of it is from being noticed.

    Parameters are those of `detection_limits`, with the simulation linearised for what the effect changes.
    """

    def __init__(
        self,
        problem: Problem,
        nominal: Model,
        line: Linearised,
        effect: Effect,
        needed: dict[str, float],
        alpha: float,
    ) -> None:
        self.problem, self.nominal, self.term = problem, nominal, Term(effect)
        self.trial = Trial(problem, nominal, line, self.term)
        self.quantity = self.trial.quantities[0]
        self.needed = needed["stem" if effect.stage in ACTUATOR_STAGES else "throughout"]
        self.reads = effect.stage in _READ or effect.in_loop
        # of its parameters and its time, as `p_value_of_what_counts` has it
        self.clear = float(np.sqrt(chi2.isf(alpha, len(effect.parameters) + 1)))

    def limit(self) -> DetectionLimit | None:
        """What might have gone unnoticed; None where any size of the effect would have been noticed."""
        at, middle = _sizes(self.quantity)
        made = self._simulated(at)
        if middle is None:
            margins = [self._margin(x, *each) for x, each in zip(at, made, strict=True)]
            middle = int(np.argmin(margins))
            if margins[middle] > 0.0:
                # it says where something is and not how much: at no size it vanishes
                return None
        if self._noticed(at[middle], self._margin(at[middle], *made[middle])):
            return None
        below = self._end(at[middle::-1], made[middle::-1])
        above = self._end(at[middle:], made[middle:])
        effect, quantity = self.term.effect, self.quantity
        return DetectionLimit(effect.name, effect.key, quantity.name, quantity.unit, below, above)

    def _end(self, at: np.ndarray, made: list[_Made]) -> float | None:
        """The size on the way from first to last from which on the effect is noticed; None without one."""
        before = 0.0
        for k, simulated in enumerate(made):
            margin = self._margin(at[k], *simulated)
            if k and self._noticed(at[k], margin):
                crossed = self._crossing(at[k - 1], at[k], before, margin)
                return _value(self.quantity, self._edge(crossed, at[k]))
            before = margin
        return None

    def _crossing(self, inside: float, outside: float, before: float, behind: float) -> float:
        """Where the margin passes 1, on the way from one size to another whose margins are known."""
        if before >= 1.0:
            return inside
        for _ in range(_HALVINGS):
            middle = 0.5 * (inside + outside)
            [simulated] = self._simulated(np.array([middle]))
            margin = self._margin(middle, *simulated)
            if margin < 1.0:
                inside, before = middle, margin
            else:
                outside, behind = middle, margin
        return inside + (outside - inside) * (1.0 - before) / (behind - before)

    def _noticed(self, at: float, margin: float) -> bool:
        return bool(margin >= 1.0 and beyond_tolerance(self.problem, self._model(at, {}), self.term))

    def _edge(self, inside: float, outside: float) -> float:
        """Where what a data sheet leaves open ends, on the way from one size to another that lies beyond."""
        for _ in range(_HALVINGS_OF_EDGE):
            if self._noticed(inside, 1.0):
                return inside
            between = 0.5 * (inside + outside)
            inside, outside = (inside, between) if self._noticed(between, 1.0) else (between, outside)
        return outside

    def _simulated(self, at: np.ndarray) -> list[_Made]:
        """Of each size predictions with the effect, and what it changes in the errors of a recording."""
        vector, name = self.trial.misfit.vector, f"{self.trial.key}.{self.quantity.name}"
        healthy, quantity = self.trial.line.errors, self.quantity
        # a sensor's error put into the simulation of a healthy signal is the opposite one of the recording
        opposite = self.reads and quantity.null is not None
        null = _scaled(quantity, quantity.null) if quantity.null is not None and opposite else 0.0
        sizes = [_value(quantity, 2.0 * null - each if opposite else each) for each in at]
        made = self.trial.simulated([vector.pack({name: size}) for size in sizes])
        return [(p, errors - healthy if opposite else healthy - errors) for p, errors in made]

    def _margin(self, at: float, predictions: dict[str, np.ndarray], change: np.ndarray) -> float:
        """How far a size is beyond all that it must pass, as a ratio: from 1 on it is noticed."""
        model = self._model(at, predictions)
        counts = in_counts(self.problem.change(model, self.nominal), self.problem)
        gain = self._gain(change)
        relevant = (1.0 - 1.0 / counts) * np.sqrt(2.0 * gain) if counts > 1.0 else 0.0

        def margin(deviations: float) -> float:
            effect_size = standardized_effect_size(deviations, counts)
            return float(min(effect_size / self.needed, relevant / self.clear))

        at_most = margin(np.sqrt(2.0 * gain))
        if at_most < 1.0:
            return at_most
        # what stretches of this recording disagree by, in the direction of the effect
        return margin(OverTime.of(self.problem, self.nominal, model).deviations(gain))

    def _gain(self, change: np.ndarray) -> float:
        """Log likelihood that the effect gains on the simulation where the recording has it."""
        line = self.trial.line
        # what the recording already has of it, unnoticed, is none of its noise
        share = -line.share_of(line.errors + change)[0]
        noise = line.errors - share * change
        return max(line.answered(noise + change)[0] - line.answered(noise)[0], 0.0)

    def _model(self, at: float, predictions: dict[str, np.ndarray]) -> Model:
        """The calibrated simulation with the effect, simulated and not fitted."""
        vector, name = self.trial.misfit.vector, f"{self.trial.key}.{self.quantity.name}"
        values = vector.values(vector.pack({name: _value(self.quantity, at)}))
        return Model(
            (self.term,),
            self.trial.chain,
            self.nominal.values | values,
            self.nominal.predictions | predictions,
            np.nan,
            {},
        )


def _sizes(quantity: Quantity) -> tuple[np.ndarray, int | None]:
    """Sizes to try, in the scale of a fit, and the place at which the effect vanishes, if that is known."""
    low, high = _scaled(quantity, quantity.low), _scaled(quantity, quantity.high)
    if quantity.null is None:
        return np.linspace(low, high, _SIZES), None
    if quantity.log and quantity.null <= 0.0:
        return np.linspace(low, high, _SIZES), 0
    null = min(max(_scaled(quantity, quantity.null), low), high)
    ways = np.logspace(-_DECADES, 0.0, _SIZES)
    below, above = (ways * (end - null) for end in (low, high))
    below, above = (way[np.abs(way) > 0.0] for way in (below, above))
    return null + np.concatenate([below[::-1], [0.0], above]), len(below)


def _scaled(quantity: Quantity, value: float) -> float:
    return float(np.log(value)) if quantity.log else value


def _value(quantity: Quantity, at: float) -> float:
    return float(np.clip(np.exp(at) if quantity.log else at, quantity.low, quantity.high))
