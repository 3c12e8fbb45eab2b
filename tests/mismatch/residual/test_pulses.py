# SPDX-License-Identifier: BSD-3-Clause
"""A flow that breaks out to one side for moments is told, whatever the noise; to both sides it is noise."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.residual import pulses as module
from sklvalve.mismatch.residual.pulses import find_pulses
from sklvalve.report import summary_sentence
from sklvalve.report.headline import headline

ROWS, SPAN, NOISE = 2000, 20.0, 0.002
ALPHA = 0.01
STARTS = np.arange(150, ROWS - 100, 120)


class _Recording(dict):
    """Signals that move nothing, of recordings laid one behind the other."""

    def __init__(self, spans):
        super().__init__(opening=None, p1=None, p2=None)
        self.spans = list(spans)


class Bench:
    """As much of a problem as is asked, with a rest of one's own as share of the span."""

    channels, coupled, spans = ("opening", "flow"), False, {"flow": SPAN}

    def __init__(self, monkeypatch, rest, shown=None, steps=(), spans=((0, ROWS),), noise=NOISE):
        self.rest = rest + noise * np.random.default_rng(4).standard_normal(ROWS)
        self.shown = np.full(ROWS, 0.5) if shown is None else shown
        self.recording = _Recording(spans)
        self.unknown_drop = False
        steps = dict(steps)
        monkeypatch.setattr(module, "step_of", lambda recording, role: steps.get(role, 0.0))
        monkeypatch.setattr(module, "flow_moved_by", lambda recording, change: change / 8e5)
        monkeypatch.setattr(module, "drop_is_unknown", lambda recording: self.unknown_drop)

    def least(self, channel):
        return 0.005

    def residuals(self, model):
        return {"flow": SPAN * self.rest}

    def asked(self, alpha=ALPHA):
        return find_pulses(self, SimpleNamespace(predictions={"flow": SPAN * self.shown}), alpha)


def _pulses(height, starts=STARTS, length=12):
    rest = np.zeros(ROWS)
    for start in starts:
        rest[start : start + length] += height * np.sin(np.pi * np.arange(length) / length)
    return rest


@pytest.mark.parametrize("height", [-0.04, 0.04])
def test_pulses_to_one_side_are_told(monkeypatch, height):
    found = Bench(monkeypatch, _pulses(height)).asked()
    assert (found.many, found.against, found.falls) == (len(STARTS), 0, height < 0.0)
    # the sign test, either side, at a quarter of the level
    assert found.p_value == pytest.approx(4.0 * 2.0 * 0.5 ** len(STARTS))
    assert len(found.intervals) == len(STARTS)
    inside = np.zeros(ROWS, dtype=bool)
    for start in STARTS:
        inside[start - 4 : start + 16] = True
    assert not found.rows[~inside].any()
    assert 0.5 * 0.04 < found.size < 0.04


def test_noise_alone_has_none(monkeypatch):
    assert Bench(monkeypatch, np.zeros(ROWS)).asked() is None


def test_pulses_to_both_sides_are_noise_of_heavy_tails(monkeypatch):
    rest = _pulses(0.04, STARTS[::2]) + _pulses(-0.04, STARTS[1::2])
    assert Bench(monkeypatch, rest).asked() is None


def test_a_few_pulses_are_chance(monkeypatch):
    # of nine all are on one side once in 256 times, of ten once in 512
    assert Bench(monkeypatch, _pulses(-0.04, STARTS[:9])).asked() is None
    assert Bench(monkeypatch, _pulses(-0.04, STARTS[:9])).asked(alpha=0.02) is not None
    assert Bench(monkeypatch, _pulses(-0.04, STARTS[:10])).asked() is not None


def test_a_pulse_of_two_parts_is_one(monkeypatch):
    twice = np.sort(np.concatenate([STARTS, STARTS + 14]))
    assert Bench(monkeypatch, _pulses(-0.04, twice, length=8)).asked().many == len(STARTS)


def test_slow_wander_is_no_pulse(monkeypatch):
    # twenty peaks, each as wide as what is around is looked at
    wander = 0.03 * np.sin(np.pi * np.arange(ROWS) / 100.0) ** 6
    assert Bench(monkeypatch, np.repeat(wander[::2], 2)[:ROWS] * 0.2).asked() is None
    slow = 0.03 * np.sin(np.pi * np.arange(ROWS) / 160.0) ** 2
    assert Bench(monkeypatch, slow).asked() is None


def test_spikes_of_one_row_are_no_pulses(monkeypatch):
    rest = np.zeros(ROWS)
    rest[STARTS] = -0.03
    assert Bench(monkeypatch, rest).asked() is None


def test_what_does_not_count_is_not_told(monkeypatch):
    assert Bench(monkeypatch, _pulses(-0.02), noise=1e-4).asked() is not None
    assert Bench(monkeypatch, _pulses(-0.004), noise=1e-4).asked() is None


@pytest.mark.parametrize(
    ("role", "fine", "coarse"), [("flow", 0.1, 0.8), ("p1", 4e3, 3e4), ("opening", 1e-3, 0.01)]
)
def test_steps_of_a_coarse_reading_are_no_pulses(monkeypatch, role, fine, coarse):
    assert Bench(monkeypatch, _pulses(-0.04), steps={role: fine}).asked() is not None
    assert Bench(monkeypatch, _pulses(-0.04), steps={role: coarse}).asked() is None


@pytest.mark.parametrize("slow", [False, True])
def test_pulses_beside_movement_count_for_nothing(monkeypatch, slow):
    shown = np.full(ROWS, 0.5)
    for start in STARTS:
        # a stroke, or a ramp of a third of a percent a row
        shown[start - 15 : start + 27] += 0.003 * np.arange(42) if slow else 0.1 * (np.arange(42) > 14)
    assert Bench(monkeypatch, _pulses(-0.04), shown=shown).asked() is None


def test_noise_has_one_side_where_nothing_flows(monkeypatch):
    shown = np.where(np.arange(ROWS) < 400, 0.5, 0.0)
    bench = Bench(monkeypatch, _pulses(0.04, STARTS[STARTS > 420]), shown=shown)
    assert bench.asked() is None
    bench.shown = np.full(ROWS, 0.5)
    assert bench.asked() is not None


def test_recordings_joined_have_surroundings_of_their_own(monkeypatch):
    # every second one is calibrated a little wrong: what begins there is no pulse
    edges = [(k, k + 80) for k in range(0, ROWS, 80)]
    level = 0.03 * (np.arange(ROWS) // 80 % 2)
    assert Bench(monkeypatch, level, spans=edges).asked() is None
    assert (
        Bench(monkeypatch, _pulses(-0.04), spans=[(0, 1060), (1060, 1063), (1063, ROWS)]).asked() is not None
    )


def test_gaps_are_no_pulses(monkeypatch):
    bench = Bench(monkeypatch, np.full(ROWS, 0.03))
    for start in STARTS:
        bench.rest[start : start + 12] = np.nan
    assert bench.asked() is None


@pytest.mark.parametrize("lack", ["opening", "drop", "flow", "rest", "rows"])
def test_nothing_is_said_where_something_else_may_be_all_of_it(monkeypatch, lack):
    bench = Bench(monkeypatch, _pulses(-0.04))
    assert bench.asked() is not None
    if lack == "opening":
        bench.coupled = True
    elif lack == "drop":
        bench.unknown_drop = True
    elif lack == "flow":
        bench.channels = ("opening",)
    elif lack == "rest":
        bench.shown = 0.5 + 0.1 * np.sin(np.arange(ROWS))
    else:
        bench.rest[:] = np.nan
    assert bench.asked() is None


@pytest.fixture(scope="module")
def slugged():
    made = make_valve_recording(None, loop="closed", n_samples=2400, n_later=0, random_state=11)
    frame = made.frame.copy()
    rng = np.random.default_rng(5)
    for start in 700 + np.cumsum(rng.integers(50, 120, 19)):
        length = int(rng.integers(6, 11))
        dip = np.sin(np.pi * np.arange(length) / length)
        frame.loc[start : start + length - 1, "F"] *= 1.0 - 0.05 * dip
    recording = Recording.from_frame(frame, Valve.from_dict(made.valve))
    return MissingPhysicsFinder(effects=["flow_meter_bias", "dead_time"]).fit(recording).diagnosis_


@pytest.mark.slow
def test_slugs_of_gas_are_no_known_effect_and_no_noise(slugged):
    told = slugged.to_dict()
    assert slugged.verdict == "none_of_these"
    assert told["mismatch"]["detected"]
    assert told["mismatch"]["p_value"] <= ALPHA
    assert told["effects"] == []
    assert told["unknown"]["signal"] == "flow"
    assert told["unknown"]["pulses"]["side"] == "below"
    assert told["unknown"]["pulses"]["moments"] >= 10
    assert not told["unknown"]["correction"]["added"]
    assert told["location"]["blocks"] == ["line", "measurement", "valve"]
    assert 700.0 <= told["location"]["onset"] <= 1000.0
    assert not slugged.traces["flagged"][:690].any()
    assert slugged.traces["flagged"][700:].mean() > 0.03
    assert "Hold the command for half an hour" in told["next_test"]


@pytest.mark.slow
def test_words_say_how_it_differs_from_noise(slugged):
    told = slugged.to_dict()
    sentence = summary_sentence(told)
    moments = told["unknown"]["pulses"]["moments"]
    assert f"below its simulation at {moments} moments while the valve is at rest" in sentence
    assert "noise does not do that" in sentence
    assert "no known effect explains" in headline(told)


@pytest.mark.slow
def test_a_valve_that_is_shut_for_half_of_the_time_is_no_leaking_one():
    """A meter ends at zero: what it makes of its noise there has one side."""
    made = make_valve_recording(None, loop="closed", n_samples=2400, n_later=0, random_state=21)
    frame, rng = made.frame.copy(), np.random.default_rng(21)
    noise = np.zeros(1200)
    for k in range(1, 1200):
        noise[k] = 0.8 * noise[k - 1] + 0.6 * rng.standard_normal()
    frame.loc[1200:, ["CV", "X"]] = 0.0
    frame.loc[1200:, "F"] = np.maximum(0.007 * frame.F.max() * noise, 0.0)
    recording = Recording.from_frame(frame, Valve.from_dict(made.valve))
    told = MissingPhysicsFinder(effects=["flow_meter_bias", "dead_time"]).fit(recording).diagnosis_.to_dict()
    assert "pulses" not in (told.get("unknown") or {})
