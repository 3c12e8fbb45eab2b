# SPDX-License-Identifier: BSD-3-Clause
"""Each of the nineteen faults: what it changes, which way, and what it must not change at all."""

import numpy as np
import pytest

from sklvalve.damadics import FAULTS, ActuatorSimulator, Profile

QUIET = ActuatorSimulator(noise=False)
SIGNALS = ("CV", "P1", "P2", "T1", "X", "F")
BEGINS, LASTS = 300.0, 600.0
#: Below which a change is hidden by the noise, rms, share of the span.
INVISIBLE = 2e-3
MORE, LESS, EITHER = 1.0, -1.0, 0.0
# what changes, and which way in the mean where the equations say; X is towards closed
CHANGES = [
    ("f1", 0.75, {"X": LESS, "F": MORE}),
    ("f2", 0.75, {"X": EITHER, "F": LESS}),
    ("f3", 0.75, {"X": EITHER, "F": MORE}),
    ("f4", 0.75, {"X": EITHER, "F": EITHER}),
    ("f5", 0.75, {"F": LESS}),
    ("f6", 0.75, {"F": MORE}),
    ("f7", 0.75, {"T1": MORE, "X": LESS, "F": MORE}),
    ("f9", 0.75, {"X": LESS, "F": MORE}),
    ("f10", 0.75, {"X": LESS, "F": MORE}),
    ("f11", 0.75, {"X": MORE, "F": LESS}),
    ("f12", -0.75, {"X": EITHER, "F": EITHER}),
    ("f12", 0.75, {"X": EITHER, "F": EITHER}),
    ("f13", 0.75, {"X": EITHER, "F": MORE}),
    ("f13", -0.75, {"X": LESS, "F": LESS}),
    ("f14", -0.75, {}),
    ("f14", 0.75, {}),
    ("f15", 0.75, {"X": EITHER, "F": EITHER}),
    ("f16", 0.75, {"X": LESS, "F": MORE}),
    ("f17", 0.75, {"P2": LESS, "X": EITHER, "F": MORE}),
    ("f17", -0.75, {"P1": LESS, "X": MORE, "F": LESS}),
    ("f18", 0.75, {"F": MORE}),
    ("f19", -0.75, {"F": MORE}),
    ("f19", 0.75, {"F": LESS}),
]


@pytest.fixture(scope="module")
def sound():
    return QUIET.simulate(LASTS)


def run_with(fault, strength):
    return QUIET.simulate(LASTS, faults=[Profile(fault, strength, BEGINS)])


def require_same(run, sound, signals, rows):
    for signal in signals:
        np.testing.assert_array_equal(run[signal][rows], sound[signal][rows], err_msg=signal)


def test_every_fault_is_here():
    # f8 has a test of its own
    assert {fault for fault, _, _ in CHANGES} | {"f8"} == FAULTS.keys()


@pytest.mark.parametrize(("fault", "strength", "changes"), CHANGES)
def test_a_fault_changes_what_it_should_and_nothing_else(sound, fault, strength, changes):
    run = run_with(fault, strength)
    later = run["t"] >= BEGINS
    np.testing.assert_array_equal(run[fault], np.where(later, strength, 0.0))
    require_same(run, sound, (*SIGNALS, "x", "F_tph", "Ps"), ~later)
    require_same(run, sound, [signal for signal in SIGNALS if signal not in changes], later)
    for signal, way in changes.items():
        change = (run[signal] - sound[signal])[later]
        assert np.sqrt(np.mean(change**2)) > INVISIBLE, signal
        if way != EITHER:
            assert np.sign(change.mean()) == way, signal


def test_f8_changes_stem_and_flow_by_less_than_the_noise(sound):
    run = run_with("f8", 0.75)
    later = run["t"] >= BEGINS
    require_same(run, sound, SIGNALS, ~later)
    require_same(run, sound, ("CV", "P1", "P2", "T1"), later)
    for signal in ("X", "F"):
        change = (run[signal] - sound[signal])[later]
        assert 0.0 < np.sqrt(np.mean(change**2)) < INVISIBLE


@pytest.mark.parametrize("fault", ["f5", "f6", "f18", "f19", "f14"])
def test_faults_of_the_flow_and_of_what_is_shown_leave_the_actuator_alone(sound, fault):
    run = run_with(fault, FAULTS[fault].direction * 0.5)
    require_same(run, sound, ("x", "Ps", "CVI", "Fvc"), slice(None))


def test_an_actuators_fault_leaves_the_law_of_the_valve_alone(sound):
    """Where the stem stands as in a sound run, so does the flow."""
    run = run_with("f16", 0.75)
    later = run["t"] >= BEGINS
    same = later & (np.abs(run["x"] - sound["x"]) < 1e-12)
    np.testing.assert_allclose(run["F_tph"][same], sound["F_tph"][same], rtol=1e-9)
    # an opening stem needs no air
    assert later.sum() > same.sum() > 0


def test_what_the_equations_give_as_a_number(sound):
    later = sound["t"] >= BEGINS
    for fault, strength, signal, known in (
        ("f5", 0.75, "F_tph", (1.0 - 0.05 * 0.75) * sound["F_tph"]),
        ("f7", 0.75, "T1", np.ones(len(later))),
        ("f17", 0.75, "P2", 0.25 * sound["P2"]),
        ("f17", -0.75, "P1", 0.25 * sound["P1"]),
        # before the range of the meter ends
        ("f19", -0.75, "F", np.minimum(1.75 * sound["F_tph"] / 40.0, 1.0)),
        ("f19", 0.75, "F", np.minimum(0.25 * sound["F_tph"] / 40.0, 1.0)),
        # kv of the valve 120, so that a tenth of it is added
        ("f6", 1.0, "F_tph", sound["F_tph"] * (1.0 + 0.1 * np.exp(5.0 * sound["x"] / 0.0381))),
    ):
        np.testing.assert_allclose(run_with(fault, strength)[signal][later], known[later], rtol=1e-12)


def test_clogging_and_sedimentation_end_the_travel():
    def shut(t):
        return {"CV": 1.0, "P1": 3.5e6, "P2": 2.6e6, "T1": 43.0}

    for fault, strength, stop in (("f1", 0.75, 0.25), ("f2", 1.0, 0.8)):
        run = QUIET.simulate(200.0, shut, [Profile(fault, strength)])
        assert run["x"].max() / 0.0381 == pytest.approx(stop, abs=1e-12), fault


def test_the_supply_is_lost_below_120_kilopascals_and_not_at_them():
    # a stem that moves needs air: without it the spring opens the valve
    lost, kept = (run_with("f16", strength)["X"][-100:] for strength in (0.81, 0.8))
    assert lost.max() < 0.05
    assert kept.max() > 0.3


@pytest.mark.parametrize(("sign", "factor"), [("library", 1.75), ("help", 0.25)])
def test_shown_pressures_stay_within_their_span(sound, sign, factor):
    simulator = ActuatorSimulator(noise=False, sign=sign, pressure_span=3e5)
    run = simulator.simulate(LASTS, faults=[Profile("f14", -0.75, BEGINS)])
    later = run["t"] >= BEGINS
    known = np.clip(factor * sound["Ps"] / 3e5, 0.0, 1.0)
    np.testing.assert_allclose(run["Ps_shown"][later], known[later], rtol=1e-12)
    assert (known[later].max() == 1.0) == (sign == "library")
    # the supply of 600 kPa is beyond a span of 300
    assert (run["Pz_shown"] == 1.0).all()
