# SPDX-License-Identifier: BSD-3-Clause
"""The chain: what no effect touches stays, an onset leaves the rows before it, the flow is the standard's."""

import numpy as np
import pytest

from sklvalve.mechanism import fluid_from, liquid_flow
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.recording import InputError, Recording, Valve
from sklvalve.simulation import Tolerance
from sklvalve.simulation.calibration import (
    apparent_kv,
    channels_of,
    choose_trim,
    flow_parameters,
    opening_parameters,
    span_of,
)
from sklvalve.simulation.chain import Chain, clock_of
from sklvalve.simulation.trim import GRID

EFFECTS = {effect.key: effect for effect in CATALOGUE}


def _bound(recording, *, choking=False, **options):
    tolerance = Tolerance()
    trim = choose_trim(recording, recording.valve, tolerance)
    chain = Chain(recording, recording.valve, trim, choking=choking, **options)
    parameters = [
        *opening_parameters(recording, recording.valve, tolerance),
        *flow_parameters(recording, recording.valve, tolerance, trim, choking=choking),
    ]
    return chain, {p.name: p.start for p in parameters}


def test_flow_without_choking_is_that_of_the_standard(recording):
    chain, values = _bound(recording)
    values |= {"meter_lag": 0.0, "meter_ahead": 1.0}
    density = fluid_from(name="water").density(recording["temperature"])
    kv = np.interp(recording["opening"], GRID, chain.trim.table(values))
    expected = liquid_flow(kv, recording["p1"], recording["p2"], density)
    np.testing.assert_allclose(chain.flow(values), expected, rtol=1e-9)


def test_choking_only_takes_flow_away(recording):
    free, values = _bound(recording)
    choked, more = _bound(recording, choking=True)
    freely, less = free.flow(values), choked.flow(more)
    assert np.all(less <= freely * (1.0 + 1e-9))
    assert np.max((freely - less) / np.max(freely)) > 0.001
    low = free.pressure_ratio < 0.3
    np.testing.assert_allclose(less[low], freely[low], rtol=0.01)


@pytest.mark.parametrize(
    ("key", "own", "signal"),
    [
        ("clogging", {"limit": 0.3}, "flow"),
        ("seat_leakage", {"leak_kv": 1.0}, "flow"),
        ("flow_meter_bias", {"bias": 1e-4}, "flow"),
        ("dead_time", {"delay": 10.0}, "opening"),
        ("positioner_deadband", {"half_width": 0.03}, "opening"),
        ("position_sensor_bias", {"bias": 0.03}, "flow"),
        ("position_sensor_bias", {"bias": 0.03}, "opening"),
    ],
)
def test_an_onset_leaves_the_rows_before_it(recording, key, own, signal):
    plain, values = _bound(recording)
    begin = len(recording) // 2
    onset = float(clock_of(recording)[begin])
    late, _ = _bound(recording, effects=[EFFECTS[key]], onsets={key: onset})
    with_effect = values | {f"{key}.{name}": value for name, value in own.items()}
    before, after = getattr(plain, signal)(values), getattr(late, signal)(with_effect)
    np.testing.assert_array_equal(after[:begin], before[:begin])
    assert np.abs(after - before)[begin:].max() > 1e-3 * span_of(before)


def test_effects_that_do_not_act_yet_change_nothing(recording):
    plain, values = _bound(recording)
    beyond = float(clock_of(recording)[-1]) + 1.0
    late, _ = _bound(recording, effects=[EFFECTS["clogging"]], onsets={"clogging": beyond})
    np.testing.assert_array_equal(late.flow(values | {"clogging.limit": 0.2}), plain.flow(values))


def test_sensor_error_is_taken_off_before_it_drives_the_flow(recording):
    key = "position_sensor_bias"
    chain, values = _bound(recording, effects=[EFFECTS[key]])
    values |= {f"{key}.bias": 0.04, "position_zero": 0.0}
    np.testing.assert_allclose(chain.drive(values), recording["opening"] - 0.04, atol=1e-12)
    # what the free run's sensor shows, less its error, is the stem
    np.testing.assert_allclose(chain.stem_of_free_run(values), chain.opening(values) - 0.04, atol=1e-12)


def test_memory_of_the_opening_is_true_to_its_values(recording):
    chain, values = _bound(recording)
    first = chain.opening(values).copy()
    slow = chain.opening(values | {"actuator_gain": 2.0})
    assert np.abs(slow - first).max() > 0.005
    np.testing.assert_array_equal(chain.opening(values), first)


class _Capacity(Effect):
    """A loss before the valve that goes with its capacity, as a user may write it."""

    key, stage = "loss_of_my_own", "pressures"
    parameters = (Quantity("loss", "1", 0.0, 0.1, (0.01,)),)

    def apply(self, value, p, chain):
        kv = chain.capacity_at(chain.plug) / chain.trim.rated
        return value | {"p1": value["p1"] - p["loss"] * kv**2 * (value["p1"] - value["p2"])}


@pytest.mark.parametrize("plug", [np.array([0, 1]), [0.2, 0.4], np.float32(0.3), np.zeros((2, 2))], ids=str)
def test_capacities_are_read_for_whatever_holds_numbers(recording, plug):
    chain, values = _bound(recording)
    chain.flow(values)
    expected = np.interp(plug, GRID, chain.trim.table(values))
    np.testing.assert_allclose(chain.capacity_at(plug), expected, rtol=1e-14)


@pytest.mark.parametrize("choking", [False, True])
@pytest.mark.parametrize("effect", [_Capacity(), *(EFFECTS[k] for k in ("seat_leakage", "choked_flow"))])
def test_what_drives_the_flow_is_true_to_its_values_at_hand(recording, choking, effect):
    """Whatever moves between two flows, the second is that of a chain that has seen no other."""
    key, middle = effect.key, float(clock_of(recording)[len(recording) // 2])
    chain, values = _bound(recording, choking=choking, effects=[effect])
    values |= {f"{key}.{q.name}": q.starts[0] for q in effect.quantities(chain)}
    others = [values | {name: 1.01 * value + 1e-4} for name, value in values.items()]
    for onset in (None, middle):
        onsets = {} if onset is None else {key: onset}
        same = chain.beside([effect], onsets)
        for moved in [values, *others, values]:
            fresh, _ = _bound(recording, choking=choking, effects=[effect], onsets=onsets)
            np.testing.assert_array_equal(same.flow(moved), fresh.flow(moved))
    stem = np.where(np.arange(len(recording)) < 7, np.nan, 0.9 * recording["opening"])
    np.testing.assert_array_equal(same.flow(values, stem), fresh.flow(values, stem))


def test_rows_in_which_an_effect_acts_are_those_of_its_own_times(recording):
    clock, key = clock_of(recording), "clogging"
    chain, _ = _bound(recording)
    for first in range(1, 100):
        late = chain.beside([EFFECTS[key]], {key: (clock[first], clock[2 * first])})
        assert np.flatnonzero(late.active(EFFECTS[key])).tolist() == list(range(first, 2 * first))


def test_clock_goes_on_from_file_to_file(recording, later):
    clock = clock_of(recording)
    assert clock_of(later)[0] == pytest.approx(clock[-1] + recording.sample_time)
    np.testing.assert_allclose(clock_of(recording.slice(100, 200)), clock[100:200])


def test_valve_that_its_spring_opens_runs_the_same_way(made, recording):
    """Seen from its other end, the stem still goes where the command sends it."""
    sheet = {**made.valve, "actuator": {**made.valve["actuator"], "fail": "open"}}
    other = Recording.from_frame(made.frame, Valve.from_dict(sheet))
    chain, values = _bound(other)
    assert np.sqrt(np.mean((chain.opening(values) - recording["opening"])[50:] ** 2)) < 0.03


def test_channels_and_their_errors(recording):
    assert channels_of(recording) == ("opening", "flow")
    only = {"time": recording.time, "command": recording["command"], "opening": recording["opening"]}
    assert channels_of(Recording.from_frame(only)) == ("opening",)
    bare = {"time": recording.time, "command": recording["command"], "p1": recording["p1"]}
    with pytest.raises(InputError, match="a diagnosis needs an opening beside the command"):
        channels_of(Recording.from_frame(bare))


def test_opening_needs_a_command(recording):
    roles = ("opening", "p1", "p2", "temperature", "flow")
    signals = {"time": recording.time} | {role: recording[role] for role in roles}
    chain = Chain(
        Recording.from_frame(signals), recording.valve, choose_trim(recording, recording.valve, Tolerance())
    )
    with pytest.raises(InputError, match="without a command"):
        chain.opening({})


def test_apparent_capacity_is_that_of_the_plain_equation(recording):
    kv = apparent_kv(recording)
    flow = liquid_flow(kv, recording["p1"], recording["p2"], 1000.0)
    known = np.isfinite(kv)
    assert known.mean() > 0.9
    np.testing.assert_allclose(flow[known], recording["flow"][known], rtol=1e-9, atol=1e-12)


def test_no_flow_at_all_gives_no_capacity(recording):
    signals = {role: recording[role] for role in ("command", "p1", "p2")} | {"time": recording.time}
    dry = Recording.from_frame(signals | {"flow": np.zeros(len(recording))})
    with pytest.raises(InputError, match="no row has flow and pressure drop both above zero"):
        choose_trim(dry, Valve(), Tolerance())


def test_a_flow_follows_the_stem_through_the_play_of_a_sound_valve(recording):
    chain, values = _bound(recording)
    tight, loose = chain.flow(values), chain.flow(values | {"plug_play": 0.02, "plug_overshoot": 0.0})
    assert np.ptp(chain.measured) > 0.1
    moved = np.abs(loose - tight)
    assert moved.max() > 0.001 * np.ptp(tight)
    np.testing.assert_array_equal(chain.flow(values | {"plug_play": 0.0, "plug_overshoot": 0.0}), tight)


def test_a_stem_follows_its_actuator_through_the_play_of_a_sound_linkage(recording):
    chain, values = _bound(recording)
    tight, loose = chain.opening(values), chain.opening(values | {"link_play": 0.02})
    assert np.abs(loose - tight).max() == pytest.approx(0.01, abs=1e-3)
