# SPDX-License-Identifier: BSD-3-Clause
"""What a finder is given beside the recording: parameters within their range, a seed, a simulation."""

import json
from dataclasses import replace

import numpy as np
import pytest

from sklvalve.mismatch import CATALOGUE, MissingPhysicsFinder
from sklvalve.recording import InputError, Recording
from sklvalve.simulation import Tolerance, ValveSimulation

from .conftest import ROWS

FEW = ("seat_leakage", "clogging", "flow_meter_bias")


def _signals(recording, *roles):
    return {"time": recording.time} | {role: recording[role] for role in roles}


@pytest.mark.parametrize(
    "wrong",
    [
        {"alpha": 5},
        {"alpha": -1},
        {"alpha": 0.0},
        {"max_effects": -3},
        {"max_effects": 2.5},
        {"evidence": "a"},
        {"evidence": -1.0},
        {"effects": None},
        {"effects": 3},
        {"tolerance": 3},
        {"simulation": 7},
        {"random_state": "x"},
        {"callback": 1},
    ],
    ids=str,
)
def test_parameters_out_of_range_are_refused_in_a_sentence(healthy, wrong):
    (name,) = wrong
    with pytest.raises(ValueError, match=f"The '{name}' parameter of MissingPhysicsFinder must be"):
        MissingPhysicsFinder(**wrong).fit(healthy)


@pytest.mark.parametrize("until", ["300", 300.0, True])
def test_until_is_a_number_of_rows(healthy, until):
    with pytest.raises(InputError, match="until must be a number of rows, got"):
        MissingPhysicsFinder().fit(healthy, until=until)


@pytest.mark.parametrize(
    ("given", "told"), [(np.int64(3), 3), (np.random.RandomState(0), None), (None, None)], ids=str
)
def test_any_seed_is_told_as_plain_data(healthy, given, told):
    finder = MissingPhysicsFinder(effects=("clogging",), max_effects=0, random_state=given).fit(
        healthy.slice(0, 300)
    )
    seed = json.loads(json.dumps(finder.diagnosis_.to_dict()))["provenance"]["random_state"]
    assert type(seed) is int
    assert told is None or seed == told


# ---- a simulation of one's own


def _with_sheet(recording, **changes):
    return replace(recording, valve=replace(recording.valve, **changes))


@pytest.mark.slow
def test_sheet_of_the_simulation_takes_the_place_of_the_recordings(healthy):
    wrong = _with_sheet(healthy, kv_rated=1.5 * healthy.valve.kv_rated)
    few = ("capacity_error", "clogging")
    assert MissingPhysicsFinder(effects=few).fit(wrong).diagnosis_.verdict == "named"
    finder = MissingPhysicsFinder(ValveSimulation(replace(healthy.valve, roles={})), effects=few).fit(wrong)
    assert finder.diagnosis_.verdict == "no_mismatch"
    valve = finder.corrected_simulation_.valve_
    assert valve.kv_rated == healthy.valve.kv_rated
    # how the signals stand in a file is the recording's matter
    assert valve.roles == healthy.valve.roles


@pytest.mark.slow
def test_tolerance_of_the_simulation_counts_where_none_is_given(healthy):
    off = _with_sheet(healthy, kv_rated=1.5 * healthy.valve.kv_rated)
    wide = ValveSimulation(tolerance=Tolerance(capacity=0.6))
    few = ("capacity_error", "clogging")
    assert MissingPhysicsFinder(wide, effects=few).fit(off).diagnosis_.verdict == "no_mismatch"
    strict = MissingPhysicsFinder(wide, tolerance=Tolerance(), effects=few)
    assert strict.fit(off).diagnosis_.verdict == "named"


@pytest.mark.slow
def test_effects_of_the_simulation_are_physics_already_held(leaking):
    leak = next(e for e in CATALOGUE if e.key == "seat_leakage")
    onset = {"seat_leakage": float(leaking.time[500])}
    finder = MissingPhysicsFinder(ValveSimulation(effects=(leak,), onsets=onset), effects=FEW)
    diagnosis = finder.fit(leaking, until=ROWS).diagnosis_
    assert diagnosis.verdict == "no_mismatch"
    for simulation in (finder.nominal_simulation_, finder.corrected_simulation_):
        assert [e.key for e in simulation.effects] == ["seat_leakage"]
        assert simulation.onsets == onset
        assert simulation.values_["seat_leakage.leak_kv"] > 0.0
    # not held, the same leak is what is missing
    assert MissingPhysicsFinder(effects=FEW).fit(leaking, until=ROWS).diagnosis_.verdict == "named"


def test_simulation_that_the_recording_cannot_speak_of_is_refused(healthy):
    leak, choked = (next(e for e in CATALOGUE if e.key == key) for key in ("seat_leakage", "choked_flow"))
    bare = Recording.from_frame(_signals(healthy, "command", "flow"))
    for simulation, recording, words in (
        (ValveSimulation(effects=(choked,)), bare, "holds choked_flow, which needs p1 and p2"),
        (ValveSimulation(effects=("seat_leakage",)), healthy, "got 'seat_leakage'"),
        (ValveSimulation(effects=(leak,), onsets={"clogging": 5.0}), healthy, "an onset for 'clogging'"),
    ):
        with pytest.raises(InputError, match=words):
            MissingPhysicsFinder(simulation).fit(recording)
