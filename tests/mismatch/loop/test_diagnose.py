# SPDX-License-Identifier: BSD-3-Clause
"""Whole diagnoses: drawn loops, records that are refused, the plant's own verdicts."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from benchmarks.loop_alarms import recording_of
from benchmarks.loop_plant import draw_loop
from sklvalve.mismatch.loop import diagnose_loop, stick_slip
from sklvalve.recording import InputError, Recording

TIME = 10.0 * np.arange(400)


def _open_loop(stick, slip, seed=0, gain=0.01):
    rng = np.random.default_rng(seed)
    swings = 0.02 * np.sin(TIME / 300.0) + 0.015 * np.sin(TIME / 127.0 + 1.0)
    command = 0.5 + swings + 0.0005 * rng.standard_normal(len(TIME))
    flow = gain * stick_slip(command, stick, slip) + 2e-5 * rng.standard_normal(len(TIME))
    return command, flow


def _recording(**columns):
    return Recording.from_frame({"time": TIME, **columns})


def test_sticking_is_named_with_its_size():
    command, flow = _open_loop(0.02, 0.014)
    found = diagnose_loop(_recording(command=command, flow=flow))
    assert found.verdict == "named"
    assert found.p_value <= found.alpha
    names = {member["name"] for member in found.effects[0]["members"]}
    assert "stiction" in names
    low, high = found.effects[0]["parameters"]["stick"]["ci95"]
    assert low <= 0.02 <= high
    # four quarters of two reversals each: no worse than the command itself
    assert found.fit["rmse"]["corrected"] < 1.1 * found.fit["rmse"]["nominal"]


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_play_is_in_the_class_where_there_is_no_jump(seed):
    command, flow = _open_loop(0.02, 0.0, seed)
    members = diagnose_loop(_recording(command=command, flow=flow)).effects[0]["members"]
    assert "backlash" in {member["name"] for member in members}
    # of the first a small jump fits as well
    if seed:
        assert members[0]["name"] == "backlash"


def test_a_class_has_a_grade_and_no_probability():
    command, flow = _open_loop(0.02, 0.014)
    found = diagnose_loop(_recording(command=command, flow=flow))
    effect = found.effects[0]
    assert effect["probability"] is None
    assert {member["probability"] for member in effect["members"]} == {None}
    assert effect["grade"]["level"] in ("strong", "moderate", "weak")
    assert "turn" in effect["grade"]["reason"]
    assert "nats" not in " ".join([effect["grade"]["reason"], *found.reasons])
    assert "nats" in found.details[0]
    for size in effect["parameters"].values():
        assert size["ci95"][0] <= size["value"] <= size["ci95"][1]


def _sampled(every, rows, period=300.0, seed=0):
    """A flow loop that sticks, recorded at some rate, without a set-point."""
    rng = np.random.default_rng(seed)
    time = every * np.arange(rows)
    turns = 2 * np.pi * time / period
    command = 0.5 + 0.02 * np.sin(turns) + 0.008 * np.sin(turns / 2.7) + 0.0003 * rng.standard_normal(rows)
    value = 0.01 * stick_slip(command, 0.015, 0.007) + 3e-6 * rng.standard_normal(rows)
    return Recording.from_frame({"time": time, "command": command, "flow": value})


@pytest.mark.slow
@pytest.mark.parametrize("every", [0.6, 3.0, 10.0])
def test_the_rate_recorded_is_used(every):
    found = diagnose_loop(_sampled(every, 1500))
    assert found.verdict == "named"
    assert found.sampling["recorded"] == pytest.approx(every)
    # rows are averaged where a swing has 500 of them, and that is said
    assert (found.sampling["averaged_rows"] > 1) == any("mean of" in reason for reason in found.reasons)


def test_times_in_another_unit_change_nothing():
    one, other = diagnose_loop(_sampled(1.0, 800)), diagnose_loop(_sampled(10.0, 800, period=3000.0))
    assert one.evidence == pytest.approx(other.evidence, rel=1e-9)


def test_a_command_that_drifts_at_constant_flow_is_not_called_sticking():
    # a supply that falls: the controller opens, and the flow stays
    rng = np.random.default_rng(2)
    command = 0.5 + 0.018 * TIME / TIME[-1] + 0.0003 * rng.standard_normal(len(TIME))
    flow = 0.01 + 2e-5 * rng.standard_normal(len(TIME))
    found = diagnose_loop(_recording(command=command, flow=flow))
    assert found.verdict == "cannot_tell"
    assert not found.effects


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["flow", "pressure", "level"])
def test_a_drifting_supply_or_gain_is_never_surely_called_sticking(kind):
    # one healthy loop in a hundred is called so; a command that hardly turns makes the grade weak
    for seed in range(700, 703):
        try:
            found = diagnose_loop(recording_of(draw_loop(seed, kind, "drift")))
        except InputError:
            continue
        levels = [effect["grade"]["level"] for effect in found.effects]
        assert found.verdict != "named" or levels == ["weak"]


def test_the_oscillation_and_published_methods_are_reported():
    found = diagnose_loop(_sampled(3.0, 1500))
    assert found.oscillation["period"] == pytest.approx(300.0, rel=0.1)
    assert {"method", "statistic", "limit", "says", "source"} <= set(found.methods[0])


@pytest.mark.parametrize("role", ["command", "flow"])
def test_a_gap_at_the_beginning_costs_no_diagnosis(role):
    columns = dict(zip(("command", "flow"), _open_loop(0.02, 0.014), strict=True))
    columns[role][0] = np.nan
    found = diagnose_loop(_recording(**columns))
    assert found.verdict == "named"
    assert np.isfinite(found.fit["rmse"]["corrected"])


def test_a_valve_that_follows_is_not_blamed_and_wide_bands_are_excluded():
    command, flow = _open_loop(0.0, 0.0)
    found = diagnose_loop(_recording(command=command, flow=flow))
    assert found.verdict == "no_mismatch"
    assert not found.effects


def test_a_flow_that_the_command_does_not_move_tells_nothing():
    command, _ = _open_loop(0.0, 0.0)
    flow = 0.01 + 1e-4 * np.random.default_rng(7).standard_normal(len(TIME))
    found = diagnose_loop(_recording(command=command, flow=flow))
    assert found.verdict == "cannot_tell"
    assert "does not visibly follow" in found.reasons[0]


def test_the_unit_of_the_value_changes_nothing():
    command, flow = _open_loop(0.02, 0.01)
    one = diagnose_loop(_recording(command=command, flow=flow))
    other = diagnose_loop(_recording(command=command, flow=3600.0 * flow))
    assert one.evidence == pytest.approx(other.evidence, rel=1e-6)
    assert one.band == other.band


@pytest.mark.slow
def test_healthy_drawn_loops_are_not_called_sticking():
    called = 0
    for seed in range(500, 503):
        for kind in ("flow", "level"):
            for scene in ("quiet", "setpoint", "upsets"):
                try:
                    found = diagnose_loop(recording_of(draw_loop(seed, kind, scene)))
                except InputError:  # the command of a level may run to its limit
                    continue
                called += found.verdict == "named"
    assert called <= 1


@pytest.mark.slow
def test_flow_loops_that_cycle_because_they_stick_are_mostly_found():
    found = [
        diagnose_loop(recording_of(draw_loop(seed, "flow", "bad_tuning", sticking=True))).verdict == "named"
        for seed in range(600, 606)
    ]
    assert sum(found) >= 3


def test_held_rows_count_for_nothing():
    command, flow = _open_loop(0.02, 0.01)
    for begin in range(20, 380, 40):
        command[begin : begin + 12] = command[begin]
        flow[begin : begin + 12] = flow[begin]
    found = diagnose_loop(_recording(command=command, flow=flow))
    # six of the nine begin behind the first origin, which is at 40 %
    assert found.fit["held_out_rows"] == 240 - 60


def test_the_finding_is_plain_data_and_repeats_itself():
    command, flow = _open_loop(0.02, 0.01)
    one = diagnose_loop(_recording(command=command, flow=flow))
    other = diagnose_loop(_recording(command=command, flow=flow), random_state=1)
    assert json.dumps(one.to_dict()) == json.dumps(other.to_dict())
    assert one.predictions["corrected"].shape == TIME.shape


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"flow": np.full(400, 1e-3)}, "one value"),
        ({"flow": np.where(np.arange(400) < 20, 1e-3, 1e-9 * np.arange(400))}, "near zero"),
        ({"command": np.where(np.arange(400) < 200, 1.0, 0.5)}, "at its limit"),
        ({"command": np.where(np.arange(400) == 7, 0.6, 0.5)}, "at rest"),
        ({"command": np.linspace(3.0, 4.0, 400)}, "its unit|no command"),
    ],
)
def test_what_cannot_be_judged_is_refused_in_a_sentence(change, message):
    command, flow = _open_loop(0.0, 0.0)
    with pytest.raises(InputError, match=message):
        diagnose_loop(_recording(**({"command": command, "flow": flow} | change)))


def test_a_missing_role_is_named():
    with pytest.raises(InputError, match="there is no "):
        diagnose_loop(_recording(command=_open_loop(0.0, 0.0)[0]))


def test_a_senseless_level_is_refused():
    command, flow = _open_loop(0.0, 0.0)
    with pytest.raises(ValueError, match="between 0 and 1"):
        diagnose_loop(_recording(command=command, flow=flow), alpha=1.0)


@pytest.mark.slow
def test_the_plants_own_verdicts_by_tag():
    folder = Path(os.environ.get("SKLVALVE_DATA", "")) / "refinery_loops"
    if not os.environ.get("SKLVALVE_DATA") or not (folder / "index.csv").exists():
        pytest.skip("SKLVALVE_DATA names no folder with refinery_loops")
    pytest.importorskip("pandas")
    from benchmarks.refinery import judged

    table = judged(folder)
    named = table.verdict == "named"
    for tag in ("2411FIC20102", "2111FIC46005", "FIC31102"):
        assert named[table.tag == tag].mean() >= 0.8
    healthy = table.sticking == 0
    flows = table.loop == "FIC"
    assert table.tag[named & healthy & flows].nunique() <= 1
    assert (named & healthy & ~flows).sum() <= 2
    assert (table.verdict[table.tag.isin(["2411FIC10104", "FIC10112"])] == "refused").all()


@pytest.mark.parametrize("rows", [100, 119, 130])
def test_few_rows_are_enough_to_be_answered(rows):
    rng = np.random.default_rng(rows)
    command = 0.5 + 0.05 * np.sin(np.arange(rows) / 6.0) + 0.002 * rng.standard_normal(rows)
    value = 1.0 + 0.5 * np.roll(command, 1) + 0.001 * rng.standard_normal(rows)
    recording = Recording.from_frame({"time": np.arange(rows), "command": command, "flow": value})
    assert diagnose_loop(recording).verdict in ("no_mismatch", "cannot_tell")


@pytest.mark.slow
def test_fresh_rows_between_the_stretches_are_looked_at():
    rng = np.random.default_rng(1)
    command, value = np.full(7000, 0.5), np.full(7000, 1.0)
    fresh = slice(2000, 2500)
    command[fresh] = 0.5 + 0.05 * np.sin(np.arange(500) / 6.0) + 0.002 * rng.standard_normal(500)
    value[fresh] = 1.0 + 0.5 * command[fresh] + 0.001 * rng.standard_normal(500)
    recording = Recording.from_frame({"time": np.arange(7000), "command": command, "flow": value})
    assert diagnose_loop(recording).verdict in ("no_mismatch", "cannot_tell")
