# SPDX-License-Identifier: BSD-3-Clause
"""One step of the stem, piece by piece: positioner, chamber and friction."""

import numpy as np
import pytest

from sklvalve.simulation import stem_state, stem_step

SPRING, AIR, SUPPLY = 1.516, 1.267, 5.5
OWN = stem_state.actuator(SPRING, AIR, 0.1, 10.0, 0.3, 0.0, 1.0, 0.0)
SOUND = stem_state.sound((SUPPLY, 0.01, 0.0, 0.0), SPRING, 1.0)


def _rest(opening, own=OWN):
    return stem_state.at_rest(opening, opening, own)


def _after(opening, target, seconds, drive=SOUND, own=OWN):
    state, pace = _rest(opening, own)
    for _ in range(seconds):
        state, pace = stem_step.after_a_sample(state, pace, target, 1.0, drive, own)
    return state


def test_a_stem_at_rest_that_is_sent_nowhere_stays():
    state = _after(0.4, 0.4, 50)
    assert state.x == pytest.approx(0.4, abs=1e-9)
    assert state.mass == pytest.approx(_rest(0.4)[0].mass, abs=1e-6)


@pytest.mark.parametrize("target", [0.1, 0.35, 0.8, 1.0])
def test_a_sound_stem_ends_where_it_is_sent(target):
    assert _after(0.5, target, 200).x == pytest.approx(target, abs=1e-3)


def test_within_its_dead_band_a_positioner_leaves_the_air_as_it_is():
    wide = SOUND._replace(band=0.05)
    assert _after(0.5, 0.54, 100, wide).x == pytest.approx(0.5, abs=1e-9)
    assert _after(0.5, 0.60, 100, wide).x == pytest.approx(0.55, abs=3e-3)


def test_a_chamber_holds_air_for_the_pressure_that_carries_the_spring():
    for x in (0.0, 0.3, 1.0):
        chamber = stem_step._chamber.py_func(_rest(x)[0], SOUND, OWN)
        assert chamber.pressure == pytest.approx(SPRING + x)
        # a small way takes from the pressure what the larger volume does
        state = _rest(x)[0]
        less = stem_step._chamber.py_func(state._replace(x=x + 1e-6), SOUND, OWN).pressure
        assert (chamber.pressure - less) / 1e-6 == pytest.approx(chamber.stiffness, rel=1e-4)


def test_bristles_give_until_friction_is_used_up():
    held, stiff, tight = 0.01, 6000.0, 1.3
    for push in (0.002, 0.0099, 0.02, 0.5):
        d, fade = stem_step._displacement(push, tight, held, stiff)
        assert tight * d + held * (1.0 - np.exp(-stiff * d)) == pytest.approx(push, rel=0.02)
        assert fade == pytest.approx(np.exp(-stiff * d), abs=5e-3)


def test_extra_friction_at_rest_falls_with_speed():
    sticks = SOUND._replace(stick=0.05)
    state, _ = _rest(0.5)
    at_rest, moving, fast = (stem_step._friction(state, v, sticks)[1] for v in (0.0, 0.03, 1.0))
    assert at_rest == pytest.approx(0.06)
    assert moving == pytest.approx(0.01 + 0.05 * np.exp(-1.0))
    assert fast == pytest.approx(0.01)


def test_a_bent_rod_rubs_beyond_where_it_begins():
    bent = SOUND._replace(rod=0.2, rod_from=0.6)
    assert stem_step._friction(_rest(0.5)[0], 0.0, bent)[0] == pytest.approx(0.01)
    assert stem_step._friction(_rest(0.8)[0], 0.0, bent)[0] == pytest.approx(0.05)


def test_bristles_never_bend_back_however_the_search_for_the_way_ends():
    rng = np.random.default_rng(0)
    for push, tight, held, stiff in 10.0 ** rng.uniform([-6, 0, -5, 1], [1, 2, 0, 6], (20_000, 4)):
        d, fade = stem_step._displacement(push, tight, held, stiff)
        assert d >= 0.0
        assert 0.0 <= fade <= 1.0 + 1e-9


def test_a_stem_does_not_leave_its_travel():
    assert stem_step._within_travel(1.15, 0.2, 0.1, SOUND) == pytest.approx((1.0, 0.05, 0.0))
    assert stem_step._within_travel(-0.15, 0.2, 0.1, SOUND) == pytest.approx((0.0, 0.05, 0.0))
    assert stem_step._within_travel(0.3, 0.2, 0.1, SOUND) == pytest.approx((0.3, 0.2, 0.1))


@pytest.mark.parametrize(("before", "after"), [(0.1, 0.3), (0.9, 0.8)])
def test_a_stop_takes_along_a_stem_that_stands_beyond_it_and_shuts_in_its_air(before, after):
    quick = stem_state.actuator(SPRING, AIR, 3.0, 25.0, 0.3, 0.0, 1.0, 0.0)
    narrow = SOUND._replace(low=0.3, high=0.8, capacity=9.6)
    state, pace = _rest(before, quick)
    moved = stem_step._at_the_stop(state, narrow)
    assert moved.x == after
    assert moved.mass == state.mass
    for _ in range(30):
        state, pace = stem_step.after_a_sample(state, pace, before, 1.0, narrow, quick)
        pressure = state.mass / (stem_state.DEAD_VOLUME + state.x)
        assert AIR - 0.1 < pressure < SUPPLY + 0.1
    assert state.x == pytest.approx(after, abs=1e-9)


def test_faults_change_what_they_say():
    zeros = [0.0] * 12
    same = stem_state.faulty((SUPPLY, 0.01, 0.0, 0.0), tuple(zeros), SPRING, 1.0)
    assert tuple(same) == pytest.approx(tuple(SOUND))
    for place, name, value in (
        (3, "leak", 0.2),
        (7, "play", 0.02),
        (8, "bristle", 20.0),
        (9, "capacity", 1.5),
        (10, "low", 0.2),
        (11, "high", 0.7),
    ):
        wrong = list(zeros)
        wrong[place] = {"play": 0.04, "capacity": 0.5, "high": 0.3}.get(name, value)
        drive = stem_state.faulty((SUPPLY, 0.01, 0.0, 0.0), tuple(wrong), SPRING, 1.0)
        changed = {k for k, v in drive._asdict().items() if v != pytest.approx(SOUND._asdict()[k])}
        assert changed == {name}
        assert getattr(drive, name) == pytest.approx(value)
