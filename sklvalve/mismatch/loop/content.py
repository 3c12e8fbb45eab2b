# SPDX-License-Identifier: BSD-3-Clause
"""A loop's finding laid out as diagnosis.json has it."""

from collections.abc import Container, Sequence
from typing import Any

import sklvalve
from sklvalve.mismatch.loop.finding import LoopFinding
from sklvalve.mismatch.loop.signals import value_role
from sklvalve.recording.calendar_time import begins_of
from sklvalve.recording.recording import Recording


def loop_content(
    finding: LoopFinding, recording: Recording, *, data: Sequence[dict[str, Any]] = (), random_state: int = 0
) -> dict[str, Any]:
    """Plain data of diagnosis.json, schema ``sklvalve.diagnosis/1``.

    Parameters
    ----------
    finding : LoopFinding
    recording : Recording
        That the finding was made on.
    data : sequence of dict
        Findings about the data themselves: `finding`, `role`, `detail`.
    random_state : int

    Returns
    -------
    content : dict
        Errors on rows ahead in time, in the recording's own unit, without an interval of the skill.
    """
    named = finding.verdict == "named"
    return {
        "schema": "sklvalve.diagnosis/1",
        "subject": "loop",
        "verdict": finding.verdict,
        "mismatch": {"detected": named, "p_value": finding.p_value, "alpha": finding.alpha},
        "location": {
            "blocks": ["actuator"] if named else [],
            "regions": [],
            "onset": None,
            "intervals": [[0.0, float(recording.time[-1] - recording.time[0])]] if named else [],
            "change": None,
        },
        "effects": [{"kind": "fault"} | dict(effect) for effect in finding.effects],
        "fit": {value_role(recording): _errors(finding, recording)},
        "proof": "forward",
        "not_testable": [{"name": name, "needs": needs} for name, needs in _not_testable(recording)],
        "next_test": _next_test(finding),
        "data": list(data),
        "reasons": list(finding.reasons),
        "sampling": dict(finding.sampling),
        "oscillation": dict(finding.oscillation),
        "methods": [dict(method) for method in finding.methods],
        "provenance": {
            "sklvalve": sklvalve.__version__,
            "recording_sha256": recording.sha256,
            "rows": len(recording),
            "random_state": random_state,
            **begins_of(recording),
        },
        "units": {role: recording.unit(role) for role in recording},
        "details": list(finding.details),
    }


def _errors(finding: LoopFinding, recording: Recording) -> dict[str, Any]:
    """Held-out errors of the value, in the recording's own unit."""
    role = value_role(recording)
    unit = abs(recording.per_si(role))
    nominal, corrected, box = (finding.fit["rmse"][k] for k in ("nominal", "corrected", "black_box"))
    # a stem that sticks was tried; where it is not taken up, or makes rows ahead worse, nothing is corrected
    corrected = min(nominal, corrected) if finding.verdict == "named" else nominal
    floor = min(finding.fit["noise_floor"], nominal, corrected)
    room = nominal**2 - floor**2
    return {
        "unit": recording.unit(role),
        "held_out_rows": finding.fit["held_out_rows"],
        "noise_floor": float(floor * unit),
        "rmse": {
            "nominal": float(nominal * unit),
            "black_box": float(box * unit),
            "corrected": float(corrected * unit),
        },
        "skill": float((nominal**2 - corrected**2) / room) if room > 0.0 else None,
    }


def _next_test(finding: LoopFinding) -> str | None:
    """What to record next; None where nothing is left to ask."""
    if finding.effects:
        return finding.effects[0]["separated_by"]
    if finding.verdict == "cannot_tell":
        return "Put the loop in manual and ramp the command slowly up and down, further than it moves now."
    return None


def _not_testable(recording: Container[str]) -> list[tuple[str, str]]:
    """Every effect but sticking, with the roles it needs, because nothing says what drives the flow."""
    from sklvalve.mismatch.effects import CATALOGUE

    missing = " and ".join(role for role in ("opening", "flow", "p1", "p2") if role not in recording)
    names = dict.fromkeys(effect.name for effect in CATALOGUE)
    return [(name, missing) for name in names if name not in ("stiction", "backlash")]
