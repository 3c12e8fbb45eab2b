# SPDX-License-Identifier: BSD-3-Clause
"""Effects of the actuator against force balances and other computations by hand."""

import numpy as np
import pytest
from scipy.optimize import brentq

from sklvalve.simulation import Tolerance

from .hand_actuator import AIR, EFFECTS, PRELOAD, REACH, SUPPLY, VALUES, WEAK_AIR, chain_of, run


def highest(key, *, actuator=WEAK_AIR, **own):
    """Where all the air carries the stem from below."""
    return run(chain_of(np.r_[np.full(20, 0.02), np.ones(400)], key, actuator=actuator), **own)[-1]


# ---- force balances at the end of an air-driven travel


def test_a_sound_stem_ends_where_the_spring_balances_the_air():
    chain = chain_of(np.r_[np.full(20, 0.02), np.ones(400)])
    assert chain.stem_of_free_run(VALUES)[-1] == pytest.approx(REACH, abs=1e-3)


@pytest.mark.parametrize(
    ("drop", "late", "beyond"), [(0.68, False, False), (0.71, False, True), (0.2, True, True)]
)
def test_a_supply_may_be_low_from_the_start_and_carry_the_travel_but_not_fall(drop, late, beyond):
    # 340 kPa carry a spring of 20 to 100 kPa over 1.05 travels as long as 104 kPa are left
    chain = chain_of(np.full(20, 0.5), "supply_pressure_drop", actuator=WEAK_AIR | {"supply_pressure": 340.0})
    effect = EFFECTS["supply_pressure_drop"]
    assert effect.beyond_tolerance({"drop": drop}, chain, Tolerance(), late) is beyond


@pytest.mark.parametrize("friction", [0.05, 0.2, 0.4])
def test_friction_takes_its_force_from_the_air(friction):
    assert highest("friction", friction=friction) == pytest.approx(REACH - friction, abs=2e-3)


def test_friction_below_that_of_the_calibrated_stem_changes_nothing():
    chain = chain_of(np.r_[np.full(20, 0.02), np.ones(100)], "friction")
    np.testing.assert_array_equal(run(chain, friction=1e-5), run(chain, friction=0.0))


def test_friction_delays_a_reversal_and_does_not_jump():
    # a positioner without integral follows a slow ramp by the error that moves its air
    command = np.r_[np.linspace(0.1, 0.5, 400), np.linspace(0.5, 0.1, 400)]
    strong = WEAK_AIR | {"supply_pressure": 340.0}
    plain = chain_of(command, actuator=strong).stem_of_free_run(VALUES)
    rubbing = run(chain_of(command, "friction", actuator=strong), friction=0.3)
    stands = np.flatnonzero(np.diff(rubbing[400:]) < -5e-4)[0]
    assert stands > np.flatnonzero(np.diff(plain[400:]) < -5e-4)[0] + 1
    assert np.abs(np.diff(rubbing)).max() < 5e-3


@pytest.mark.parametrize(("friction", "reach"), [(0.2, 0.02), (0.2, 0.15), (0.4, 0.2)])
def test_soft_packing_holds_what_its_bristles_have_built_up(friction, reach):
    start = 0.02
    expected = brentq(lambda x: x + friction * (1.0 - np.exp(-(x - start) / reach)) - REACH, start, 1.0)
    assert highest("presliding", friction=friction, reach=reach) == pytest.approx(expected, abs=2e-3)


def test_soft_packing_of_no_reach_is_friction():
    soft = highest("presliding", friction=0.2, reach=0.002)
    assert soft == pytest.approx(highest("friction", friction=0.2), abs=2e-3)


@pytest.mark.parametrize(("strength", "hardening"), [(0.8, 0.0), (1.5, 0.0), (1.0, 0.8), (1.3, 0.5)])
def test_spring_balances_the_air_where_its_force_says(strength, hardening):
    expected = brentq(lambda x: strength * (PRELOAD + x) + hardening * x**3 - (SUPPLY - AIR), 0.0, 2.0)
    found = highest("spring_fault", strength=strength, hardening=hardening)
    assert found == pytest.approx(min(expected, 1.0), abs=2e-3)


def _nozzle(ratio):
    return 1.0 if ratio <= 0.3 else np.sqrt(max(1.0 - ((ratio - 0.3) / 0.7) ** 2, 0.0))


@pytest.mark.parametrize("leak", [0.1, 0.3, 0.6])
def test_leak_leaves_the_pressure_at_which_as_much_comes_as_goes(leak):
    def gained(p):
        return SUPPLY * _nozzle(p / SUPPLY) - leak * p * _nozzle(AIR / p)

    expected = brentq(gained, AIR + 1e-6, SUPPLY) - AIR - PRELOAD
    assert highest("actuator_leak", leak=leak) == pytest.approx(max(expected, 0.0), abs=3e-3)


def test_leak_slows_filling_and_speeds_venting():
    command = np.r_[np.full(20, 0.1), np.full(60, 0.45), np.full(60, 0.1)]
    strong = WEAK_AIR | {"supply_pressure": 200.0}
    slow = VALUES | {"actuator_rate": 0.1}
    sound = chain_of(command, actuator=strong).stem_of_free_run(slow)
    leaky = chain_of(command, "actuator_leak", actuator=strong)
    leaky = leaky.stem_of_free_run(slow | {"actuator_leak.leak": 0.5})

    def crossed(stem, level, since):
        return np.flatnonzero((stem[since:] > level) != (stem[since] > level))[0]

    assert crossed(leaky, 0.3, 20) > crossed(sound, 0.3, 20)
    assert crossed(leaky, 0.3, 80) < crossed(sound, 0.3, 80)


@pytest.mark.parametrize("lost", [0.1, 0.25])
def test_torn_diaphragm_carries_with_the_rest_of_its_area(lost):
    expected = (1.0 - lost) * (SUPPLY - AIR) - PRELOAD
    found = highest("actuator_leak_diaphragm", leak=1e-6, lost_area=lost)
    assert found == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize(("friction", "begins"), [(0.3, 0.2), (1.0, 0.4)])
def test_bent_stem_rubs_beyond_where_it_is_bent(friction, begins):
    expected = brentq(lambda x: x + friction * max(0.0, (x - begins) / (1.0 - begins)) - REACH, 0.0, 1.0)
    # the bristles bend over a thousandth of travel or two before they bear what friction has grown to
    assert highest("rod_bend", friction=friction, begins=begins) == pytest.approx(expected, abs=4e-3)


def test_bent_stem_is_the_same_seen_from_the_other_end():
    # a valve that air closes, bent towards the seat, is one that air opens, bent towards open
    command = np.r_[np.full(20, 0.98), np.zeros(400)]
    closing = chain_of(command, "rod_bend_shut", actuator=WEAK_AIR | {"fail": "open"})
    found = run(closing, friction=0.5, begins=0.7)
    opening = run(chain_of(1.0 - command, "rod_bend"), friction=0.5, begins=0.3)
    np.testing.assert_allclose(found, 1.0 - opening, atol=1e-12)


@pytest.mark.parametrize("load", [-0.2, 0.3])
def test_load_of_the_fluid_shifts_the_end_of_travel(load):
    assert highest("stem_load", load=load) == pytest.approx(REACH - load, abs=2e-3)
    # half the drop, half the load
    command, drop = np.r_[np.full(20, 0.02), np.ones(400)], np.r_[np.full(320, 1e5), np.full(100, 2e5)]
    stem = run(chain_of(command, "stem_load", dp=drop), load=load)
    assert stem[310] == pytest.approx(REACH - 0.5 * load, abs=2e-3)


# ---- speed


@pytest.mark.parametrize("key", ["actuator_lag_air", "transducer_fault_output"])
def test_throttled_air_makes_a_stroke_longer_in_proportion(key):
    command = np.r_[np.full(20, 0.02), np.ones(400)]
    slow = VALUES | {"actuator_rate": 0.04}
    sound = chain_of(command).stem_of_free_run(slow)[19:]
    half = chain_of(command, key).stem_of_free_run(slow | {f"{key}.share": 0.5})[19:]
    np.testing.assert_allclose(half[::2][:150], sound[:150], atol=3e-3)


def test_lag_makes_the_same_share_of_every_step():
    effect = EFFECTS["actuator_lag"]
    command = np.r_[np.zeros(5), np.full(60, 0.8)]
    chain = chain_of(command)
    after = effect.apply(command, {"time_constant": 8.0}, chain)[5:]
    np.testing.assert_allclose(after, 0.8 * (1.0 - np.exp(-(1.0 + np.arange(60)) / 8.0)), atol=1e-12)
    np.testing.assert_allclose(
        effect.apply(0.1 * command, {"time_constant": 8.0}, chain)[5:], 0.1 * after, atol=1e-12
    )


@pytest.mark.parametrize("fail", ["closed", "open"])
def test_a_stem_leaves_what_blocks_it_when_its_chamber_is_filled_again(fail):
    command = np.r_[np.full(20, 0.6), np.full(60, 0.05), np.full(60, 0.6)]
    strong = WEAK_AIR | {"supply_pressure": 340.0, "fail": fail}
    slow = VALUES | {"actuator_rate": 0.1}
    sound = chain_of(command, actuator=strong).stem_of_free_run(slow)
    blocked = chain_of(command, "clogging_closing", actuator=strong)
    blocked = blocked.stem_of_free_run(slow | {"clogging_closing.limit": 0.3})
    assert blocked[79] == pytest.approx(0.3, abs=1e-6)
    assert blocked.min() == pytest.approx(0.3, abs=1e-6)
    # a sound stem has further to go, and is back sooner than one whose chamber is empty
    back = [80 + np.flatnonzero(stem[80:] > 0.4)[0] for stem in (sound, blocked)]
    assert back[1] > back[0]


def test_every_limit_of_what_blocks_a_valve_has_a_run_of_its_own():
    command = np.r_[np.full(20, 0.6), np.full(60, 0.05)]
    chain = chain_of(command, "clogging_closing", actuator=WEAK_AIR | {"supply_pressure": 340.0})
    lowest = [run(chain, limit=limit).min() for limit in (0.3, 0.2, 0.3)]
    assert lowest == pytest.approx([0.3, 0.2, 0.3], abs=1e-6)
    later = chain.beside(chain.effects, {"clogging_closing": 50.0})
    stem = run(later, limit=0.3)
    assert stem[49] < 0.1
    assert stem[-1] == pytest.approx(0.3, abs=1e-6)


def test_the_play_behind_an_actuator_lets_it_go_on_where_the_plug_is_blocked():
    command = np.r_[np.full(20, 0.6), np.full(60, 0.05)]
    chain = chain_of(command, "clogging_closing", actuator=WEAK_AIR | {"supply_pressure": 340.0})
    for play in (0.0, 0.04):
        values = VALUES | {"clogging_closing.limit": 0.3, "link_play": play}
        assert chain.lowest(values) == pytest.approx(0.3 - 0.5 * play)
        assert chain.stem_of_free_run(values).min() == pytest.approx(0.3, abs=1e-6)
