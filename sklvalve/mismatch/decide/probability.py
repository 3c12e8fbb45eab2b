# SPDX-License-Identifier: BSD-3-Clause
"""How often a class holds the truth, by what a diagnosis knows of it.

A class is the names that a recording cannot tell apart (`mismatch.inference.posterior`). Its probability is
made here; `assessing` shares it among the names by their posterior.

Among the explanations at hand the likeliest class has nearly always a probability of one; that says nothing
of those not at hand. So the probability that is reported is calibrated on simulated plants whose causes were
sealed: a logistic regression of a few facts known to the diagnosis (`borne_out` has its numbers, and says
where they were measured).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import expit

from sklvalve.mismatch.decide.borne_out import SEALED, USUAL_P
from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.inference.posterior import temperature

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.borne_out import Numbers

#: Findings about the data that make values coarse: thinned by a historian, or read in large steps.
COARSE = ("compressed", "quantised")
_READ_IN_STEPS = ("flow", "opening")
# beyond one in ten million a p-value says no more: one in a million, by the sealed records, as `USUAL_P` says
_LEAST_P = 1e-7
# prior: so many classes of the usual share count as seen beside those led by a name; 4 to 15 did as well
_PRIOR_CLASSES = 8.0


@dataclass(frozen=True)
class Grounds:
    """What the probability of a class is calibrated by.

    Attributes
    ----------
    leading : str
        The most probable name of the class.
    p_value : float
        Of "nothing is missing".
    beside : bool
        Whether it stands beside a stronger finding.
    coarse : bool
        Whether a historian has thinned the values, or flow or opening is read in large steps.
    may_vanish : bool
        Whether the interval of its size holds the value at which the effect vanishes.
    few_signals : bool
        Whether the opening or a pressure is not recorded.
    history : bool
        Whether the recording is held against a history of the valve.
    left : float or None
        What the class leaves of its difference, as `left_over` counts it; None where that is not known, as
        of an effect that begins behind an origin of the forecasts, or stands beside a stronger finding.
    """

    leading: str
    p_value: float
    beside: bool = False
    coarse: bool = False
    may_vanish: bool = False
    few_signals: bool = False
    history: bool = False
    left: float | None = None

    @property
    def columns(self) -> tuple[float, float, float, float]:
        """The facts as numbers, in the order of `Numbers.of_grounds`."""
        rarity = -np.log10(max(self.p_value, _LEAST_P)) + np.log10(USUAL_P)
        return float(rarity), float(self.beside), float(self.coarse), float(self.may_vanish)


def left_over(gain: float, skill: float | None) -> float | None:
    r"""What a correction leaves of a difference, in nats of which model error makes T count as one.

    .. math:: \frac{(1 - s) g}{T}, \qquad T = 1 + 2 \kappa^2 g

    A true cause leaves its noise, and of a large difference the share that its equation gets wrong. Another
    one leaves what it cannot imitate.

    Parameters
    ----------
    gain : float
        g, the log likelihood gained on no explanation, by the noise that the best one leaves [nats].
    skill : float or None
        s, the share of the squared error beyond noise that the correction removes on forecast rows; below -1
        it counts as -1.

    Returns
    -------
    left : float or None
        At most 1 / (2 kappa^2) where the correction does no harm; None where no forecast was made, or where
        nothing is gained, as by events, which are not simulated.

    Examples
    --------
    >>> from sklvalve.mismatch.decide.probability import left_over
    >>> round(left_over(200.0, 0.95), 2), round(left_over(200.0, 0.3), 2)
    (1.0, 14.0)
    """
    if skill is None or not np.isfinite(skill) or not np.isfinite(gain) or gain <= 0.0:
        return None
    return float(np.clip(1.0 - skill, 0.0, 2.0)) * gain / temperature(gain)


def is_coarse(data: list[dict[str, Any]]) -> bool:
    """Whether findings about the data say that values are thinned or read in large steps."""
    kinds = [(each["finding"], each["role"]) for each in data]
    return any(f == COARSE[0] or (f == COARSE[1] and role in _READ_IN_STEPS) for f, role in kinds)


def vanishing(effect: Effect, parameters: dict[str, dict[str, Any]]) -> list[str]:
    """Sizes of an effect whose intervals hold the value at which it vanishes, where those of all sizes do.

    Parameters
    ----------
    effect : Effect
    parameters : dict
        As in an entry of diagnosis.json: name -> dict with ``ci95``.

    Returns
    -------
    names : list of str
        Empty where any size is clear of it, or none has an interval.
    """
    sizes = {q.name: (q.null, parameters[q.name]["ci95"]) for q in effect.parameters if q.null is not None}
    known = {name: (null, ci) for name, (null, ci) in sizes.items() if ci is not None}
    return list(known) if all(low <= null <= high for null, (low, high) in known.values()) else []


def without_interval(effect: Effect, parameters: dict[str, dict[str, Any]]) -> list[str]:
    """Sizes of an effect where none of them has an interval: nothing shows that there is an effect.

    An explanation that was compared with others and never fitted itself has none. Of 2,530 classes of sealed
    records 15 were led by such a one: 4 of them held the truth, and 91 % of the others.

    Parameters
    ----------
    effect, parameters
        As `vanishing` takes them.

    Returns
    -------
    names : list of str
        Empty where any size has one.
    """
    sizes = [q.name for q in effect.parameters if q.null is not None]
    return sizes if all(parameters[name]["ci95"] is None for name in sizes) else []


def log_odds_of_name(name: str, held: dict[str, tuple[int, int]]) -> float:
    """Log odds that a class led by a name holds the truth, less those of any class.

    Of a name that rarely led a class the odds are drawn towards those of all.

    Parameters
    ----------
    name : str
    held : dict
        As `Numbers.held`.
    """
    right, many = held.get(name, (0, 0))
    usual = sum(r for r, _ in held.values()) / sum(n for _, n in held.values())
    share = (right + _PRIOR_CLASSES * usual) / (many + _PRIOR_CLASSES)
    return float(np.log(share / (1.0 - share)) - np.log(usual / (1.0 - usual)))


def probability_of(grounds: Grounds, numbers: Numbers = SEALED) -> float:
    """Probability that a class holds the truth, of recordings such as it was calibrated on.

    Parameters
    ----------
    grounds : Grounds
    numbers : Numbers, default=SEALED

    Returns
    -------
    probability : float
    """
    odds = numbers.intercept + numbers.of_name * log_odds_of_name(
        grounds.leading, numbers.held_by(grounds.history)
    )
    odds += float(np.dot(numbers.of_grounds, grounds.columns))
    if grounds.few_signals:
        offset, slope = numbers.few_signals
        odds = offset + slope * odds
    if grounds.history:
        offset, slope = numbers.with_history
        odds = offset + slope * odds
    if grounds.left is not None:
        offset, of_a_nat = numbers.left_over
        odds += offset + of_a_nat * grounds.left
    return float(expit(odds))
