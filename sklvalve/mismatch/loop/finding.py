# SPDX-License-Identifier: BSD-3-Clause
"""What was found in a loop, as an object, as diagnosis.json has it, and as traces for pictures."""

from collections.abc import Container, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import sklvalve
from sklvalve.mismatch.loop.signals import value_role
from sklvalve.recording.calendar_time import begins_of, first_stamp
from sklvalve.recording.recording import Recording


@dataclass(frozen=True, eq=False)
class LoopFinding:
    """What a loop's command and value say of its valve.

    Parameters
    ----------
    verdict : {"named", "no_mismatch", "cannot_tell"}
        ``named``: the stem sticks or has play; ``no_mismatch``: sticking of a relevant size is excluded;
        ``cannot_tell``: neither.
    p_value : float
        How often a healthy loop gives as much evidence, an outside oscillation included.
    alpha : float
        Level of the test.
    evidence : float
        Difference of log likelihood between the best sticking stem of the grid and the command itself: the
        least over several forms of process and noise (:doc:`/loops`) [nats].
    band : float
        Band of the likeliest stem, as a share of the command's movement; below 0.17 on the grid it is no
        finding.
    effects : tuple of dict
        As `effects` in diagnosis.json: members, a `grade` in place of probabilities, parameters with
        intervals, a sentence, what would separate the members.
    fit : dict
        Held-out errors of the value (SI): `held_out_rows`, `rmse` of `nominal` and `corrected`, and
        `noise_floor`, the error of the forecast one row ahead.
    predictions : dict of ndarray
        `time`, `stem`, `nominal`, `corrected`; values as recorded (SI), free runs from the command but for a
        constant level in each quarter of the recording.
    reasons : tuple of str
        Plain sentences: what the verdict rests on, and how the rows were used.
    sampling : dict
        `recorded`, `used` [s], `averaged_rows`, `stretches` and the `stretch` that the figures are of [s].
    oscillation : dict
        Period [s] and regularity of the loop's swing; empty where it was not looked for.
    methods : tuple of dict
        What published methods say: `method`, `statistic`, `limit`, `says`, `source`.
    details : tuple of str
        What the verdict rests on in figures, in sentences for a specialist.
    """

    verdict: str
    p_value: float
    alpha: float
    evidence: float
    band: float
    effects: tuple[dict[str, Any], ...] = ()
    fit: dict[str, Any] = field(default_factory=dict)
    predictions: dict[str, NDArray] = field(default_factory=dict)
    reasons: tuple[str, ...] = ()
    sampling: dict[str, Any] = field(default_factory=dict)
    oscillation: dict[str, Any] = field(default_factory=dict)
    methods: tuple[dict[str, Any], ...] = ()
    details: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Plain dict without the predictions, as it may stand in diagnosis.json."""
        content = asdict(self)
        content.pop("predictions")
        return content


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


def loop_traces(finding: LoopFinding, whole: Recording, used: int) -> dict[str, Any]:
    """Arrays for pictures, of every row, in the recording's own units.

    Parameters
    ----------
    finding : LoopFinding
        Made on the first `used` rows.
    whole : Recording
    used : int

    Returns
    -------
    traces : dict
        As `Diagnosis` keeps them. Simulated values stand between those of the averaged rows on straight
        lines, and are NaN behind the rows used.
    """
    role, named = value_role(whole), finding.verdict == "named"
    # a stem that sticks was tried in any case, and is shown where it was taken up
    sources = {"nominal": "nominal", "corrected": "corrected" if named else "nominal"}
    simulated = {
        kind: _at_every_row(finding, finding.predictions[source], whole, used)
        for kind, source in sources.items()
    }
    roles = [r for r in ("command", role, "setpoint") if r in whole]
    return {
        "time": whole.time - whole.time[0],
        "units": {r: whole.unit(r) for r in roles},
        "recorded": {r: whole.in_recorded_units(r, whole[r]) for r in roles},
        "nominal": {},
        "corrected": {},
        "dp": None,
        "pressure_ratio": None,
        "flagged": _apart(simulated) if named else np.zeros(len(whole), dtype=bool),
        "until": None if used == len(whole) else used,
        "first_stamp": first_stamp(whole),
    } | {kind: {role: whole.in_recorded_units(role, values)} for kind, values in simulated.items()}


def _at_every_row(finding: LoopFinding, values: NDArray, whole: Recording, used: int) -> NDArray:
    """A simulated value at every recorded row; NaN where nothing was simulated."""
    time = finding.predictions["time"]
    known = np.interp(whole.time, time, values)
    known[used:] = np.nan
    if len(finding.sampling.get("stretches", ())) > 1:
        # of a long record one stretch was simulated
        known[(whole.time < time[0]) | (whole.time > time[-1])] = np.nan
    return known


def _apart(simulated: dict[str, NDArray]) -> NDArray[np.bool_]:
    """Rows in which a stem that sticks makes another value than one that does not."""
    gap = np.abs(np.nan_to_num(simulated["corrected"] - simulated["nominal"]))
    return gap > 0.25 * float(np.quantile(gap, 0.99))
