# SPDX-License-Identifier: BSD-3-Clause
"""A plain grade of every finding, strong, moderate or weak, with its reason in one sentence.

Where it was checked how often such names hold, the grade follows the probability. Where it was not, the same
facts are weighed, and a finding is as strong only where its correction explains most of what the simulation
leaves over, on rows ahead in time.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.constants import NAMED_FROM
from sklvalve.mismatch.decide.borne_out import SEALED
from sklvalve.mismatch.decide.probability import log_odds_of_name

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.probability import Grounds

WEAK, MODERATE, STRONG = LEVELS = ("weak", "moderate", "strong")
#: A finding is strong from this probability on.
STRONG_FROM = 0.9
#: Skill on held-out rows from which on a name needs no frequency to be strong: the error is halved. Of 1,312
#: classes of the sealed runs with so large a fall on later rows 94 % held, of 420 others 81 %.
EXPLAINS_MOST = 0.75
# log odds: what lowers them by less is not the reason of a grade where signals lack
_LITTLE = -0.5


def grade_of(
    probability: float, grounds: Grounds, evidence: dict[str, Any], unchecked: str = ""
) -> dict[str, str]:
    """Grade of a finding.

    Parameters
    ----------
    probability : float
        As `probability_of` gives it, also where nobody checked it.
    grounds : Grounds
    evidence : dict
        Of the entry: ``skill`` (share of the squared error beyond noise that the correction removes on rows
        ahead in time; None where not known), ``late`` (it begins too late for one), ``at_first`` (it acts in
        the first rows alone), ``vanishes`` and ``no_interval`` (names of parameters).
    unchecked : str, default=""
        Why it was not checked how often such names hold.

    Returns
    -------
    grade : dict
        ``level`` and ``reason``. A weak one names nothing.
    """
    skill = evidence.get("skill")
    level = 2 if probability >= STRONG_FROM else 1 if probability >= NAMED_FROM else 0
    reason = _why(grounds, evidence, level)
    lowered = int(skill is not None and skill <= 0.0)
    if unchecked:
        lowered += not evidence.get("late") and (skill is None or skill < EXPLAINS_MOST)
        reason += f"; how often such a diagnosis is right was not checked for {unchecked}"
        level = max(level - lowered, 0)
    elif level:
        # what is likely by its frequency stays named
        level = max(level - lowered, 1)
    if grounds.may_vanish or evidence.get("no_interval") or evidence.get("at_first"):
        level = 0
    return {"level": LEVELS[level], "reason": f"{reason[:1].upper()}{reason[1:]}."}


def _why(grounds: Grounds, evidence: dict[str, Any], level: int) -> str:
    """What speaks most against a finding; of a strong one, what speaks for it."""
    skill = evidence.get("skill")
    if grounds.may_vanish:
        return f"the interval of its {_either(evidence['vanishes'])} includes the value of no effect"
    if evidence.get("no_interval"):
        return f"no interval of its {_either(evidence['no_interval'])} is known"
    if evidence.get("at_first"):
        return "it acts in the first rows only, and what happened before the recording is not known"
    if skill is not None and skill <= 0.0:
        return "including it does not lower the error on forecast rows"
    if level < LEVELS.index(STRONG):
        return _weakest(grounds, skill)
    words = "a difference this large is rare among healthy valves"
    if skill is None:
        return words
    return f"{words}, and the correction explains {100.0 * min(skill, 1.0):.0f} % of it on forecast rows"


def _weakest(grounds: Grounds, skill: float | None) -> str:
    """The fact that lowers the probability most."""
    held = SEALED.held_by(grounds.history)
    right, many = held.get(grounds.leading, (0, 0))
    rarity, beside, coarse, _ = np.multiply(SEALED.of_grounds, grounds.columns)
    facts = {
        f"in blind tests {right} of {many} diagnoses that named this effect first were right": (
            SEALED.of_name * log_odds_of_name(grounds.leading, held)
        ),
        "a difference this large is not very rare among healthy valves": rarity,
        "it was found beside a stronger finding": beside,
        "the recorded values are compressed or coarsely quantised": coarse,
    }
    if grounds.left is not None and skill is not None:
        words = (
            f"the correction explains only {100.0 * max(skill, 0.0):.0f} % of the difference on forecast rows"
        )
        facts[words] = float(np.dot(SEALED.left_over, (1.0, grounds.left)))
    worst = min(facts, key=facts.__getitem__)
    return (
        "the opening or a pressure is not recorded"
        if grounds.few_signals and facts[worst] > _LITTLE
        else worst
    )


def _either(names: Iterable[str]) -> str:
    return " and ".join(name.replace("_kv", " Kv").replace("_", " ") for name in names)
