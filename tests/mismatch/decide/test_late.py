# SPDX-License-Identifier: BSD-3-Clause
"""What happens in the last rows: found by a simulation of those before, and not where nothing happens."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from benchmarks.late_plant import ENDS, record
from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.decide import late as module
from sklvalve.mismatch.decide.late import before
from sklvalve.mismatch.effects import CATALOGUE, LATE
from sklvalve.mismatch.residual.change import Change, stands_out
from sklvalve.simulation.noise import NoiseModel

ROWS = 1500
BLOCKED, FAILED = LATE


def _recording(kind, seed=3):
    columns, sheet, truth = record(kind, ROWS, seed)
    return Recording.from_frame(pd.DataFrame(columns), Valve.from_dict(sheet)), truth


@pytest.mark.slow
def test_an_event_of_the_last_rows_is_dated_and_named():
    recording, truth = _recording("slammed")
    finder = MissingPhysicsFinder(effects=["stuck_valve", "slew_limit"], max_effects=1, n_jobs=1)
    told = finder.fit(recording).diagnosis_.to_dict()
    assert told["verdict"] == "named"
    change = told["location"]["change"]
    assert abs(change["time"] - truth["time"]) < 30.0
    assert change["p_value"] <= 1e-3
    (event,) = (e for e in told["effects"] if e["onset"] is not None and e["onset"] > 0.94 * ROWS)
    assert truth["name"] in [m["name"] for m in event["members"]]
    assert not told.get("reasons")


@pytest.mark.slow
def test_an_air_supply_that_falls_at_the_end_is_told_from_no_stem_that_stands_still():
    made = make_valve_recording(
        "supply_pressure_drop", 0.85, loop="closed", onset=1430.0, n_samples=1500, n_later=0, random_state=2
    )
    recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    told = MissingPhysicsFinder(n_jobs=1, random_state=0).fit(recording).diagnosis_.to_dict()
    (event,) = told["effects"]
    assert event["onset"] > 1430.0
    assert {"supply_pressure_drop", "stuck_valve"} <= {m["name"] for m in event["members"]}


@pytest.mark.slow
def test_a_sound_valve_has_no_event_at_its_end():
    recording, _ = _recording("healthy")
    finder = MissingPhysicsFinder(effects=["stuck_valve", "slew_limit"], max_effects=1, n_jobs=1)
    told = finder.fit(recording).diagnosis_.to_dict()
    assert told["location"]["change"] is None
    assert all(e["onset"] is None for e in told["effects"])


def test_the_rows_before_keep_their_clock():
    recording, _ = _recording("healthy")
    event = SimpleNamespace(within=(1400, 1410))
    blank = before(recording, event)
    assert len(blank) == ROWS
    assert np.isfinite(blank["flow"][:1400]).all()
    assert np.isnan(blank["flow"][1400:]).all()
    assert np.array_equal(blank["command"], recording["command"])


def test_a_change_counts_by_size_and_by_rarity():
    bench = SimpleNamespace(least=lambda channel: 0.005, spans={"flow": 2.0})
    large = {"channel": "flow", "row": 1, "within": (0, 2), "response": 0.0}
    assert stands_out(bench, Change(size=-0.03, p_value=1e-5, **large), 0.01)
    assert not stands_out(bench, Change(size=-0.03, p_value=5e-3, **large), 0.01)
    assert not stands_out(bench, Change(size=0.015, p_value=1e-9, **large), 0.01)


@pytest.mark.parametrize("verdict", ["cannot_tell", "none_of_these"])
def test_behind_a_difference_without_a_name_no_other_effect_has_begun(verdict):
    assert list(module._may_be_new(SimpleNamespace(verdict=verdict), CATALOGUE)) == []


@pytest.mark.parametrize("verdict", ["no_mismatch", "named"])
def test_behind_what_is_known_any_effect_may_have_begun(verdict):
    assert module._may_be_new(SimpleNamespace(verdict=verdict), CATALOGUE) is CATALOGUE


def test_noise_of_the_rows_before_goes_on():
    white = np.where(np.arange(100) < 80, 4.0, np.inf)
    white[10] = np.inf
    noise = NoiseModel(white, np.ones(100), 3.0, 0.1, 50.0, 0.1)
    longer = module._throughout(noise, 80)
    assert np.all(longer.white[80:] == 4.0)
    # a gap before stays one
    assert longer.white[10] == np.inf
    assert np.isinf(module._without(longer, 80, 90).white[80:90]).all()


def test_what_ends_a_flow_is_in_no_catalogue():
    keys = {e.key for e in CATALOGUE}
    assert not keys & {e.key for e in LATE}
    assert {e.name for e in LATE} < set(filter(None, ENDS.values()))
    flow = np.array([1.0, 2.0])
    assert BLOCKED.apply(flow, {"free": 0.5}, None).tolist() == [0.5, 1.0]
    assert FAILED.apply(flow, {"reading": 0.2}, None).tolist() == [0.2, 0.2]


def test_a_flow_that_ends_at_zero_is_shifted_by_no_zero():
    bench = SimpleNamespace(
        least=lambda channel: 0.005, spans={"flow": 1.0}, recording={"flow": np.array([1.0, 0.001, 0.002])}
    )
    places = [(SimpleNamespace(effect=SimpleNamespace(key=k)), None) for k in ("bias", "clogging_blocked")]
    left = module._no_coincidence(bench, places, {"clogging_blocked"}, "flow", 1)
    assert [who.effect.key for who, _ in left] == ["clogging_blocked"]
    bench.recording["flow"][1:] = 0.5
    assert module._no_coincidence(bench, places, {"clogging_blocked"}, "flow", 1) == places
