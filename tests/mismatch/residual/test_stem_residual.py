# SPDX-License-Identifier: BSD-3-Clause
"""A stem that strays from its simulation is told, whatever the noise model made of it."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.damadics import make_damadics, valve_sheet
from sklvalve.mismatch.residual.stem_residual import P_VALUE, stem_residual
from sklvalve.report import summary_sentence
from sklvalve.report.headline import headline

ROWS, NOISE = 800, 0.001


class Bench:
    """As much of a problem as is asked, with a rest of one's own."""

    channels = ("opening", "flow")

    def __init__(self, rest, shown, spans=((0, ROWS),)):
        noise = NOISE * np.random.default_rng(3).standard_normal(ROWS)
        self.rest, self.shown = rest + noise, shown
        self.recording = _Recording(shown + self.rest, spans)

    def least(self, channel):
        return 0.005

    def residuals(self, model):
        return {"opening": self.rest}

    def asked(self):
        return stem_residual(self, SimpleNamespace(predictions={"opening": self.shown}))


class _Recording(dict):
    def __init__(self, opening, spans):
        super().__init__(opening=opening)
        self.spans = list(spans)


def _still():
    return np.full(ROWS, 0.4)


def test_a_sound_stem_does_not_stray():
    found = Bench(np.zeros(ROWS), _still()).asked()
    assert (found.windows, found.of, found.evident) == (0, 19, False)
    assert not found.rows.any()
    assert found.size == 0.0


def test_windows_in_which_it_is_off_by_more_than_what_counts_are_told():
    rest = np.zeros(ROWS)
    rest[400:520] = 0.02
    found = Bench(rest, _still()).asked()
    assert found.evident
    assert found.intervals == [(400, 520)]
    assert found.size == pytest.approx(0.02, rel=0.02)
    assert "3 of 19 stretches" in found.reason
    assert "2 % of travel" in found.reason


def test_two_windows_are_not_enough():
    rest = np.zeros(ROWS)
    rest[400:480] = 0.02
    assert not Bench(rest, _still()).asked().evident


@pytest.mark.parametrize(("swing", "evident"), [(0.0, True), (0.3, False)])
def test_a_moving_stem_may_be_off_by_a_share_of_its_move(swing, evident):
    shown = 0.5 + swing * np.sin(np.arange(ROWS) / 6.0)
    assert Bench(np.full(ROWS, 0.015), shown).asked().evident is evident


def test_the_first_window_of_each_recording_is_left_out():
    rest = np.zeros(ROWS)
    rest[:40] = rest[400:440] = 0.3
    found = Bench(rest, _still(), spans=[(0, 400), (400, ROWS)]).asked()
    assert (found.windows, found.of) == (0, 18)


def test_gaps_are_not_asked():
    rest = np.zeros(ROWS)
    rest[200:360] = np.nan
    assert Bench(rest, _still()).asked().of == 15


def test_nothing_is_said_without_a_position():
    bench = Bench(np.zeros(ROWS), _still())
    bench.channels = ("flow",)
    assert bench.asked() is None


@pytest.mark.slow
def test_a_given_stem_that_strays_is_told_with_time_and_place():
    # a perforated diaphragm saws to and fro, which no effect beside a given stem makes
    frame = make_damadics("f10_medium", nominal=True, random_state=5).iloc[300:]
    recording = Recording.from_frame(frame, Valve.from_dict(valve_sheet(nominal=True)))
    effects = ["dead_time", "position_sensor_bias", "position_sensor_gain"]
    found = MissingPhysicsFinder(effects=effects).fit(recording).diagnosis_
    told = found.to_dict()
    assert found.verdict == "cannot_tell"
    assert told["mismatch"]["detected"]
    assert told["mismatch"]["p_value"] <= P_VALUE
    assert told["location"]["blocks"] == ["actuator"]
    # the fault begins at 900 s, which is 600 s after the first row kept
    assert 560.0 <= told["location"]["onset"] <= 640.0
    assert "stem is further" in told["reasons"][0]
    assert "in the actuator" in headline(told)
    assert "in the actuator" in summary_sentence(told)
    assert found.traces["flagged"][600:].mean() > 0.3
    assert not found.traces["flagged"][:560].any()


@pytest.mark.slow
def test_a_sound_stem_beside_a_given_one_has_no_mismatch():
    frame = make_damadics(None, nominal=True, random_state=6).iloc[300:]
    recording = Recording.from_frame(frame, Valve.from_dict(valve_sheet(nominal=True)))
    found = MissingPhysicsFinder(effects=["dead_time", "position_sensor_bias"]).fit(recording).diagnosis_
    assert found.verdict == "no_mismatch"
