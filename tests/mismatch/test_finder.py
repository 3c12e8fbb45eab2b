# SPDX-License-Identifier: BSD-3-Clause
"""From short recordings to their diagnoses: right, repeatable, blind to later rows, plain about bad input."""

import json
from dataclasses import replace

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.metrics import r2_score

from sklvalve.mechanism import ValidityWarning
from sklvalve.mismatch import CATALOGUE, MissingPhysicsFinder
from sklvalve.mismatch.constants import NAMED_FROM
from sklvalve.recording import InputError, Recording, Valve
from sklvalve.simulation import Tolerance, ValveSimulation

from .conftest import ROWS, record

KEYS = {
    "schema",
    "verdict",
    "mismatch",
    "location",
    "effects",
    "fit",
    "not_testable",
    "next_test",
    "data",
    "provenance",
}
FEW = ("seat_leakage", "clogging", "flow_meter_bias")


def _signals(recording, *roles):
    return {"time": recording.time} | {role: recording[role] for role in roles}


# ---- what is found


def test_healthy_valve_has_no_mismatch(found_healthy, healthy):
    diagnosis = found_healthy.diagnosis_
    content = diagnosis.to_dict()
    assert diagnosis.verdict == "no_mismatch"
    assert diagnosis.effects == ()
    assert content["mismatch"]["detected"] is False
    assert content["mismatch"]["p_value"] > content["mismatch"]["alpha"] == 0.01
    nowhere = {"blocks": [], "regions": [], "onset": None, "intervals": [], "change": None}
    assert content["location"] == nowhere
    nominal, corrected = found_healthy.nominal_simulation_, found_healthy.corrected_simulation_
    np.testing.assert_array_equal(corrected.predict(healthy), nominal.predict(healthy))


def test_leak_that_begins_is_found_with_its_time_and_proven(found_leaking, leaking):
    diagnosis = found_leaking.diagnosis_
    content = diagnosis.to_dict()
    assert diagnosis.verdict == "named"
    assert len(diagnosis.effects) == 1
    # no signal tells a leak from an open bypass, and it says so
    assert {"seat_leakage", "bypass_open"} <= set(diagnosis.effects[0])
    assert "valve" in content["location"]["blocks"]
    assert content["location"]["onset"] == pytest.approx(500.0, abs=20.0)
    error = content["fit"]["flow"]["rmse"]
    assert content["fit"]["flow"]["held_out_rows"] == 300
    assert error["corrected"] < 0.3 * error["nominal"]
    assert error["corrected"] < 0.5 * error["black_box"]
    recorded = leaking["flow"][ROWS:]
    corrected = found_leaking.corrected_simulation_.predict(leaking)[ROWS:]
    assert np.sqrt(np.mean((corrected - recorded) ** 2)) == pytest.approx(
        error["corrected"] / 3600.0, rel=1e-6
    )


@pytest.mark.parametrize(
    ("name", "strength", "seed", "onset", "parameter", "size"),
    [
        ("clogging", 0.5, 3, 0.0, "limit", 0.5),
        # of the flow span, one and a half times the rated capacity
        ("flow_meter_bias", 0.04, 1, 0.0, "bias", None),
    ],
)
def test_effect_is_named_with_its_size(name, strength, seed, onset, parameter, size):
    recording = record(name, strength, random_state=seed, onset=onset)
    diagnosis = MissingPhysicsFinder().fit(recording).diagnosis_
    assert diagnosis.verdict == "named"
    assert any(name in members for members in diagnosis.effects)
    (entry,) = diagnosis.content["effects"]
    told = entry["parameters"][parameter]
    if size is None:
        assert told["unit"] == "m3/h"
        size = strength * 1.5 * recording.valve.kv_rated
    assert told["value"] == pytest.approx(size, rel=0.3)
    assert told["ci95"][0] <= told["value"] <= told["ci95"][1]
    assert entry["probability"] >= NAMED_FROM
    assert entry["grade"]["level"] != "weak"
    assert entry["sentence"][0].isupper()
    assert entry["sentence"].endswith(".")


# ---- what is predicted


def test_predict_is_the_corrected_flow(found_leaking, leaking):
    corrected = found_leaking.corrected_simulation_
    np.testing.assert_array_equal(found_leaking.predict(leaking), corrected.predict(leaking))
    np.testing.assert_array_equal(found_leaking.predict(leaking), corrected.simulate(leaking)["flow"])
    table = leaking.to_frame()
    np.testing.assert_allclose(found_leaking.predict(table), found_leaking.predict(leaking), rtol=1e-9)


def test_the_corrected_simulation_has_a_score(found_leaking, leaking):
    later = leaking.slice(ROWS, None)
    score = found_leaking.corrected_simulation_.score(later)
    assert score == pytest.approx(r2_score(later["flow"], found_leaking.predict(later)))
    assert score > found_leaking.nominal_simulation_.score(later)


def test_what_cannot_predict_says_so(leaking):
    with pytest.raises(NotFittedError):
        MissingPhysicsFinder().predict(leaking)
    loop = Recording.from_frame(_signals(leaking, "command", "flow"))
    finder = MissingPhysicsFinder().fit(loop)
    with pytest.raises(InputError, match="a loop without pressures, of which there is no simulation"):
        finder.predict(leaking)


# ---- what it is made of


def test_diagnosis_has_the_schema_and_is_json(found_healthy, found_leaking):
    for finder in (found_healthy, found_leaking):
        content = finder.diagnosis_.content
        assert set(content) >= KEYS
        assert content["schema"] == "sklvalve.diagnosis/1"
        assert json.loads(json.dumps(content, allow_nan=False)) == finder.diagnosis_.to_dict()
        assert set(content["mismatch"]) == {"detected", "p_value", "alpha"}
        assert set(content["location"]) >= {"blocks", "regions", "onset", "intervals"}
        assert set(content["fit"]) == {"opening", "flow"}
        for channel in content["fit"].values():
            assert set(channel) >= {"unit", "held_out_rows", "noise_floor", "rmse", "mape", "err_max"}
            assert set(channel["rmse"]) == {"nominal", "black_box", "corrected"}
        for entry in content["effects"]:
            assert set(entry) == {
                "members",
                "probability",
                "blocks",
                "size",
                "onset",
                "parameters",
                "sentence",
                "separated_by",
                "grade",
                "evidence",
                "kind",
            }
            assert {m["name"] for m in entry["members"]} <= {e.name for e in CATALOGUE}
        assert content["provenance"]["rows"] == ROWS


def test_traces_are_of_one_length_and_in_recorded_units(found_leaking, leaking):
    traces, n = found_leaking.diagnosis_.traces, len(leaking)
    assert len(traces["time"]) == len(traces["flagged"]) == n
    assert traces["until"] == ROWS
    assert traces["units"]["flow"] == "m3/h"
    np.testing.assert_allclose(traces["recorded"]["flow"], leaking["flow"] * 3600.0, rtol=1e-9)
    for kind in ("nominal", "corrected"):
        assert len(traces[kind]["flow"]) == n


def test_finder_keeps_the_conventions_of_an_estimator(found_leaking):
    finder = MissingPhysicsFinder(effects=FEW, alpha=0.05, tolerance=Tolerance(capacity=0.2))
    assert clone(finder).get_params() == finder.get_params()
    assert isinstance(found_leaking.corrected_simulation_, ValveSimulation)
    assert not hasattr(clone(found_leaking), "diagnosis_")


# ---- same again, and blind to what is held out


@pytest.mark.slow
def test_same_recording_gives_the_same_diagnosis(leaking):
    first, second = (MissingPhysicsFinder(effects=FEW).fit(leaking.slice(0, ROWS)) for _ in range(2))
    assert first.diagnosis_.to_dict() == second.diagnosis_.to_dict()
    assert first.corrected_simulation_.values_ == second.corrected_simulation_.values_


@pytest.mark.slow
def test_later_rows_serve_nothing_but_the_fit_figures(leaking):
    rng = np.random.default_rng(0)
    changed = dict(leaking.signals)
    for role in ("flow", "opening", "command", "p1", "p2"):
        changed[role] = changed[role].copy()
        changed[role][ROWS:] *= rng.uniform(0.7, 0.9, len(leaking) - ROWS)
    other = Recording(
        leaking.time, leaking.stamps, changed, leaking.valve, leaking.constants, leaking.mass_flow
    )
    stages = []
    first = MissingPhysicsFinder(effects=FEW).fit(leaking, until=ROWS)
    second = MissingPhysicsFinder(effects=FEW, callback=lambda stage, done: stages.append(done))
    second.fit(other, until=ROWS)
    one, two = first.diagnosis_.to_dict(), second.diagnosis_.to_dict()
    assert one.pop("fit") != two.pop("fit")
    assert one == two
    assert first.corrected_simulation_.values_ == second.corrected_simulation_.values_
    # and on the way it told how far it was
    assert stages[0] == 0.0
    assert stages[-1] == 1.0


# ---- fewer signals


def test_with_few_signals_the_finder_says_what_it_cannot_test(healthy):
    bare = Recording.from_frame(_signals(healthy, "command", "flow", "p1"))
    finder = MissingPhysicsFinder(effects=("choked_flow", "position_sensor_bias", "clogging", "dead_time"))
    content = finder.fit(bare).diagnosis_.to_dict()
    assert set(content["fit"]) == {"flow"}
    needs = {item["name"]: item["needs"] for item in content["not_testable"]}
    assert needs["choked_flow"] == "p2"
    assert needs["position_sensor_bias"] == "opening"
    assert "dead_time" not in needs


# ---- bad input


def test_too_few_rows(healthy):
    with pytest.raises(InputError, match="100 rows are too few for a diagnosis; give at least 120"):
        MissingPhysicsFinder().fit(healthy.slice(0, 100))
    with pytest.raises(InputError, match="a later time"):
        MissingPhysicsFinder().fit(healthy, until=50)


def test_unknown_effect(healthy):
    with pytest.raises(InputError, match="'gremlins', which is no effect"):
        MissingPhysicsFinder(effects=("clogging", "gremlins")).fit(healthy)
    with pytest.raises(InputError, match="'leak', which is no effect"):
        MissingPhysicsFinder(effects="leak").fit(healthy)


def test_unknown_physics(healthy):
    sheet = healthy.valve.to_dict()
    sheet.pop("recording")
    sheet["simulation"] = {"physics": ["phlogiston"]}
    frame = _signals(healthy, "command", "opening", "p1", "p2", "temperature", "flow")
    with pytest.raises(InputError, match="phlogiston"):
        MissingPhysicsFinder().fit(Recording.from_frame(frame, Valve.from_dict(sheet)))


def test_neither_flow_nor_opening(healthy):
    frame = _signals(healthy, "command", "p1", "p2")
    with pytest.raises(InputError, match="needs an opening beside the command, or a flow"):
        MissingPhysicsFinder().fit(Recording.from_frame(frame))


def test_a_bare_array_is_refused():
    with pytest.raises(InputError, match="signals by name"):
        MissingPhysicsFinder().fit(np.zeros((500, 4)))


@pytest.fixture(scope="module")
def drifting():
    whole = record("flow_meter_drift", 0.1, random_state=4, n_later=700)
    seen, later = whole.slice(0, ROWS), whole.slice(ROWS, None)
    finder = MissingPhysicsFinder(effects=["flow_meter_drift", "seat_leakage"]).fit(seen)
    assert finder.diagnosis_.to_dict()["verdict"] == "named"
    return finder, seen, later


def _wrong(simulation, later):
    return abs(np.nanmean(simulation.simulate(later)["flow"] - later["flow"]))


@pytest.mark.slow
def test_what_grows_goes_on_growing_in_later_rows(drifting):
    finder, seen, later = drifting
    nominal = _wrong(finder.nominal_simulation_, later)
    # a drift begun anew would leave all that has gathered by then
    assert _wrong(finder.corrected_simulation_, later) < 0.2 * nominal
    given = ValveSimulation(effects=finder.corrected_simulation_.effects).fit(seen)
    assert _wrong(given, later) < 0.2 * nominal


def test_what_grows_is_not_followed_on_another_clock(drifting):
    finder, seen, later = drifting
    with pytest.warns(ValidityWarning, match="flow_meter_drift: this recording begins .* h after the end"):
        far = _wrong(finder.corrected_simulation_, replace(later, stamps=later.stamps + 1.7e9))
    anew = replace(later, stamps=later.stamps - later.stamps[0] + seen.stamps[0])
    assert far == pytest.approx(_wrong(finder.corrected_simulation_, anew))
