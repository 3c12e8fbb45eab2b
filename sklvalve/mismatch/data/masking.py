# SPDX-License-Identifier: BSD-3-Clause
"""A recording without what its sensors did not measure, both the rows used and those behind them."""

from __future__ import annotations

from typing import Any

from sklvalve.mismatch.data.gathering import settled
from sklvalve.recording import InputError, Recording, require_diagnosable
from sklvalve.recording.measured import screened, tells_a_band, without_findings


def masked(whole: Recording, recording: Recording, data: list[dict[str, Any]]) -> tuple[Recording, Recording]:
    """Recordings without the rows that the findings about their data speak against.

    Rows behind those used are screened for themselves, and only for values that stand still or pile up;
    how far a clock is off, or within which band a historian held a value, they are told by the rows used, so
    that they change nothing of the diagnosis.

    Parameters
    ----------
    whole : Recording
    recording : Recording
        The first rows of `whole`, that the diagnosis uses.
    data : list of dict
        Findings about `recording`.

    Returns
    -------
    whole, recording : Recording
        Those given where nothing speaks against them and they are in one piece; of several pieces the rows
        in which a simulation settles are left out too (`settled`).

    Raises
    ------
    InputError
        If too little is left for a diagnosis.
    """
    used = len(recording)
    cleaned = settled(without_findings(recording, data))
    if cleaned is not recording:
        _require_enough(cleaned, data)
    if used == len(whole):
        return cleaned, cleaned
    everywhere = screened(whole)
    still = [each for each in everywhere if each["finding"] in ("frozen", "saturated")]
    known = [d for d in data if d["finding"] == "clock_shift" or tells_a_band(d)]
    return settled(without_findings(whole, still + known)), cleaned


def _require_enough(cleaned: Recording, data: list[dict[str, Any]]) -> None:
    try:
        require_diagnosable(cleaned)
    except InputError as error:
        left_out = [d for d in data if d["finding"] in ("frozen", "saturated") and not d.get("seized")]
        seen = "; ".join(f"{d['role']} {d['detail']}" for d in left_out)
        raise InputError(
            f"{error} (left out, because it was not measured: {seen})" if seen else str(error)
        ) from None
