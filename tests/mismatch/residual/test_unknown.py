# SPDX-License-Identifier: BSD-3-Clause
"""What no effect explains, found by the signals that it follows from."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve.mismatch.inference.problem import Problem
from sklvalve.mismatch.residual.unknown import look_for_residual
from sklvalve.simulation import Tolerance
from sklvalve.simulation.stages import first_order_lag


def _rest_of(recording):
    bench = Problem.of(recording, Tolerance(), recording.valve.physics)
    model = bench.fit((), max_steps=5)
    bench = bench.with_noise_of(model)
    return look_for_residual(bench, model, alpha=0.01)[0]


def _with_flow(recording, rest, **signals):
    return replace(recording, signals=recording.signals | signals | {"flow": recording["flow"] + rest})


def test_nothing_is_found_in_noise(healthy):
    assert _rest_of(healthy) is None


def test_what_lags_behind_the_temperature_is_told_by_both(healthy):
    rng = np.random.default_rng(1)
    levels = np.repeat(rng.uniform(300.0, 330.0, 4), 300)
    temperature = first_order_lag(levels, np.ones(1200), 20.0, 1.0)
    late = temperature - first_order_lag(temperature, np.ones(1200), 150.0, 1.0)
    rest = 0.03 * np.nanmax(healthy["flow"]) * late / np.abs(late).max()
    unknown = _rest_of(_with_flow(healthy, rest, temperature=temperature))
    assert unknown.channel == "flow"
    assert set(unknown.inputs) == {"temperature", "temperature 150 s"}
    assert unknown.period is None


@pytest.mark.parametrize("share", [0.03, 0.06])
def test_its_size_is_the_share_of_the_span_where_it_acts(healthy, share):
    opening, span = healthy["opening"], np.nanmax(healthy["flow"])
    rest = share * span * np.sin(2.0 * np.pi * opening / 0.3)
    unknown = _rest_of(_with_flow(healthy, rest))
    assert "opening" in unknown.inputs
    assert 0.3 * share < unknown.size < share
