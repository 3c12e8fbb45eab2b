# SPDX-License-Identifier: BSD-3-Clause
"""Hand-made diagnoses of all four verdicts, and signals to draw."""

import copy
from types import SimpleNamespace

import numpy as np


def _errors(nominal, black_box, corrected):
    return {"nominal": nominal, "black_box": black_box, "corrected": corrected}


def _diagnosis(verdict, p_value, **parts):
    nothing = {"blocks": [], "regions": [], "onset": None, "intervals": []}
    # each its own: a test may change what it gets
    parts = copy.deepcopy(parts)
    return {
        "schema": "sklvalve.diagnosis/1",
        "verdict": verdict,
        "mismatch": {"detected": p_value < 0.01, "p_value": p_value, "alpha": 0.01},
        "location": nothing,
        "effects": [],
        "proof": "later_rows",
        "fit": {
            "flow": {
                "unit": "m3/h",
                "held_out_rows": 1440,
                "noise_floor": 0.2,
                "rmse": _errors(1.9, 0.5, 0.22),
                "mape": _errors(12.0, 3.1, 1.25),
                "err_max": _errors(60.0, 22.0, 9.0),
                "skill": 0.998,
                "skill_ci95": [0.99, 1.0],
            }
        },
        "not_testable": [{"name": "viscous_flow", "needs": "temperature"}],
        "next_test": "",
        "data": [{"finding": "quantised", "role": "opening", "detail": "steps of 0.5 % of travel"}],
        "provenance": {"sklvalve": "0.1.0", "recording_sha256": "ab" * 32, "rows": 5760, "random_state": 0},
    } | parts


LEAK = {
    "kind": "fault",
    "members": [
        {"name": "seat_leakage", "probability": 0.61},
        {"name": "bypass_open", "probability": 0.36},
    ],
    "probability": 0.97,
    "blocks": ["valve"],
    "parameters": {"leak_kv": {"value": 0.8, "unit": "m3/h", "ci95": [0.7, 0.9]}},
    "sentence": "Flow passes although the plug is on its seat.",
    "separated_by": "Close the block valve of the bypass.",
}
PLAY = {
    "kind": "fault",
    "members": [{"name": "backlash", "probability": 0.999}],
    "probability": 0.999,
    "blocks": ["actuator"],
    "parameters": {"width": {"value": 0.031, "unit": "1", "ci95": [0.029, 0.033]}},
    "sentence": "The stem follows the actuator only after a play is taken up.",
    "separated_by": "",
}
NEAR_SEAT = {
    "blocks": ["valve"],
    "regions": [{"signal": "opening", "low": 0.0, "high": 0.12, "direction": None, "share": 0.021}],
    "onset": 812.0,
    "intervals": [[812.0, 5759.0]],
}


def no_mismatch():
    return _diagnosis("no_mismatch", 0.43)


def named():
    return _diagnosis(
        "named", 4e-4, location=NEAR_SEAT, effects=[LEAK], next_test="Close the valve for 60 s."
    )


def graded():
    """Of a kind of recording on which nobody checked how often names hold."""
    members = [member | {"probability": None} for member in LEAK["members"]]
    grade = {"level": "moderate", "reason": "How often such a diagnosis is right was not checked for gas."}
    leak = LEAK | {"members": members, "probability": None, "grade": grade}
    return named() | {"effects": [leak]}


def named_twice():
    location = NEAR_SEAT | {"blocks": ["actuator", "valve"], "onset": None}
    return _diagnosis("named", 1e-9, location=location, effects=[PLAY, LEAK])


def none_of_these():
    return _diagnosis("none_of_these", 2e-4, location=NEAR_SEAT | {"regions": []})


def cannot_tell():
    undecided = LEAK | {
        "members": [
            {"name": "seat_leakage", "probability": 0.45},
            {"name": "erosion", "probability": 0.3},
        ],
        "probability": 0.75,
    }
    return _diagnosis(
        "cannot_tell",
        0.004,
        location=NEAR_SEAT,
        effects=[undecided],
        fit={},
        next_test="Close the valve for 60 s at two pressure drops.",
    )


ALL = (no_mismatch, named, graded, named_twice, none_of_these, cannot_tell)


def traces(n=3000, *, opening=True, pressures=True, flow=True):
    """Signals of a valve with a leak, as a diagnosis carries them for pictures."""
    rng = np.random.default_rng(0)
    time = np.arange(float(n))
    travel = 0.5 - 0.5 * np.cos(time / 170.0)
    drop = 300.0 + 120.0 * np.sin(time / 410.0)
    nominal = 40.0 * 40.0 ** (travel - 1.0) * np.sqrt(drop / 100.0)
    corrected = nominal + 0.8 * np.sqrt(drop / 100.0) * (time > 800.0)
    recorded = {"command": 100.0 * travel}
    if opening:
        recorded["opening"] = 100.0 * travel + 0.1 * rng.standard_normal(n)
    if flow:
        recorded["flow"] = corrected + 0.2 * rng.standard_normal(n)
        recorded["flow"][1200:1260] = np.nan
    if pressures:
        recorded |= {"p1": drop + 200.0, "p2": np.full(n, 200.0)}
    simulated = {"opening": 100.0 * travel, "flow": nominal}
    return {
        "time": time,
        "units": {"command": "%", "opening": "%", "flow": "m3/h", "p1": "kPa", "p2": "kPa"},
        "recorded": recorded,
        "nominal": simulated,
        "corrected": simulated | {"flow": corrected},
        "pressure_ratio": drop / (drop + 200.0) if pressures else None,
        "flagged": (travel < 0.12) & (time > 800.0),
        "until": 2400,
    }


_FROM_TO = {"low": 10.0, "high": 90.0, "unit": "%"}
SINCE_HISTORY = {
    "rows": 3600,
    "days": 0.5,
    "recordings": 2,
    "first": "2024-01-03T00:00:00",
    "last": "2024-02-11T06:00:00",
    "allowances": [{"name": "capacity", "value": 0.002, "unit": "1", "words": "capacity, relative"}],
    "changes": [],
    "calibration": [
        {"name": "capacity", "unit": "m3/h", "then": 40.0, "ci95": [39.0, 41.0], "now": 40.5}
        | {"deviations": 0.98, "informed": True},
        {"name": "position_zero", "unit": "1", "then": 0.001, "ci95": [-0.001, 0.003], "now": 0.002}
        | {"deviations": 0.98, "informed": True},
        {"name": "trim_2", "unit": "1", "then": 0.01, "ci95": [-0.01, 0.03], "now": 0.04}
        | {"deviations": 2.94, "informed": True},
        {"name": "knee", "unit": "1", "then": 12.0, "ci95": [3.0, 40.0], "now": 13.0}
        | {"deviations": 0.1, "informed": False},
    ],
    "residuals": {"flow": {"unit": "m3/h", "history": 0.2, "by_then": 0.9, "by_now": 0.21}},
    "cannot_say": {
        "outside": [{"signal": "command", "share": 0.25, "history": _FROM_TO, "here": _FROM_TO}],
        "not_informed": ["knee"],
    },
}


def since_history(made):
    """The same diagnosis, made with a history."""
    flow = {"value": 2.4, "unit": "m3/h", "ci95": [2.1, 2.7], "at_the_same": "opening"}
    change = {"name": "", "parameter": "", "value": 0.8, "unit": "m3/h", "ci95": [0.7, 0.9], "flow": flow}
    part = copy.deepcopy(SINCE_HISTORY) | {"changes": [copy.deepcopy(change) for _ in made["effects"]]}
    recordings = [{"name": "before.csv", "sha256": "cd" * 32}]
    provenance = made["provenance"] | {"history": {"rows": 3600, "recordings": recordings}}
    return made | {"since_history": part, "provenance": provenance}


def traces_since(**settings):
    """Signals to draw, with those of the calibration that a history lets expect."""
    made = traces(**settings)
    then = {role: values.copy() for role, values in made["nominal"].items()}
    scatter = {role: np.full(len(values), 0.1) for role, values in then.items()}
    return made | {"then": then, "then_scatter": scatter}


def diagnosis(made, **settings):
    """What `write_report` takes, of a made dict."""
    return SimpleNamespace(to_dict=lambda: made, traces=traces(**settings))
