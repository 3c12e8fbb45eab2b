# SPDX-License-Identifier: BSD-3-Clause
"""A recording as its sensors measured it: without what they did not, within which bands values were held."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.recording.dead_bands import DeadBand
from sklvalve.recording.screening import screen_recording
from sklvalve.recording.standing import stem_may_stand

if TYPE_CHECKING:
    from sklvalve.recording.recording import Recording

    #: One finding of `screen_recording` about the data.
    Defect = dict[str, Any]

# of a channel, where values pile up: what is left would say nothing of the whole; a frozen value is none
_MOST_BLANK = {"frozen": 1.0, "saturated": 0.6}
#: Share of travel that an effect must change to count; bands and steps below this cannot pass for one.
COUNTS = 0.005


def as_measured(recording: Recording) -> Recording | None:
    """A recording as a diagnosis uses it: screened, and without what its sensors did not measure.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    recording : Recording or None
        As `without_findings` leaves it; None where the opening or the flow stands still from the first row to
        the last, so that the recording says nothing of its valve.
    """
    data = screened(recording)
    return None if any(map(_stands, data)) else without_findings(recording, data)


def _stands(finding: Defect) -> bool:
    """Whether what a simulation predicts stood still all the time, if only as that of a seized stem may."""
    return finding["finding"] == "frozen" and finding["role"] in ("opening", "flow") and not finding["rows"]


def screened(recording: Recording) -> list[Defect]:
    """Findings about the data of a recording, openings that may stand with their stem marked.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    data : list of dict
        Of `screen_recording`, as `with_seized_stems` marks them.
    """
    return with_seized_stems(screen_recording(recording), recording)


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


def held_within_a_band(finding: Defect) -> bool:
    """Whether a historian left out moves of the stem that are too small to count, and no others."""
    # an opening known within a dead band shows how a stem moves; a flow that a meter damps follows less
    compressed = finding["finding"] == "compressed" and finding["role"] == "opening"
    return compressed and finding.get("size", np.inf) < COUNTS


def tells_a_band(finding: Defect) -> bool:
    """Whether a finding says within which band an opening or a flow was held, so that it is allowed for."""
    of_flow = (finding["finding"], finding["role"]) == ("compressed", "flow") and finding.get("size")
    return bool(of_flow) or held_within_a_band(finding)


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
