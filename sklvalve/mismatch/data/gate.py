# SPDX-License-Identifier: BSD-3-Clause
"""The data gate: what is wrong with the data switches off, blanks or blocks before physics is asked."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.recording.dead_bands import DeadBand, flow_moved_by
from sklvalve.recording.standing import stem_may_stand
from sklvalve.simulation.calibration import span_of

if TYPE_CHECKING:
    from sklvalve.mismatch.effects import Effect
    from sklvalve.recording import Recording

    #: One finding of `screen_recording` about the data.
    Defect = dict[str, Any]

# columns exchanged or in a wrong unit: whatever shows may be of their making
_WRONG = ("swapped", "unit_suspect")
# of a channel, where values pile up: what is left would say nothing of the whole; a frozen value is none
_MOST_BLANK = {"frozen": 1.0, "saturated": 0.6}
_COUNTS = 0.005  # of what an effect must change to count; steps below this cannot pass for one
_FINE = {"opening": 0.004}  # and as coarse as this the openings of healthy recordings were read
# by as much of it the historians of healthy recordings left the flow, or their pressures moved it: what is
# called rare is rare beside those
_MOVED_IN_HEALTHY = 0.01


def with_seized_stems(data: Sequence[Defect], recording: Recording) -> list[Defect]:
    """Findings, with a mark on an opening that stands still as that of a seized stem does.

    Parameters
    ----------
    data : list of dict
        Findings of `screen_recording` of this recording.
    recording : Recording

    Returns
    -------
    data : list of dict
        ``stuck_valve`` stays testable, and the rows stay, where ``seized`` is true: the command moves in
        every one of the stretches and the flow does not follow it.
    """
    return [each | {"seized": True} if _may_be_seized(each, recording) else each for each in data]


def _may_be_seized(finding: Defect, recording: Recording) -> bool:
    if finding["finding"] != "frozen" or finding["role"] != "opening":
        return False
    return all(stem_may_stand(recording, *span) for span in finding["rows"] or [(0, None)])


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
        if name == "quantised" and finding.get("size", 1.0) < _FINE.get(role, _COUNTS):
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


def held_within_a_band(finding: Defect) -> bool:
    """Whether a historian left out moves of the stem that are too small to count, and no others."""
    # an opening known within a dead band shows how a stem moves; a flow that a meter damps follows less
    compressed = finding["finding"] == "compressed" and finding["role"] == "opening"
    return compressed and finding.get("size", np.inf) < _COUNTS


def tells_a_band(finding: Defect) -> bool:
    """Whether a finding says within which band an opening or a flow was held, so that it is allowed for."""
    of_flow = (finding["finding"], finding["role"]) == ("compressed", "flow") and finding.get("size")
    return bool(of_flow) or held_within_a_band(finding)


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


def _bands(recording: Recording, data: Iterable[Defect]) -> dict[str, tuple[DeadBand, ...]]:
    """Role -> dead bands of its historian."""
    bands: dict[str, tuple[DeadBand, ...]] = {}
    for each in filter(tells_a_band, data):
        # one that lasts to the last row goes on behind it
        spans = [
            (recording.time[start], recording.time[stop - 1] if stop < len(recording) else np.inf)
            for start, stop in each.get("rows") or ()
        ]
        known = tuple(DeadBand(*span, each["size"]) for span in spans or [(-np.inf, np.inf)])
        bands[each["role"]] = bands.get(each["role"], ()) + known
    return bands


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


def without_findings(recording: Recording, data: Sequence[Defect]) -> Recording:
    """Recording without the rows that a sensor did not measure, its clocks set right, its dead bands known.

    Frozen and saturated stretches become NaN in their channel, so that no fit sees them; a channel that is
    saturated in more than six tenths of its rows is left as it is, as is a command, which drives the
    simulation. A channel whose clock is off is moved back by the rows that the screening found; rows that it
    then lacks are NaN, in a command the nearest known value.

    Parameters
    ----------
    recording : Recording
    data : list of dict
        Findings of `screen_recording` of this recording, as they are or marked by `with_seized_stems`.

    Returns
    -------
    recording : Recording
        The one given where there is nothing to be left out.
    """
    signals = dict(recording.signals)
    for each in filter(_may_blank, data):
        hidden = _hidden(each, len(recording))
        if 0.0 < hidden.mean() <= _MOST_BLANK[each["finding"]]:
            signals[each["role"]] = np.where(hidden, np.nan, signals[each["role"]])
    for each in data:
        if each["finding"] == "clock_shift" and each["role"] in signals and each.get("size"):
            signals[each["role"]] = _with_clock_set_right(recording, signals[each["role"]], each)
    bands = _bands(recording, data)
    if not bands and all(signals[role] is recording.signals[role] for role in signals):
        return recording
    return replace(recording, signals=signals, bands=bands)


def _may_blank(finding: Defect) -> bool:
    """Whether the rows of a finding may become gaps: those of a command and of a seized stem may not."""
    blanks = finding["finding"] in _MOST_BLANK and finding["role"] not in (None, "command")
    return blanks and not finding.get("seized")


def _hidden(finding: Defect, n: int) -> np.ndarray:
    """Of n rows those of a finding, as booleans."""
    hidden = np.zeros(n, dtype=bool)
    for start, stop in finding["rows"] or []:
        hidden[start:stop] = True
    return hidden


def _with_clock_set_right(recording: Recording, values: np.ndarray, finding: Defect) -> np.ndarray:
    """A signal moved back by what its clock is off, stretch by stretch."""
    moved = values.copy()
    for start, stop in finding["rows"] or [(0, len(recording))]:
        rows = round(finding["size"] / recording.slice(start, stop).sample_time)
        moved[start:stop] = _moved_back(moved[start:stop], rows, hold=finding["role"] == "command")
    return moved


def _moved_back(values: np.ndarray, rows: int, *, hold: bool) -> np.ndarray:
    places = np.arange(len(values)) + rows
    inside = (places >= 0) & (places < len(values))
    moved = values[np.clip(places, 0, len(values) - 1)]
    return moved if hold else np.where(inside, moved, np.nan)
