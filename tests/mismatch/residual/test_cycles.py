# SPDX-License-Identifier: BSD-3-Clause
"""A rest that comes back in time: found by its period, told from wander and from what drives the valve."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.inference.problem import Problem
from sklvalve.mismatch.residual.cycles import find_cycle
from sklvalve.simulation import Tolerance

PERIOD = 150.0


def _swinging(recording, share, *, begins=0.0, growing=True):
    """A recording whose flow swings by a share of itself, or by the same share of its largest value."""
    flow, time = recording["flow"], recording.time
    height = flow if growing else np.nanmax(flow)
    swing = share * height * np.sin(2.0 * np.pi * time / PERIOD + 0.7) * (time >= begins)
    return replace(recording, signals=recording.signals | {"flow": flow + swing})


def _found(recording):
    bench = Problem.of(recording, Tolerance(), recording.valve.physics)
    model = bench.fit((), max_steps=5)
    bench = bench.with_noise_of(model)
    return find_cycle(bench, model, "flow")


@pytest.mark.parametrize("growing", [True, False])
def test_a_cycle_is_found_by_its_period(healthy, growing):
    cycle = _found(_swinging(healthy, 0.03, growing=growing))
    assert cycle.period == pytest.approx(PERIOD, rel=0.08)
    assert cycle.p_value < 1e-6


def test_noise_has_no_period(healthy):
    assert _found(healthy) is None


def test_wander_has_no_period(healthy):
    rng, step = np.random.default_rng(0), 0.97
    wander = np.zeros(len(healthy))
    for k in range(1, len(wander)):
        wander[k] = step * wander[k - 1] + np.sqrt(1.0 - step**2) * rng.normal()
    flow = healthy["flow"] + 0.01 * np.nanmax(healthy["flow"]) * wander
    assert _found(replace(healthy, signals=healthy.signals | {"flow": flow})) is None


def test_what_the_valve_itself_repeats_is_no_cycle_of_its_own(healthy):
    # a meter that shows 4 % too much of a swing that the valve is made to do
    time = healthy.time
    opening = 0.5 + 0.2 * np.sin(2.0 * np.pi * time / PERIOD)
    signals = healthy.signals | {"opening": opening, "command": opening}
    bench = Problem.of(replace(healthy, signals=signals), Tolerance(), healthy.valve.physics)
    model = bench.fit((), max_steps=3)
    flow = model.predictions["flow"]
    noise = 0.003 * flow.mean() * np.random.default_rng(0).normal(size=len(flow))
    swung = replace(bench.recording, signals=signals | {"flow": flow + 0.04 * (flow - flow.mean()) + noise})
    again = Problem.of(swung, Tolerance(), healthy.valve.physics, trim=bench.trim)
    same = again.simulate((), model.values)
    again = again.with_noise_of(same)
    assert find_cycle(again, same, "flow") is None


@pytest.mark.slow
def test_a_cycle_is_reported_as_an_unknown_effect_and_corrected(healthy):
    finder = MissingPhysicsFinder(effects=["clogging", "flow_meter_drift"]).fit(
        _swinging(healthy, 0.05, growing=False)
    )
    content = finder.diagnosis_.content
    assert content["verdict"] == "none_of_these"
    assert content["unknown"]["inputs"][0] == "a cycle of 150 s"
    errors = content["fit"]["flow"]["rmse"]
    assert errors["corrected"] < 0.7 * errors["nominal"]


def test_a_period_is_told_more_finely_than_the_length_of_the_recording_holds_apart(healthy):
    # 1,200 rows hold apart 150 and 171 s; 160 s lies between
    flow = healthy["flow"] + 0.03 * np.nanmax(healthy["flow"]) * np.sin(2.0 * np.pi * healthy.time / 160.0)
    cycle = _found(replace(healthy, signals=healthy.signals | {"flow": flow}))
    assert cycle.period == pytest.approx(160.0, rel=0.01)
