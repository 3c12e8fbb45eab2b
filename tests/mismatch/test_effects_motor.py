# SPDX-License-Identifier: BSD-3-Clause
"""Effects of electric actuators, and how a recording shows the errors that its motor leaves alone."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.data.preparation import candidates
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.effects.thresholds import seen_thresholds
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.inference.problem import Problem
from sklvalve.recording import Recording, Valve
from sklvalve.simulation import Tolerance
from sklvalve.simulation.electric import is_electric

EFFECTS = {e.key: e for e in CATALOGUE}
STEP = 0.1


def another_motor(command, speed, dead_time, band, turning):
    """A motor written another way: small steps, and a queue for the delay."""
    fine, x, on, side, out = 20, command[0], False, 0, []
    queue = [command[0]] * round(dead_time / STEP * fine)
    for wanted in command:
        for _ in range(fine):
            queue.append(wanted)
            error = queue.pop(0) - x
            way = 1 if error > 0 else -1
            if not on and abs(error) > (turning if way == -side else band):
                on, side = True, way
            if on:
                move = speed * STEP / fine
                on = abs(error) > move
                x += way * min(move, abs(error))
        out.append(x)
    return np.array(out)


def record(seed=0, n=2400, speed=0.05, dead_time=0.4, band=0.01, turning=0.025):
    rng = np.random.default_rng(seed)
    held = rng.integers(10, 30, n)
    slow = 0.5 + 0.15 * np.sin(np.arange(n) * STEP * 0.12)
    command, level = np.empty(n), 0.5
    k = 0
    for length in held:
        if k >= n:
            break
        level = slow[k] if rng.random() < 0.85 else rng.uniform(0.2, 0.8)
        command[k : k + length] = level
        k += length
    x = another_motor(command, speed, dead_time, band, turning)
    frame = {
        "time": STEP * np.arange(n),
        "command": command,
        "opening": np.round(x + 2e-4 * rng.standard_normal(n), 4),
    }
    return Recording.from_frame(frame)


@pytest.fixture(scope="module")
def recording():
    return record()


@pytest.fixture(scope="module")
def bench(recording):
    return Problem.of(recording, Tolerance(), ())


@pytest.mark.parametrize(
    ("key", "nothing"),
    [
        ("slew_limit_motor", {"speed": 10.0, "closing_ratio": 1.0}),
        ("positioner_deadband_motor", {"half_width": 0.0, "reversal": 2.5}),
    ],
)
def test_at_no_size_it_changes_nothing(bench, key, nothing):
    values = {p.name: p.start for p in bench.calibration(bench.channels)} | {"actuator_speed": 10.0}
    plain = bench.simulate((), values)
    own = {f"{key}.{name}": value for name, value in nothing.items()}
    same = bench.simulate((Term(EFFECTS[key]),), values | own)
    np.testing.assert_allclose(same.predictions["opening"], plain.predictions["opening"], atol=1e-12)


def test_only_effects_of_a_motor_are_tried_on_one(bench):
    assert bench.plain.electric
    found, untestable = candidates(bench, "all", [])
    keys = {e.key for e in found}
    assert {"slew_limit_motor", "positioner_deadband_motor", "dead_time"} <= keys
    assert not {"slew_limit", "positioner_deadband", "stiction"} & keys
    needs = {u["name"]: u["needs"] for u in untestable}
    assert needs["stiction"] == "an actuator driven by air"
    assert "slew_limit" not in needs


def test_a_word_of_air_makes_it_no_motor(recording):
    assert is_electric(Valve(), recording)
    for word in ({"supply_pressure": 3e5}, {"fail": "closed"}, {"spring_range": (2e4, 1e5)}):
        assert not is_electric(Valve(**word), recording)


def test_recording_shows_the_errors_that_its_motor_leaves_alone(recording):
    on, turning = seen_thresholds(recording)
    assert np.mean(on) == pytest.approx(0.010, abs=0.002)
    assert np.mean(turning) == pytest.approx(0.025, abs=0.003)


def test_without_a_dead_band_there_is_no_threshold():
    assert seen_thresholds(record(band=0.0, turning=0.0)) is None


def test_a_command_at_rest_shows_no_threshold(recording):
    still = replace(recording, signals={**recording.signals, "command": np.full(len(recording), 0.5)})
    assert seen_thresholds(still) is None


def test_all_three_effects_of_a_motor_are_fitted(bench):
    bench, nominal = calibrated(bench)
    fitted = nominal
    for key in ("slew_limit_motor", "dead_time", "positioner_deadband_motor"):
        fitted = bench.fit([*fitted.terms, Term(EFFECTS[key])], start=fitted)
    values = fitted.values
    assert values["slew_limit_motor.speed"] == pytest.approx(0.05, rel=0.06)
    assert values["dead_time.delay"] + values["actuator_delay"] == pytest.approx(0.4, abs=0.1)
    assert values["positioner_deadband_motor.half_width"] == pytest.approx(0.010, abs=0.002)
    left = [np.sqrt(np.nanmean(bench.residuals(m)["opening"] ** 2)) for m in (nominal, fitted)]
    assert left[1] < 0.2 * left[0]


@pytest.mark.slow
def test_a_slow_motor_is_named(recording):
    found = MissingPhysicsFinder().fit(recording).diagnosis_.to_dict()
    assert found["verdict"] == "named"
    assert "slew_limit" in {m["name"] for m in found["effects"][0]["members"]}
    assert found["location"]["blocks"] == ["actuator"]
