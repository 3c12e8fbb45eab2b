# SPDX-License-Identifier: BSD-3-Clause
"""What the positioner is told, what does not move at all, and where effects of the actuator make sense."""

import numpy as np
import pytest

from sklvalve.simulation import Tolerance

from .hand_actuator import EFFECTS, VALUES, WEAK_AIR, chain_of, run

# ---- what the positioner is told


@pytest.mark.parametrize(("gain", "bias"), [(0.1, 0.0), (-0.2, 0.05), (0.0, -0.1)])
def test_stem_goes_where_the_transducer_tells_it(gain, bias):
    command = np.repeat([0.2, 0.5, 0.35], 60)
    stem = run(chain_of(command, "transducer_fault"), gain=gain, bias=bias)
    np.testing.assert_allclose(stem[59::60], (1.0 + gain) * command[59::60] + bias, atol=3e-3)


@pytest.mark.parametrize(("gain", "bias"), [(0.1, 0.0), (-0.2, 0.05), (0.0, -0.1)])
def test_stem_goes_where_the_wrong_feedback_agrees_with_the_command(gain, bias):
    command = np.repeat([0.2, 0.4, 0.3], 60)
    stem = run(chain_of(command, "positioner_feedback_fault"), gain=gain, bias=bias)
    np.testing.assert_allclose((1.0 + gain) * stem[59::60] + bias, command[59::60], atol=4e-3)


def test_transducer_and_feedback_of_the_same_error_cancel():
    told, p = np.linspace(0.0, 1.0, 5), {"gain": -0.2, "bias": 0.05}
    wrong = EFFECTS["transducer_fault"].apply(told, p, None)
    np.testing.assert_allclose(EFFECTS["positioner_feedback_fault"].apply(wrong, p, None), told, atol=1e-12)
    assert EFFECTS["transducer_fault"].family == EFFECTS["positioner_feedback_fault"].family != ""


def test_play_of_the_feedback_takes_the_stem_too_far_each_way():
    width = 0.06
    command = np.r_[np.full(30, 0.1), np.linspace(0.1, 0.5, 400), np.linspace(0.5, 0.1, 400)]
    strong = WEAK_AIR | {"supply_pressure": 340.0}
    plain = chain_of(command, actuator=strong).stem_of_free_run(VALUES)
    loose = run(chain_of(command, "positioner_feedback_play", actuator=strong), width=width)
    gone = loose - plain
    np.testing.assert_allclose(gone[250:430], 0.5 * width, atol=2e-3)
    np.testing.assert_allclose(gone[600:], -0.5 * width, atol=2e-3)


@pytest.mark.parametrize("rangeability", [20.0, 1.5, 0.1])
def test_characteriser_is_an_equal_percentage_curve_through_both_ends(rangeability):
    effect = EFFECTS["positioner_characteriser"]
    u = np.linspace(0.0, 1.0, 11)
    bent = effect.apply(u, {"curvature": np.log(rangeability)}, None)
    np.testing.assert_allclose(bent, (rangeability**u - 1.0) / (rangeability - 1.0), atol=1e-12)
    assert np.all(np.diff(bent) > 0.0)


def test_characteriser_passes_smoothly_through_a_straight_line():
    effect = EFFECTS["positioner_characteriser"]
    u = np.linspace(0.0, 1.0, 11)
    bent = [effect.apply(u, {"curvature": s}, None) - u for s in (-2e-5, -1e-6, 1e-6, 2e-5)]
    for s, off in zip((-2e-5, -1e-6, 1e-6, 2e-5), bent, strict=True):
        np.testing.assert_allclose(off, 0.5 * s * u * (u - 1.0), atol=1e-10)


def test_cut_off_shuts_below_and_leaves_above():
    u = np.array([0.0, 0.01, 0.047, 0.05, 0.3, 1.0, np.nan])
    shut = EFFECTS["tight_shutoff"].apply(u, {"cut_off": 0.05}, None)
    np.testing.assert_allclose(shut, [0.0, 0.0, 0.0, 0.05, 0.3, 1.0, np.nan], atol=1e-12)
    opened = EFFECTS["tight_shutoff_open"].apply(1.0 - u, {"cut_off": 0.05}, None)
    np.testing.assert_allclose(opened, 1.0 - shut, atol=1e-12)


def test_cut_off_begins_where_the_stem_is_seen_to_stand():
    command = np.r_[np.linspace(0.0, 0.3, 300), np.full(50, 0.6)]
    shown = np.where(command < 0.08, 0.0, command)
    (cut_off,) = EFFECTS["tight_shutoff"].quantities(chain_of(command, opening=shown))
    assert cut_off.starts[0] == pytest.approx(0.08, abs=0.003)


# ---- stuck


def test_stuck_stem_holds_from_its_onset_on():
    command = np.r_[np.full(50, 0.2), np.full(50, 0.5)]
    sound = chain_of(command).stem_of_free_run(VALUES)
    stem = run(chain_of(command, "stuck_valve", onsets={"stuck_valve": 60.0}), opening=0.31)
    np.testing.assert_array_equal(stem[:60], sound[:60])
    np.testing.assert_array_equal(stem[60:], 0.31)


def test_stuck_stem_is_looked_for_where_it_stands_last():
    shown = np.r_[np.linspace(0.1, 0.7, 80), np.full(40, 0.64)]
    (opening,) = EFFECTS["stuck_valve"].quantities(chain_of(np.linspace(0.1, 0.9, 120), opening=shown))
    assert opening.starts[0] == pytest.approx(0.64)


def test_nothing_is_stuck_whose_command_stays():
    assert not EFFECTS["stuck_valve"].possible(chain_of(np.full(50, 0.4)))
    assert EFFECTS["stuck_valve"].possible(chain_of(np.linspace(0.4, 0.5, 50)))


# ---- where they make sense, and from which size on


@pytest.mark.parametrize("key", ["spring_fault", "actuator_leak", "actuator_leak_diaphragm", "stem_load"])
def test_forces_need_an_actuator_of_known_air_or_spring(key):
    drop = np.linspace(1e5, 3e5, 50)
    known = chain_of(np.linspace(0.1, 0.9, 50), dp=drop)
    unknown = chain_of(np.linspace(0.1, 0.9, 50), actuator={"fail": "closed"}, dp=drop)
    assert EFFECTS[key].possible(known)
    assert not EFFECTS[key].possible(unknown)


def test_load_needs_a_drop_that_varies_and_lag_an_actuator_of_air():
    assert not EFFECTS["stem_load"].possible(chain_of(np.linspace(0.1, 0.9, 50)))
    electric = chain_of(np.linspace(0.1, 0.9, 50), actuator={})
    assert electric.electric
    assert not EFFECTS["actuator_lag"].possible(electric)


@pytest.mark.parametrize(
    ("key", "within", "beyond"),
    [
        ("friction", {"friction": 0.024}, {"friction": 0.026}),
        ("presliding", {"friction": 0.024, "reach": 0.1}, {"friction": 0.05, "reach": 0.1}),
        ("rod_bend", {"friction": 0.02, "begins": 0.5}, {"friction": 0.1, "begins": 0.5}),
        ("actuator_lag", {"time_constant": 2.9}, {"time_constant": 3.1}),
        ("transducer_fault", {"gain": 0.005, "bias": 0.004}, {"gain": 0.005, "bias": 0.006}),
        ("positioner_feedback_fault", {"gain": -0.002, "bias": 0.009}, {"gain": 0.0, "bias": -0.02}),
        ("positioner_feedback_play", {"width": 0.009}, {"width": 0.011}),
        ("positioner_characteriser", {"curvature": 0.07}, {"curvature": -0.09}),
        ("tight_shutoff", {"cut_off": 0.009}, {"cut_off": 0.011}),
        # 340 kPa are 4.25 travels of 80 kPa: the spring asks for 0.25 + 1 of them
        ("spring_fault", {"strength": 2.5, "hardening": 0.0}, {"strength": 3.4, "hardening": 0.0}),
        ("spring_fault", {"strength": 0.2, "hardening": 0.0}, {"strength": 0.08, "hardening": 0.0}),
        ("actuator_leak", {"leak": 0.1}, {"leak": 0.2}),
        ("actuator_leak_diaphragm", {"leak": 0.1, "lost_area": 0.65}, {"leak": 0.1, "lost_area": 0.72}),
    ],
)
def test_tolerance_of_a_data_sheet(key, within, beyond):
    chain = chain_of(np.linspace(0.1, 0.9, 50), actuator=WEAK_AIR | {"supply_pressure": 340.0})
    assert not EFFECTS[key].beyond_tolerance(within, chain, Tolerance(), False)
    assert EFFECTS[key].beyond_tolerance(beyond, chain, Tolerance(), False)


def test_what_begins_in_a_record_is_no_calibration():
    chain = chain_of(np.linspace(0.1, 0.9, 50))
    for key in ("transducer_fault", "positioner_feedback_fault"):
        assert EFFECTS[key].beyond_tolerance({"gain": 0.0, "bias": 0.004}, chain, Tolerance(), True)
