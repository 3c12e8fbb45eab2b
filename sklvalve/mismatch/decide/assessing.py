# SPDX-License-Identifier: BSD-3-Clause
"""How sure each finding is: its probability where that was checked, and its grade."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from sklvalve.mismatch.decide.borne_out import SEALED
from sklvalve.mismatch.decide.checked_kind import few_signals, unchecked
from sklvalve.mismatch.decide.grade import grade_of
from sklvalve.mismatch.decide.probability import Grounds, is_coarse, left_over, probability_of
from sklvalve.mismatch.inference.origins import ORIGINS

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.recording import Recording

# of a recording, its first rows: a valve, its line and its meter settle from what was before
_AT_FIRST = 0.02


def assessed(
    problem: Problem,
    entries: list[dict[str, Any]],
    p_value: float | None,
    skills: dict[str, float | None],
    data: list[dict[str, Any]],
) -> list[dict[str, Any]]:
    """Entries of diagnosis.json with how sure they are.

    Parameters
    ----------
    problem : Problem
    entries : list of dict
        As `result.effect_entry` makes them, the strongest first.
    p_value : float or None
    skills : dict
        Channel -> share of the squared error beyond noise that the correction removes from rows ahead in
        time; None where not known.
    data : list of dict
        Findings of `screen_recording`.

    Returns
    -------
    entries : list of dict
        With probabilities as they were borne out, None where that was not checked; ``grade``; and in their
        ``evidence`` the skill on rows ahead, and whether they begin too ``late`` for one.
    """
    of_all = Grounds(
        "",
        1.0 if p_value is None else p_value,
        coarse=is_coarse(data),
        few_signals=few_signals(problem.recording),
        history=problem.history is not None,
    )
    kind = unchecked(problem)
    return [
        _assessed(
            entry, replace(of_all, beside=k > 0), _evidence(entry, skills, problem.recording), kind, problem
        )
        for k, entry in enumerate(entries)
    ]


def doubt_of(entry: dict[str, Any]) -> str:
    """Why a finding is no name, in a sentence that says which it is."""
    name, reason = entry["members"][0]["name"].replace("_", " "), entry["grade"]["reason"]
    # what was not checked is said once, beside the grade
    reason = f"{reason.split('; how often')[0].rstrip('.')}."
    return f"{name.capitalize()} is too uncertain to be named: {reason[:1].lower()}{reason[1:]}"


def _assessed(
    entry: dict[str, Any], of_all: Grounds, evidence: dict[str, Any], kind: str, problem: Problem
) -> dict[str, Any]:
    """One entry with its grade and probabilities, by what holds `of_all` and what is its own."""
    # beside a stronger finding the skill is that of both; where nothing was checked the grade asks for it
    alone = not (of_all.beside or kind)
    grounds = replace(
        of_all,
        leading=entry["members"][0]["name"],
        may_vanish=bool(evidence["vanishes"]),
        left=_left(entry, evidence, problem.recording) if alone else None,
    )
    sized = "an effect whose size has no interval" if evidence.get("no_interval") else ""
    return _graded(entry, grounds, evidence, kind or _never_led(grounds) or sized)


def _evidence(entry: dict[str, Any], skills: dict[str, float | None], recording: Recording) -> dict[str, Any]:
    """Evidence of an entry, with its skill on rows ahead and whether it begins too late for one."""
    late = _begins_behind(entry, recording, ORIGINS[-2])
    return {
        **entry["evidence"],
        "skill": None if late else _skill(entry, skills),
        "late": late,
        "at_first": _is_at_first(entry, recording),
    }


def _graded(entry: dict[str, Any], grounds: Grounds, evidence: dict[str, Any], kind: str) -> dict[str, Any]:
    """An entry with its grade, and with probabilities where no `kind` of recording forbids them."""
    of_class = min(entry["probability"], 1.0) * probability_of(grounds)
    candidates = [
        each
        | {"probability": None if kind else round(of_class * each["probability"] / entry["probability"], 4)}
        for each in entry["members"]
    ]
    return entry | {
        "members": candidates,
        "probability": None if kind else round(of_class, 4),
        "grade": grade_of(of_class, grounds, evidence, kind),
        "evidence": evidence,
    }


def _never_led(grounds: Grounds) -> str:
    """Why it was not checked how often a name holds; empty where classes of blind tests were led by it."""
    led = grounds.leading in SEALED.held_by(grounds.history)
    return "" if led else "an effect that no blind test has named"


def _skill(entry: dict[str, Any], skills: dict[str, float | None]) -> float | None:
    """Largest skill among the channels that a finding changes; None where none is known."""
    known = [skills.get(channel) for channel in entry["size"]]
    return max((skill for skill in known if skill is not None), default=None)


def _left(entry: dict[str, Any], evidence: dict[str, Any], recording: Recording) -> float | None:
    """What a finding leaves over; None where it begins behind an origin, whose forecast cannot know of it."""
    known = not _begins_behind(entry, recording, ORIGINS[0])
    return left_over(evidence["gain"], evidence["skill"]) if known else None


def _begins_behind(entry: dict[str, Any], recording: Recording, origin: float) -> bool:
    """Whether a finding begins behind an origin of the forecasts."""
    if entry["onset"] is None:
        return False
    return bool(entry["onset"] >= recording.time[int(origin * len(recording))] - recording.time[0])


def _is_at_first(entry: dict[str, Any], recording: Recording) -> bool:
    """Whether a finding acts in the first rows alone, where what was before the recording still shows."""
    episodes = entry.get("spells") or []
    return bool(episodes and episodes[-1][1] <= _AT_FIRST * (recording.time[-1] - recording.time[0]))
