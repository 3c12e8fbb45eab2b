# SPDX-License-Identifier: BSD-3-Clause
"""The plant of the benchmark: physics at rest, friction, effects one by one, and that it stands alone."""

import ast
from pathlib import Path

import numpy as np
import pytest

from benchmarks.concealed.plant import EFFECTS, Course, Plant, loop, sensors
from benchmarks.concealed.plant.columns import COLUMNS
from benchmarks.concealed.plant.fluids import water_density, water_vapour
from benchmarks.concealed.plant.loop import least_of, nozzle
from benchmarks.concealed.plant.march import A_SECOND, METER, P1_READ, P2_READ, PLUG, STEM_READ
from benchmarks.concealed.plant.noise import KINDS, Law, whiten_opening
from benchmarks.concealed.plant.rig import WARM_UP

CONCEALED = Path(__file__).parents[2] / "benchmarks" / "concealed"
ROWS = 600


@pytest.fixture(scope="module")
def plant():
    return Plant(4, "wide", ROWS, 60)


@pytest.fixture(scope="module")
def sound(plant):
    return plant.run(plant.schedule({}, Course()))


def test_no_code_of_what_is_tested_is_imported():
    files = [*CONCEALED.glob("plant/**/*.py"), *CONCEALED.glob("distances/*.py"), CONCEALED / "record.py"]
    files += [CONCEALED / "histories" / f"{name}.py" for name in ("kinds", "changes", "hour")]
    assert len(files) > 15
    for file in files:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [a.name for a in node.names] if isinstance(node, ast.Import) else []
            assert not any(name.startswith("sklvalve") for name in names), file


@pytest.mark.parametrize(("celsius", "density", "vapour"), [(20.0, 998.2, 2339.0), (80.0, 971.8, 47414.0)])
def test_water(celsius, density, vapour):
    # steam tables
    assert water_density(celsius) == pytest.approx(density, rel=3e-4)
    assert water_vapour(celsius) == pytest.approx(vapour, rel=6e-3)


def test_hot_water():
    assert water_density(140.0) == pytest.approx(926.1, rel=3e-3)
    assert water_vapour(140.0) == pytest.approx(361.5e3, rel=1e-2)


def test_air_chokes_and_turns_round():
    assert nozzle(1e-8, 5e5, 1e5) == nozzle(1e-8, 5e5, 1.5e5)  # choked
    assert nozzle(1e-8, 5e5, 3e5) == -nozzle(1e-8, 3e5, 5e5)
    assert nozzle(1e-8, 2e5, 2e5) == 0.0


def test_the_lesser_of_drop_and_limit_is_rounded():
    assert least_of(1e4, 1e6, 20.0) == pytest.approx(1e4, rel=1e-3)
    assert least_of(9e6, 1e6, 20.0) == pytest.approx(1e6, rel=1e-6)
    assert 0.9e6 < least_of(1e6, 1e6, 20.0) < 1e6


def test_flow_at_rest_is_that_of_the_sizing_equation():
    plant = Plant(4, "wide", ROWS, 60)
    plant.weather[:, 1] = 6.2e5  # a small drop
    out = plant.run(plant.schedule({}, Course()))[WARM_UP * A_SECOND :]
    p1, drop = 1e-5 * out[:, P1_READ], 1e-5 * (out[:, P1_READ] - out[:, P2_READ])
    resting = np.zeros(len(out), dtype=bool)
    for k in range(50, len(out)):
        resting[k] = np.ptp(out[k - 50 : k, PLUG]) < 1e-4 and out[k, PLUG] > 0.05
    resting &= drop < 0.45 * plant.fl.min() ** 2 * p1  # where it neither chokes nor cavitates much
    assert resting.sum() > 20
    opening = np.clip(out[resting, PLUG] + plant.sound["plug_offset"], 0.0, 1.0)
    kv = np.interp(opening, np.linspace(0.0, 1.0, plant.trim.size), plant.trim)
    density = np.repeat(plant.weather[WARM_UP:, 3], A_SECOND)[resting] / 1000.0
    # m3/h from bar, IEC 60534-2-1
    wrong = out[resting, METER] / (kv * np.sqrt(drop[resting] / density)) - 1.0
    assert np.quantile(np.abs(wrong), 0.8) < 0.01


def test_the_stem_follows_within_half_a_percent_at_rest(plant, sound):
    # the command of a resting minute
    command = np.repeat(plant.given, A_SECOND)
    same = np.concatenate(
        [np.zeros(60 * A_SECOND, dtype=bool), command[60 * A_SECOND :] == command[: -60 * A_SECOND]]
    )
    same &= np.abs(command - 0.5) < 0.45
    if same.any():
        assert np.median(np.abs(sound[same, STEM_READ] - command[same])) < 0.005


def test_the_same_seed_is_the_same_plant(plant, sound):
    again = Plant(4, "wide", ROWS, 60)
    np.testing.assert_array_equal(again.run(again.schedule({}, Course())), sound)


def test_columns_and_hardware_are_where_the_march_looks_for_them():
    for names in (COLUMNS, loop.HARDWARE):
        assert [getattr(loop, name.upper()) for name in names] == list(range(len(names)))


def test_a_size_of_nothing_is_no_effect(plant):
    table = plant.schedule(dict.fromkeys(EFFECTS, 0.0), Course())
    np.testing.assert_array_equal(table, plant.schedule({}, Course()))


@pytest.mark.parametrize("name", EFFECTS)
def test_every_effect_changes_the_schedule_from_its_onset_on(name):
    plant = Plant(6, "wide", ROWS, 60, EFFECTS[name].fluid)
    course = Course("within", 300.0)
    change = plant.schedule({name: 0.5 * EFFECTS[name].most}, course) - plant.schedule({}, course)
    begin = WARM_UP + 300
    other = [i for i, c in enumerate(COLUMNS) if c not in ("bend_begin", "back_from", "viscosity_fall")]
    assert np.abs(change[begin:]).max() > 0.0
    assert np.abs(change[:begin][:, other]).max() == 0.0


@pytest.mark.parametrize(
    "name", ["stiction", "link_backlash", "seat_leakage", "meter_lag", "air_slugs", "stuck_valve"]
)
def test_an_effect_shows_where_it_should(plant, sound, name):
    out = plant.run(plant.schedule({name: 0.5 * EFFECTS[name].most}, Course()))
    assert np.isfinite(out).all()
    moved = np.abs(out - sound)[WARM_UP * A_SECOND :]
    first = STEM_READ if EFFECTS[name].block == "actuator" else METER
    assert moved[:, first].max() > 0.01 * (1.0 if first == STEM_READ else plant.span)
    if EFFECTS[name].block != "actuator":
        assert moved[:, STEM_READ].max() < 1e-3  # through the drop on the plug alone


@pytest.mark.parametrize(("size", "jumps"), [(0.0, False), (0.2, True)])
def test_stiction_makes_a_slow_stem_jump(size, jumps):
    plant = Plant(8, "wide", ROWS, 60)
    t = np.arange(plant.n_all)
    plant.given[:] = 0.4 + 0.2 * (t / plant.n_all)  # a slow ramp
    fine = plant.run(plant.schedule({"stiction": size}, Course()))[WARM_UP * A_SECOND :, STEM_READ]
    asked = 0.2 / plant.n_all / A_SECOND  # a row
    assert (np.abs(np.diff(fine)).max() > 20.0 * asked) == jumps


@pytest.mark.parametrize("excitation", ["closed", "cascade"])
def test_controllers_keep_what_they_are_asked(excitation):
    plant = Plant(9, excitation, 1200, 60)
    out = plant.run(plant.schedule({}, Course()))[WARM_UP * A_SECOND :: A_SECOND]
    if excitation == "closed":
        wrong = out[:, METER] - plant.setpoint[WARM_UP:]
        assert np.median(np.abs(wrong)) < 0.02 * plant.span
    else:
        assert 0.1 < out[:, 6].min() < out[:, 6].max() < 0.9


def test_courses():
    burst = Course("on_and_off", 100.0, ((100.0, 200.0), (300.0, 400.0)))
    on = burst.active(700, grows=False)
    assert on[: WARM_UP + 100].max() == 0.0
    assert on.sum() == 200.0
    mended = Course("mended", 100.0, ((100.0, 200.0), (200.0, 300.0))).active(700, grows=True)
    assert mended[WARM_UP + 199] == pytest.approx(0.99)
    assert mended[WARM_UP + 200] == 0.0
    assert Course().active(50, grows=True)[-1] == 1.0


@pytest.mark.parametrize("kind", KINDS)
def test_noise_of_the_stem_is_white_by_its_own_law(kind):
    rng = np.random.default_rng(0)
    law = Law.drawn(rng, (kind,))
    drawn = law.draw(rng, 20_000, 60.0)["opening"]
    white = whiten_opening(drawn[:, None], law, np.full(drawn.size, 0.5))[:, 0]
    assert np.std(white) == pytest.approx(1.0, abs=0.04)
    assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.03


def test_a_jitter_of_the_scan_is_noise_of_a_stem_that_moves():
    rng = np.random.default_rng(0)
    law = Law.drawn(rng, ())
    n = 20_000
    # 3 % of travel in a second, up and down, and half of the time still
    way = 0.5 + 0.03 * np.abs(np.arange(A_SECOND * n) / A_SECOND % 20.0 - 10.0)
    way[(np.arange(A_SECOND * n) // 500) % 2 == 0] = 0.5
    moments = sensors.scan_moments(rng, n, sensors.scan_place(rng))
    late = np.mean(moments - np.arange(n))
    clean = sensors.scan(way, np.arange(n) + late, A_SECOND)
    wrong = sensors.scan(way, moments, A_SECOND) - clean + law.draw(rng, n, 60.0)["opening"]
    white = whiten_opening(wrong[:, None], law, clean)[:, 0]
    moves = np.abs(np.gradient(clean)) > 0.02
    moves &= np.roll(moves, 1) & np.roll(moves, -1)
    still = ~moves & (clean == 0.5)
    assert np.std(white[moves]) == pytest.approx(np.std(white[still]), rel=0.1)
