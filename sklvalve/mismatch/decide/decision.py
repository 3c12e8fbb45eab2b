# SPDX-License-Identifier: BSD-3-Clause
"""Where a verdict comes from: by the evidence alone first, by how sure the names are last.

Between the two these may make another verdict of it, in this order, each with words for `reasons_of`, and
most with a rule of `rules`:

- `judging`: noise (``cannot_tell`` or ``none_of_these`` in place of names or of nothing), a stem that
  strays (``cannot_tell``), a flow in pulses (``none_of_these``), events (``named``);
- `stretches`: what a few stretches showed and all rows do not (``no_mismatch``);
- `late`, `behind`: the last rows (``named`` or ``cannot_tell``), and what lies behind a property;
- `suppression`: what the data may have made (``cannot_tell``);
- `known_before`: what a history may have had already (``cannot_tell``);
- `referee`: what a black box forecasts better (``cannot_tell``), and names that make forecasts worse;
- `dated`: a change that nothing found explains (``cannot_tell`` in place of ``no_mismatch``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sklvalve.mismatch.constants import RESIDUAL_SHARE
from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.assessing import assessed, doubt_of
from sklvalve.mismatch.decide.grade import WEAK
from sklvalve.mismatch.proof.comparison import skills_ahead

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.residual.unknown import Unknown
    from sklvalve.mismatch.search.rivals import Finding


def by_evidence(
    findings: list[Finding], unknown: Unknown | None, enough: bool, explained: float
) -> tuple[str, list[Finding]]:
    """Verdict by the evidence alone, and the findings that stand.

    Parameters
    ----------
    findings : list of Finding
    unknown : Unknown or None
    enough : bool
        Whether there is more than chance makes (p at most alpha, a parameter of the finder, 0.01), and more
        than counts.
    explained : float
        Size of what the effects explain, share of span, in the unknown's channel [1].
    """
    if not enough:
        return "no_mismatch", []
    if unknown is not None and unknown.size > RESIDUAL_SHARE * explained:
        return "none_of_these", []
    if not findings:
        return "cannot_tell", []
    return "named", findings


@dataclass(frozen=True)
class Decision:
    """What a diagnosis ends with.

    Attributes
    ----------
    verdict : {"no_mismatch", "named", "cannot_tell", "none_of_these"}
    entries : list of dict
        Of ``effects`` in diagnosis.json: what may be named, or all candidates where nothing may.
    rules : list of Rule
        Those that were asked, in their order.
    doubts : list of str
        Why what was found beside the entries is no name.
    """

    verdict: str
    entries: list[dict[str, Any]]
    rules: list[rules.Rule]
    doubts: list[str]


def decided(
    problem: Problem,
    judgement: Judgement,
    entries: list[dict[str, Any]],
    data: list[dict[str, Any]],
    alpha: float,
) -> Decision:
    """The decision: a judgement, and of what it names how sure that is.

    Parameters
    ----------
    problem : Problem
    judgement : Judgement
        With all that may overrule the evidence.
    entries : list of dict
        Of its findings, as `result.effect_entry` makes them, the strongest first.
    data : list of dict
        Findings of `screen_recording`.
    alpha : float
    """
    # forecasts of the rows used: those kept for the final figures must decide nothing
    forecasts = () if judgement.referee is None else judgement.referee.compared
    entries = assessed(problem, entries, judgement.p_value, skills_ahead(problem, forecasts), data)
    verdict, entries, doubts = strong_enough(judgement.verdict, entries)
    asked = list(judgement.rules)
    if judgement.p_value is not None:
        # what was seen later, such as a change or a black box, counts as well
        asked.append(rules.rarity(judgement.p_value, alpha))
    if judgement.verdict == "named":
        likeliest = max(entries, key=lambda entry: entry["probability"] or 0.0)
        reason = likeliest["grade"]["reason"]
        asked.append(rules.probability(likeliest["probability"], verdict == "named", reason))
    return Decision(verdict, entries, rules.in_order(asked), doubts)


def strong_enough(verdict: str, entries: list[dict[str, Any]]) -> tuple[str, list[dict[str, Any]], list[str]]:
    """The verdict that weak findings leave, those that may be named, and why the others are no names.

    Where every finding is weak none is named, and all of them are candidates.

    Parameters
    ----------
    verdict : str
    entries : list of dict
        With their grades, the strongest first.
    """
    weak = [entry for entry in entries if entry["grade"]["level"] == WEAK]
    if verdict != "named" or not weak:
        return verdict, entries, []
    if len(weak) == len(entries):
        return "cannot_tell", entries, [doubt_of(entries[0])]
    # what is too weak for a name is none beside a stronger one either
    return verdict, [entry for entry in entries if entry not in weak], [doubt_of(entry) for entry in weak]
