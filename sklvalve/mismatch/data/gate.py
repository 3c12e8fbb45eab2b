# SPDX-License-Identifier: BSD-3-Clause
"""The data gate: what is wrong with the data switches off or blocks before physics is asked."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.recording.dead_bands import flow_moved_by
from sklvalve.recording.measured import COUNTS, held_within_a_band, tells_a_band
from sklvalve.simulation.calibration import span_of

if TYPE_CHECKING:
    from sklvalve.mismatch.effects import Effect
    from sklvalve.recording import Recording

    #: One finding of `screen_recording` about the data.
    Defect = dict[str, Any]

# columns exchanged or in a wrong unit: whatever shows may be of their making
_WRONG = ("swapped", "unit_suspect")
# as coarse as this the openings of healthy recordings were read
_FINE = {"opening": 0.004}
# by as much of it the historians of healthy recordings left the flow, or their pressures moved it: what is
# called rare is rare beside those
_MOVED_IN_HEALTHY = 0.01


def effects_switched_off(data: Sequence[Defect], effects: Iterable[Effect] = CATALOGUE) -> dict[str, str]:
    """Effects that a recording's data cannot speak for.

    Parameters
    ----------
    data : list of dict
        Findings of `screen_recording`, as they are or marked by `with_seized_stems`.
    effects : sequence of Effect, default=CATALOGUE
        Those that are asked; an effect is off in all its forms where one of them is.

    Returns
    -------
    off : dict
        Effect name -> what is needed instead.
    """
    off: dict[str, str] = {}
    for finding in data:
        name, role = finding["finding"], finding["role"]
        if name == "quantised" and finding.get("size", 1.0) < _FINE.get(role, COUNTS):
            continue
        needs = _needs(name, role)
        for effect in effects:
            if _hides(finding, effect):
                off.setdefault(effect.name, needs)
    return off


def _hides(finding: Defect, effect: Effect) -> bool:
    """Whether an effect is imitated by a finding, or cannot be seen for it."""
    if effect.standstill and finding.get("seized"):
        return False
    defect, role = _defect(finding), finding["role"]
    if defect in _WRONG or (defect, role) == ("unmeasured", "flow"):
        return True
    roles = effect.hidden_by.get(defect, ())
    return role in roles or "any" in roles


def _defect(finding: Defect) -> str:
    """Kind of a defect, as effects name what hides them."""
    if finding["finding"] == "frozen" and finding.get("rows", ()) is None:
        # frozen from first to last row a signal was not measured at all
        return "unmeasured"
    return "held" if held_within_a_band(finding) else finding["finding"]


def redraws_the_flow(finding: Defect) -> bool:
    """Whether a finding is that the flow was drawn in steps or lines, which leaves the moves of the stem."""
    return finding["finding"] in ("compressed", "quantised") and finding["role"] == "flow"


def left_out_is_known(finding: Defect, recording: Recording) -> bool:
    """Whether what a historian left out of a signal is allowed for where it is compared, or judged.

    That of an opening is allowed for in its comparison (`tells_a_band`). That of flow and pressures is by the
    healthy recordings that the mismatch is held against, if it moves the flow no more than theirs.
    """
    role, band = finding["role"], finding.get("size")
    if role == "opening":
        return tells_a_band(finding)
    if not band or role not in ("flow", "p1", "p2"):
        return False
    if role == "flow":
        return bool(band <= _MOVED_IN_HEALTHY * span_of(recording["flow"]))
    return bool(flow_moved_by(recording, band) <= _MOVED_IN_HEALTHY)


def _needs(name: str, role: str) -> str:
    if name == "swapped":
        return "columns that are not swapped"
    if name == "unit_suspect":
        return f"the right unit and sense of {role}"
    if name == "clock_shift":
        return f"one clock for {role} and the others"
    return f"a recording whose {role} is not {name}"


def blocking(data: Iterable[Defect]) -> str | None:
    """Say why no physics may be named from a recording before its data are mended; None where it may.

    Parameters
    ----------
    data : list of dict
        Findings of `screen_recording`.

    Returns
    -------
    sentence : str or None
        For people, with what was seen and what to do.
    """
    grave = [each for each in data if each["finding"] in _WRONG]
    if not grave:
        return None
    seen = "; ".join(f"{each['role']} {each['detail']}" for each in grave)
    return f"Correct the columns in valve.toml first; until then nothing can be diagnosed: {seen}."
