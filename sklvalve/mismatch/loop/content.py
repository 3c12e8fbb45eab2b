# SPDX-License-Identifier: BSD-3-Clause
"""A loop's finding laid out as diagnosis.json has it."""

import sklvalve
from sklvalve.recording.calendar_time import begins_of


def loop_content(finding, recording, *, data=(), random_state=0):
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
    role = "flow" if "flow" in recording else "process_value"
    unit = abs(recording.per_si(role))
    nominal, corrected, box = (finding.fit["rmse"][k] for k in ("nominal", "corrected", "black_box"))
    named = finding.verdict == "named"
    # a stem that sticks was tried; where it is not taken up, or makes rows ahead worse, nothing is corrected
    corrected = min(nominal, corrected) if named else nominal
    floor = min(finding.fit["noise_floor"], nominal, corrected)
    room = nominal**2 - floor**2
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
        "fit": {
            role: {
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
        },
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


def _next_test(finding):
    if finding.effects:
        return finding.effects[0]["separated_by"]
    if finding.verdict == "cannot_tell":
        return "Put the loop in manual and ramp the command slowly up and down, further than it moves now."
    return None


def _not_testable(recording):
    """Everything in the valve itself, because nothing says what drives the flow."""
    from sklvalve.mismatch.effects import CATALOGUE

    seen = ("stiction", "backlash")
    others = [role for role in ("opening", "flow", "p1", "p2") if role not in recording]
    names = dict.fromkeys(effect.name for effect in CATALOGUE if effect.name not in seen)
    return [(name, " and ".join(others)) for name in names]
