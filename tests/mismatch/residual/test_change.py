# SPDX-License-Identifier: BSD-3-Clause
"""A change has a date, an interval and a size; noise, wander and lost motion that stay have none."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve import Recording, Valve
from sklvalve.mismatch.decide.dated import change_entry, dated
from sklvalve.mismatch.decide.judgement import Judgement
from sklvalve.mismatch.residual.change import (
    _steady_columns,
    change_in,
    find_change,
    size_of,
    stands_out,
)

ROWS, AT, SPAN = 1500, 900, 1e-3
SHEET = {
    "valve": {"tag": "drawn"},
    "fluid": {"name": "water"},
    "recording": {
        "time": "t",
        "command": {"column": "CV", "unit": "1"},
        "flow": {"column": "F", "unit": "l/s"},
        "p1": {"column": "P1", "unit": "kPa"},
        "p2": {"constant": 100.0, "unit": "kPa"},
    },
}


class Bench:
    """As much of a problem as is asked: a flow of one's own, and what is left over of it."""

    channels, coupled = ("flow",), True

    def __init__(self, rest, seed=0):
        rng = np.random.default_rng(seed)
        command = np.repeat(rng.uniform(0.2, 0.8, ROWS // 30), 30)
        self.shown = SPAN * command
        wander = np.convolve(rng.standard_normal(ROWS + 99), np.full(100, 0.1), "valid")
        self.rest = SPAN * (rest(command) + 0.002 * wander + 0.004 * rng.standard_normal(ROWS))
        frame = {"t": np.arange(ROWS, dtype=float), "CV": command, "F": 1e3 * (self.shown + self.rest)}
        frame["P1"] = np.full(ROWS, 300.0)
        self.recording = Recording.from_columns(frame, Valve.from_dict(SHEET), "drawn")
        self.spans = {"flow": SPAN}
        chain = SimpleNamespace(step=np.ones(ROWS), clock=100.0 + np.arange(ROWS))
        self.model = SimpleNamespace(predictions={"flow": self.shown}, chain=chain)

    def residuals(self, model):
        return {"flow": self.rest}

    def noise_settings(self, channel):
        return {"inadequacy": 1e-3 * SPAN, "largest": 0.01 * SPAN}

    def least(self, channel):
        return 0.005


def _step(command):
    return np.where(np.arange(ROWS) >= AT, -0.05, 0.0)


@pytest.mark.parametrize("seed", range(4))
def test_a_step_has_a_date_with_an_interval_and_a_size(seed):
    bench = Bench(_step, seed)
    found = change_in(bench, bench.model, "flow")
    assert found.within[0] <= AT <= found.within[1]
    assert found.within[1] - found.within[0] < 30
    assert found.size == pytest.approx(-0.05 * SPAN, rel=0.25)
    assert stands_out(bench, found, 0.01)


def test_a_signal_that_follows_no_more_is_told_by_its_response():
    bench = Bench(lambda command: np.where(np.arange(ROWS) >= 1400, 0.6 - command, 0.0))
    found = change_in(bench, bench.model, "flow")
    assert abs(found.row - 1400) <= 40
    assert found.response == pytest.approx(-1.0, abs=0.2)


def _nothing(command):
    return 0.0 * command


def _lost_motion(command):
    return 0.02 * np.sign(np.diff(command, prepend=command[0]))


def _bent(command):
    return 0.1 * (command - 0.5) ** 2


@pytest.mark.parametrize("rest", [_nothing, _lost_motion, _bent])
@pytest.mark.parametrize("seed", range(4))
def test_what_is_always_there_is_no_change(rest, seed):
    bench = Bench(rest, seed)
    found = find_change(bench, bench.model)
    assert found is None or not stands_out(bench, found, 0.01)


def test_another_place_is_no_other_time():
    """Rows after a time that share no simulated value with those before say nothing of a change."""
    bench = Bench(_step)
    bench.shown = bench.model.predictions["flow"] = np.where(np.arange(ROWS) >= AT, 2.0, 1.0) * bench.shown
    bench.model.predictions["flow"][:AT] *= 0.2
    found = change_in(bench, bench.model, "flow")
    assert found is None or found.row != AT


def test_too_few_rows_have_no_change():
    bench = Bench(_step)
    bench.rest[100:] = np.nan
    assert find_change(bench, bench.model) is None


def test_a_change_turns_agreement_into_doubt_and_is_told_in_the_signals_unit():
    bench = Bench(_step)
    nothing = Judgement(bench, "no_mismatch", 0.3, [], None, bench.model, bench.model)
    told = dated(bench, nothing, 0.01)
    assert told.verdict == "cannot_tell"
    assert told.p_value <= 1e-3
    entry = change_entry(bench.recording, told, {})
    assert entry["signal"] == "flow"
    assert entry["unit"] == "l/s"
    assert entry["size"] == pytest.approx(-0.05, rel=0.25)
    assert entry["ci95"][0] <= entry["time"] <= entry["ci95"][1]
    assert abs(entry["time"] - AT) < 20
    sound = Bench(_nothing)
    nothing = Judgement(sound, "no_mismatch", 0.3, [], None, sound.model, sound.model)
    assert dated(sound, nothing, 0.01) is nothing
    assert change_entry(sound.recording, nothing, {}) is None


def test_a_signal_of_which_nothing_is_known_later_has_no_size():
    left = np.where(np.arange(400) < 300, 0.01, np.nan)
    assert size_of(left, np.linspace(0.0, 1.0, 400), 300) is None


def test_the_levels_of_joined_recordings_hold_the_one_that_all_have():
    bench = Bench(_nothing)
    recording = _Joined(bench.recording, [(0, 700), (700, ROWS)])
    columns = _steady_columns(SimpleNamespace(recording=recording, channels=("flow",)), bench.model, "flow")
    for level in (np.ones(ROWS), np.arange(ROWS) < 700):
        found = np.linalg.lstsq(columns, level.astype(float), rcond=1e-10)[0]
        np.testing.assert_allclose(columns @ found, level, atol=1e-6)


class _Joined:
    """A recording as if two had been joined."""

    def __init__(self, recording, spans):
        self._recording, self.spans = recording, spans

    def __len__(self):
        return len(self._recording)

    def __contains__(self, role):
        return role in self._recording

    def __getitem__(self, role):
        return self._recording[role]
