# SPDX-License-Identifier: BSD-3-Clause
import ast
import hashlib
import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.concealed.inject import damadics, make, refinery
from benchmarks.concealed.inject.effects import BY_KEY, EFFECTS, possible
from benchmarks.concealed.inject.judge import other_stretches, outcome, table
from benchmarks.concealed.inject.noise import COUNTS, DETECTABLE, Ruler, autoregression
from benchmarks.concealed.inject.passage import Fluid, Trim, flow
from benchmarks.concealed.inject.plan import of_stretches, of_windows
from benchmarks.concealed.inject.stem import delayed, lagged, play, slewed, stem, stick_slip
from benchmarks.concealed.inject.writing import write_record

ROWS, LATER = 500, 100


def each(value, rows):
    return np.full(rows, float(value))


@pytest.fixture(scope="module")
def base():
    """A stretch like the boiler's hour: a wandering command, a stem that lags, white and coloured noise."""
    rng = np.random.default_rng(5)
    n = ROWS + LATER
    wander = np.convolve(rng.standard_normal(n + 20), np.ones(21) / 21.0, "valid")
    command = np.round(0.4 + 0.25 * wander + 0.02 * rng.standard_normal(n), 3)
    opening = lagged(command, each(1.0, n), command[0]) + 0.002 * rng.standard_normal(n)
    p1, p2 = 3550.0 + 40.0 * rng.standard_normal(n), 2600.0 + 20.0 * rng.standard_normal(n)
    fluid = Fluid(0.01 * p1, 0.01 * p2, each(0.958, n), each(1.03, n))
    noise = lagged(rng.standard_normal(n), each(2.0, n), 0.0)
    trim = Trim(np.array([0.0, 1.0]), np.array([0.0, 18.0]))
    mass = 0.958 * (flow(opening, trim, fluid, {}) + 0.2 * noise)
    signals = 100.0 - 100.0 * command, 100.0 - 100.0 * opening, p1, p2, each(100.7, n), mass
    return damadics.of_signals("synthetic", *signals, rows=ROWS)


@pytest.fixture(scope="module")
def loop():
    """A closed loop of flow: a set-point that wanders, a disturbance, a PI controller a second."""
    rng = np.random.default_rng(8)
    n = 6000
    gain, keep, proportional, integral = 2.0, np.exp(-1.0 / 12.0), 0.16, 0.013
    setpoint = 100.0 + np.repeat(np.cumsum(0.25 * rng.standard_normal(n // 10)), 10)
    load = lagged(rng.standard_normal(n), each(60.0, n), 0.0)
    command, value, out, last, state = np.empty(n), np.empty(n), 42.0, 0.0, 0.0
    for k in range(n):
        state = keep * state + (1.0 - keep) * gain * (out - 42.0)
        value[k] = 100.0 + state + load[k]
        error = setpoint[k] - value[k]
        out += proportional * (error - last) + integral * error
        last, command[k] = error, out
    return refinery.identified("synthetic", command[::10], value[::10], setpoint[::10], dt=10.0)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(0.0, 1.0), min_size=2, max_size=60), st.floats(0.0, 0.3), st.floats(0.01, 0.2))
def test_parts_of_the_stem_keep_their_bounds(values, width, speed):
    signal = np.array(values)
    n = len(signal)
    after = play(signal, each(width, n), signal[0])
    assert np.all(np.abs(after - signal) <= 0.5 * width + 1e-12)
    follows = slewed(signal, each(speed, n), each(2.0 * speed, n), signal[0])
    assert np.all(np.diff(follows) <= speed + 1e-12)
    assert np.all(np.diff(follows) >= -2.0 * speed - 1e-12)
    stuck = stick_slip(signal, each(width, n), each(0.4 * width, n), signal[0])
    assert np.all(np.abs(stuck - signal) <= width + 1e-12)


def test_without_anything_the_stem_is_the_command():
    command = np.random.default_rng(0).random(50)
    np.testing.assert_array_equal(stem(command, {}), command)


def test_a_sticking_stem_rests_after_a_turn_and_jumps():
    command = np.r_[np.linspace(0.0, 0.5, 51), np.linspace(0.49, 0.0, 50)]
    n = len(command)
    at = stick_slip(command, each(0.1, n), each(0.04, n), 0.0)
    # moving, it trails by half of what is not jump
    assert at[50] == pytest.approx(0.47)
    down = at[51:]
    rests = np.isclose(down, 0.47)
    assert 9 <= rests.sum() <= 11
    assert down[rests.sum()] - 0.47 == pytest.approx(-0.05, abs=0.011)
    assert at[-1] == pytest.approx(command[-1] + 0.03)


def test_a_delay_of_rows_and_of_half_a_row():
    signal = np.arange(6.0)
    np.testing.assert_allclose(delayed(signal, each(2.0, 6)), [0, 0, 0, 1, 2, 3])
    np.testing.assert_allclose(delayed(signal, each(0.5, 6)), [0, 0.5, 1.5, 2.5, 3.5, 4.5])


def test_each_passage_effect_does_what_it_says():
    n = 3
    fluid = Fluid(each(10.0, n), each(6.0, n), each(1.0, n), each(0.02, n))
    trim = Trim(np.array([0.0, 1.0]), np.array([0.0, 10.0]))
    opening = np.array([0.0, 0.5, 1.0])
    sound = flow(opening, trim, fluid, {})
    np.testing.assert_allclose(sound, [0.0, 10.0, 20.0])
    np.testing.assert_allclose(flow(opening, trim, fluid, {"leak": each(0.1, n)}) - sound, 0.2)
    np.testing.assert_allclose(flow(opening, trim, fluid, {"cap": each(6.0, n)}), [0.0, 10.0, 12.0])
    # resistances in series: 1 / kv^2 = 1 / 10^2 + 0.03
    half = flow(opening, trim, fluid, {"loss": each(0.03, n)})
    np.testing.assert_allclose(half, [0.0, 10.0 / np.sqrt(1.75), 10.0])
    worn = flow(opening, trim, fluid, {"wear": each(1.0, n), "reach": each(0.5, n)}) - sound
    np.testing.assert_allclose(worn, 2.0 * np.exp(-opening / 0.5))
    choked = flow(opening, trim, fluid, {"fl": each(0.4, n)})
    most = 0.4**2 * (10.0 - (0.96 - 0.28 * np.sqrt(0.02 / 220.64)) * 0.02)
    np.testing.assert_allclose(choked, sound * np.sqrt(most / 4.0), rtol=1e-6)
    np.testing.assert_allclose(
        flow(opening, trim, fluid, {"outside_leak": each(0.1, n)}), sound - 0.1 * np.sqrt(6.0 - 1.01325)
    )
    meter = {"meter_gain": each(0.1, n), "meter_bias": each(0.3, n)}
    np.testing.assert_allclose(flow(opening, trim, fluid, meter), 1.1 * sound + 0.3)


def test_without_an_effect_the_record_is_the_recording(base):
    seen, recorded, *_ = base.with_effect({})
    np.testing.assert_allclose(seen, base.opening, rtol=0, atol=1e-12)
    np.testing.assert_allclose(recorded, base.recorded_flow, rtol=0, atol=1e-9)
    rest = base.rests()[0]
    # the noise of the position was 0.002 of travel, and rounding of the command adds little
    assert rest[:ROWS].std() == pytest.approx(0.002, rel=0.2)


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.key)
def test_an_effect_explained_by_itself_leaves_the_real_noise(base, effect):
    acts = (np.arange(ROWS + LATER) >= 200).astype(float)
    change = effect.change(0.3 * effect.most * effect.signs[-1], base, acts)
    seen, recorded, *_ = base.with_effect(change)
    assert max(np.abs(recorded - base.recorded_flow).max(), np.abs(seen - base.opening).max()) > 1e-3
    np.testing.assert_allclose(seen[:199], base.opening[:199], rtol=0, atol=1e-12)
    for own, real in zip(base.unexplained(seen, recorded, change), base.rests(), strict=True):
        np.testing.assert_allclose(own, real, rtol=0, atol=1e-9)


def test_autoregression_whitens():
    rng = np.random.default_rng(1)
    white = 0.3 * rng.standard_normal(20000)
    coloured = np.zeros(20000)
    for k in range(1, 20000):
        coloured[k] = 0.8 * coloured[k - 1] + white[k]
    ahead, scatter = autoregression(coloured, order=3)
    np.testing.assert_allclose(ahead, [1.0, -0.8, 0.0, 0.0], atol=0.03)
    assert scatter == pytest.approx(0.3, rel=0.02)


def test_detectable_size_is_at_its_distance_and_grows_with_the_square(base):
    ruler = Ruler(base)
    acts = (np.arange(ROWS + LATER) >= 200).astype(float)
    effect = BY_KEY["flow_meter_gain"]
    size = ruler.detectable(effect, 1, acts)
    change = effect.change(size, base, acts)
    # about the noise of an autoregression there is little more, and the change is large enough to count
    assert 1.0 <= ruler.inflation(change) < 3.0
    assert ruler.counted(change) > COUNTS
    distance = ruler.from_nothing(change)
    assert distance == pytest.approx(DETECTABLE * ruler.inflation(change), rel=2e-2)
    assert ruler.from_nothing(effect.change(2 * size, base, acts)) == pytest.approx(4 * distance, rel=1e-2)
    # from the start it is calibration, and no size can be told
    assert ruler.detectable(effect, 1, np.ones_like(acts)) is None


def test_distances_know_what_is_one_equation_and_what_is_not(base):
    ruler = Ruler(base)
    acts = (np.arange(ROWS + LATER) >= 200).astype(float)
    effect = BY_KEY["flow_meter_gain"]
    nothing, others = ruler.distances(effect, 3 * ruler.detectable(effect, 1, acts), acts)
    assert nothing == pytest.approx(9 * DETECTABLE, rel=2e-2)
    assert others["capacity_error"] == 0.0
    assert others["dead_time"] > 0.5 * nothing
    assert all(distance <= nothing for distance in others.values())
    names = {effect.name for effect in EFFECTS if possible(effect, base)} | {"density_change", "line_loss"}
    assert set(others) == names - {"flow_meter_gain"} | {"inlet_pressure_bias"}


def test_loop_is_identified_and_runs_again_as_it_was(loop):
    assert loop.usable
    assert loop.gain == pytest.approx(2.0, rel=0.3)
    command, value, _ = loop.run(0.0, 0.0)
    np.testing.assert_allclose(command, loop.command, rtol=0, atol=1e-9)
    np.testing.assert_allclose(value, loop.value, rtol=0, atol=1e-9)


def test_sticking_makes_the_controller_answer(loop):
    band = 0.4 * float(np.ptp(loop.command))
    onset = 2000.0
    command, value, at = loop.run(band, 0.5 * band, onset)
    before = np.arange(len(command)) * 10.0 < onset
    np.testing.assert_allclose(command[before], loop.command[before], rtol=0, atol=1e-9)
    assert np.abs(command - loop.command).max() > 0.1 * band
    # integral action brings the mean of the flow back
    off = value - loop.value
    assert np.abs(off.mean()) < 0.2 * np.abs(off).max()
    assert np.abs(at - command).max() > 0.3 * band
    nothing, other = loop.distances(band, 0.5 * band, onset)
    assert nothing > other > 0.0


def test_law_of_friction_in_the_loop_is_that_of_the_stem(loop):
    still = replace(loop, gain=0.0)
    _, _, at = still.run(0.5, 0.2)
    quick, per_row = still.fast(still.command)
    n = len(quick)
    np.testing.assert_allclose(
        at, stick_slip(quick, each(0.5, n), each(0.2, n), quick[0])[::per_row], atol=1e-12
    )


@pytest.mark.slow
def test_plan_is_drawn_by_the_seed_and_tells_the_truth(base):
    records = of_stretches([base], 6, np.random.default_rng(3))
    again = of_stretches([base], 6, np.random.default_rng(3))
    assert [record["truth"] for record in records] == [record["truth"] for record in again]
    kinds = [record["truth"]["kind"] for record in records]
    assert kinds == ["healthy"] + 6 * ["single"]
    np.testing.assert_allclose(records[0]["table"]["X"], 100.0 * base.opening)
    for record in records[1:]:
        truth = record["truth"]
        assert truth["distances"]["nothing"] > 0.5 * DETECTABLE * truth["size_step"]
        assert truth["class"][0] == truth["effects"][0]
        first = int(truth["onset"])
        behind = record["behind"]
        for signal in ("flow", "opening"):
            np.testing.assert_allclose(behind[signal][:first], behind[f"healthy_{signal}"][:first])


def test_a_written_record_can_be_read_and_is_sealed(base, loop, tmp_path):
    from sklvalve import read_recording

    records = [
        of_stretches([base], 1, np.random.default_rng(1))[1],
        of_windows([loop], 1, np.random.default_rng(1))[1],
    ]
    for name, record in zip(("record_0000", "record_0001"), records, strict=True):
        folder = tmp_path / name
        parts = (record[key] for key in ("table", "behind", "sheet", "truth", "rows"))
        line = write_record(folder, *parts)
        assert line.split() == [hashlib.sha256((folder / "truth.json").read_bytes()).hexdigest(), name]
        recording = read_recording(folder / "recording.csv.gz", folder / "valve.toml")
        assert len(recording) == record["rows"]
        assert tomllib.loads((folder / "valve.toml").read_text())["recording"]["flow"]["unit"] == "m3/h"
        truth = json.loads((folder / "truth.json").read_text())
        assert truth["rows"] + truth["rows_later"] == len(record["table"]["time"])
        assert truth["name"] == name


def line_of(kind, effects, verdict, classes):
    found = {"verdict": verdict, "effects": [{"members": [{"name": n} for n in names]} for names in classes]}
    truth = {"kind": kind, "effects": effects, "generator": "injected/x", "size_step": 1.0}
    return {"record": "r", "found": found, "truth": truth | {"distinguishable": True}}


@pytest.mark.parametrize(
    ("verdict", "classes", "expected"),
    [
        ("named", [["dead_time"], ["slew_limit"]], "right"),
        ("named", [["slew_limit"]], "missed"),
        ("named", [["dead_time"], ["erosion"]], "wrong name"),
        ("cannot_tell", [["slew_limit"]], "cannot tell"),
        ("none_of_these", [], "none of these"),
    ],
)
def test_only_names_that_the_twin_has_not_count(verdict, classes, expected):
    twin = line_of("healthy", [], "named", [["slew_limit"]])
    line = line_of("single", ["dead_time"], verdict, classes)
    assert outcome(line, twin) == expected
    assert outcome(line_of("single", ["slew_limit"], verdict, classes), twin) == "in the base already"
    assert outcome(twin) == "wrong name"
    assert "| all, one effect | 1 |" in table([line])


def test_shares_no_code_with_what_it_judges():
    folder = Path(damadics.__file__).parent
    for path in folder.glob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        modules = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
        modules += [
            name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names
        ]
        allowed = {"judge.py": ("sklvalve",)}.get(path.name, ())
        assert [m for m in modules if m.startswith("sklvalve") and m not in allowed] == []


@pytest.mark.slow
def test_real_recordings(data_folder, tmp_path):
    names = make(tmp_path / "one", data_folder, 4, {"damadics": 3, "refinery": 2})
    make(tmp_path / "two", data_folder, 4, {"damadics": 3, "refinery": 2})
    assert (tmp_path / "one" / "seal.txt").read_bytes() == (tmp_path / "two" / "seal.txt").read_bytes()
    sealed = dict(line.split()[::-1] for line in (tmp_path / "one" / "seal.txt").read_text().splitlines())
    assert sorted(sealed) == sorted(names)
    for name in names:
        text = (tmp_path / "one" / name / "truth.json").read_bytes()
        assert sealed[name] == hashlib.sha256(text).hexdigest()
        assert json.loads(text)["twin"] in names
    with pytest.raises(FileExistsError, match="without records"):
        make(tmp_path / "one", data_folder, 4, {"damadics": 1})


def test_the_history_of_a_record_is_the_untouched_other_stretches_of_its_valve():
    stretch = lambda base, kind="healthy", of="watersafe": {  # noqa: E731
        "base": base, "kind": kind, "generator": f"injected/{of}",
    }  # fmt: skip
    truths = {
        Path("a"): stretch("VA_1, 0 to 9 s"),
        Path("b"): stretch("VA_1, 9 to 18 s"),
        Path("c"): stretch("VA_1, 0 to 9 s", "single"),
        Path("d"): stretch("VA_2, 0 to 9 s"),
        Path("e"): stretch("loop 3, 0 to 9 s", of="refinery"),
        Path("f"): stretch("loop 3, 9 to 18 s", of="refinery"),
    }
    others = {Path("a"): [Path("b")], Path("b"): [Path("a")], Path("c"): [Path("b")]}
    assert other_stretches(truths) == others
