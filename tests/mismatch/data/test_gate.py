# SPDX-License-Identifier: BSD-3-Clause
"""Findings about the data switch effects off, blank rows, set clocks right, or block the diagnosis."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch.data.gate import blocking, effects_switched_off
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.recording import Recording
from sklvalve.recording.dead_bands import DeadBand, band_of, step_of
from sklvalve.recording.measured import without_findings
from sklvalve.simulation.fitting import residual_of
from sklvalve.simulation.noise_of_pieces import noise_of

NAMES = {effect.name for effect in CATALOGUE}


def found(name, role, rows=None, **more):
    return {"finding": name, "role": role, "detail": "d", "rows": rows, **more}


def recording():
    time = np.arange(100.0)
    return Recording.from_frame(
        {"time": time, "command": time / 100, "opening": time / 100, "flow": 1.0 + time}
    )


@pytest.mark.parametrize(
    ("finding", "off", "on"),
    [
        (found("compressed", "opening"), ("stiction", "backlash", "dead_time"), ("seat_leakage", "clogging")),
        (found("compressed", "flow"), ("flow_inertia", "backlash"), ("stiction", "slew_limit")),
        (found("compressed", "opening", size=0.003), ("flow_inertia",), ("stiction", "dead_time")),
        (found("compressed", "opening", size=0.006), ("stiction", "dead_time"), ("clogging",)),
        (found("frozen", "opening", [[5, 40]]), ("stuck_valve", "stiction"), ("clogging", "slew_limit")),
        (found("saturated", "flow", [[5, 40]]), ("clogging", "choked_flow"), ("stiction", "dead_time")),
        (found("clock_shift", "flow", size=5.0), ("dead_time", "sensor_lag"), ("clogging", "seat_leakage")),
        (found("quantised", "opening", size=0.02), ("stiction", "backlash"), ("dead_time", "clogging")),
    ],
)
def test_what_a_finding_imitates_is_not_testable(finding, off, on):
    told = effects_switched_off([finding])
    assert set(off) <= set(told)
    assert not set(on) & set(told)
    assert all(finding["role"] in told[name] for name in off)


def test_steps_too_small_to_count_switch_nothing_off():
    assert effects_switched_off([found("quantised", "opening", size=0.002)]) == {}


def test_gap_switches_nothing_off():
    assert effects_switched_off([found("gap", "flow", [[3, 9]]), found("gap", None)]) == {}


def test_flow_that_never_moves_leaves_nothing():
    assert set(effects_switched_off([found("frozen", "flow")])) == NAMES


@pytest.mark.parametrize("name", ["swapped", "unit_suspect"])
def test_columns_that_are_not_what_they_are_called_block_everything(name):
    data = [found(name, "p2")]
    assert set(effects_switched_off(data)) == NAMES
    assert "p2 d" in blocking(data)


def test_other_findings_do_not_block():
    assert blocking([found("frozen", "flow", [[1, 30]]), found("clock_shift", "flow", size=3.0)]) is None


def test_frozen_and_saturated_rows_are_left_out():
    whole = recording()
    left = without_findings(
        whole, [found("frozen", "flow", [[10, 20]]), found("saturated", "opening", [[90, 100]])]
    )
    assert np.flatnonzero(np.isnan(left["flow"])).tolist() == list(range(10, 20))
    assert np.flatnonzero(np.isnan(left["opening"])).tolist() == list(range(90, 100))
    assert np.isfinite(whole["flow"]).all()
    assert left["command"] is whole["command"]


def test_value_that_was_never_measured_goes_however_long_it_is():
    left = without_findings(recording(), [found("frozen", "opening", [[0, 90]])])
    assert np.isnan(left["opening"][:90]).all()
    assert np.isfinite(left["opening"][90:]).all()


def test_seized_stem_stays_testable_and_nothing_else_that_a_frozen_opening_imitates():
    marked = found("frozen", "opening", [[0, 90]], seized=True)
    assert "stuck_valve" not in effects_switched_off([marked])
    assert "stiction" in effects_switched_off([marked])


def test_nothing_to_leave_out_gives_the_recording_itself():
    whole = recording()
    kept = [
        found("frozen", "flow"),
        found("saturated", "opening", [[0, 90]]),
        found("frozen", "opening", [[0, 9]], seized=True),
        found("frozen", "command", [[1, 9]]),
    ]
    assert without_findings(whole, kept) is whole


@pytest.mark.parametrize("late", [4, -4])
@pytest.mark.parametrize("role", ["flow", "command"])
def test_clock_is_set_right(role, late):
    whole = recording()
    places = np.clip(np.arange(100) - late, 0, 99)
    off = Recording.from_frame(
        {"time": whole.time, **{r: whole[r][places] if r == role else whole[r] for r in whole}}
    )
    mended = without_findings(off, [found("clock_shift", role, size=float(late))])[role]
    np.testing.assert_allclose(mended[8:-8], whole[role][8:-8], rtol=1e-12)
    assert np.isnan(mended).sum() == (0 if role == "command" else 4)


def test_dead_time_says_that_an_early_command_looks_the_same():
    (dead_time,) = (effect for effect in CATALOGUE if effect.name == "dead_time")
    assert "a command stamped early looks the same" in dead_time.separated_by


def test_only_what_leaves_a_small_band_counts_against_a_simulation():
    held = without_findings(recording(), [found("compressed", "opening", size=0.003)])
    assert held.bands == {"opening": (DeadBand(-np.inf, np.inf, 0.003),)}
    simulated = held["opening"] + np.linspace(-0.006, 0.006, len(held))
    chain = SimpleNamespace(recording=held)
    left = residual_of(chain, {"opening": simulated}, "opening", None)
    assert np.abs(left).max() == pytest.approx(0.003)
    assert (left[30:70] == 0.0).all()
    assert left[0] > 0.0 > left[-1]
    assert without_findings(recording(), [found("compressed", "opening", size=0.006)]).bands == {}
    assert without_findings(recording(), [found("compressed", "flow")]).bands == {}


def test_a_flow_held_within_a_band_is_compared_whole_and_known_no_better_than_the_band():
    whole = recording()
    held = without_findings(whole, [found("compressed", "flow", size=10.0)])
    assert held.bands == {"flow": (DeadBand(-np.inf, np.inf, 10.0),)}
    simulated = {"flow": held["flow"] + np.random.default_rng(0).normal(0.0, 0.1, len(held))}
    left = [residual_of(SimpleNamespace(recording=r), simulated, "flow", None) for r in (whole, held)]
    np.testing.assert_array_equal(*left)
    floors = [noise_of(r, left[0], simulated["flow"], np.ones(len(r)), "flow").floor for r in (whole, held)]
    # its steps of 1 say 0.3, the band ten times that
    assert floors == [
        pytest.approx(1.0 / np.sqrt(12.0), rel=0.1),
        pytest.approx(10.0 / np.sqrt(12.0), rel=0.1),
    ]


def test_a_band_holds_for_the_rows_it_was_found_in_and_for_those_behind():
    whole = recording()
    first = without_findings(whole, [found("compressed", "flow", [[0, 40]], size=10.0)])
    np.testing.assert_array_equal(band_of(first, "flow"), np.where(np.arange(100) < 40, 10.0, 0.0))
    np.testing.assert_array_equal(band_of(first.slice(30, 60), "flow"), np.repeat([10.0, 0.0], [10, 20]))
    assert (step_of(first, "flow"), step_of(first.slice(40, 100), "flow")) == pytest.approx((10.0, 1.0))
    # of the rows used it was the end: the rows behind them are told of it too
    last = without_findings(whole.slice(0, 80), [found("compressed", "opening", [[40, 80]], size=0.003)])
    onwards = replace(whole, bands=last.bands)
    np.testing.assert_array_equal(band_of(onwards, "opening") > 0.0, np.arange(100) >= 40)
    simulated = {"opening": whole["opening"] + 0.002}
    left = residual_of(SimpleNamespace(recording=onwards), simulated, "opening", None)
    np.testing.assert_allclose(left, np.where(np.arange(100) < 40, -0.002, 0.0), atol=1e-12)
    assert band_of(onwards, "p1").tolist() == [0.0] * 100
