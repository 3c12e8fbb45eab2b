# SPDX-License-Identifier: BSD-3-Clause
"""Liquid equations against their own inverses, over 100,000 random duties of each kind."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from sklvalve.mechanism import (
    choked_pressure_drop,
    combined_recovery_factor,
    fitting_loss,
    liquid_flow,
    liquid_inlet_pressure,
    liquid_kv,
    liquid_outlet_pressure,
    piping_factor,
)
from tests.mechanism.liquid_duties import duties, jet_reynolds, quiet_flow

N = 100_000
KINDS = [
    "plain", "pipes", "viscosity", "viscosity and pipes",
    "backward", "pipes, backward", "viscosity, backward", "viscosity and pipes, backward",
]  # fmt: skip


@pytest.fixture(scope="module", params=KINDS)
def duty(request):
    kv, p1, p2, known = duties(N, request.param)
    flow = liquid_flow(kv, p1, p2, **known)
    assert np.all(np.isfinite(flow))
    return request.param, kv, p1, p2, flow, known


def choked(kv, p1, p2, known):
    fl = known["fl"]
    if "inlet_pipe" in known:
        near, far = known["inlet_pipe"], known["outlet_pipe"]
        near, far = np.where(p2 > p1, far, near), np.where(p2 > p1, near, far)
        zeta_sum, zeta_inlet = fitting_loss(known["nominal_size"], near, far)
        fl = combined_recovery_factor(kv, known["nominal_size"], zeta_inlet, fl)
        fl = fl / piping_factor(kv, known["nominal_size"], zeta_sum)
    limit = choked_pressure_drop(np.maximum(p1, p2), known["p_vapour"], 22.064e6, fl)
    return np.abs(p1 - p2) - limit


def test_the_duties_are_of_every_regime(duty):
    kind, kv, p1, p2, flow, known = duty
    assert 0.1 < np.mean(choked(kv, p1, p2, known) >= 0.0) < 0.9
    assert np.all((flow < 0.0) == ("backward" in kind))
    if "viscosity" in kind:
        reynolds = jet_reynolds(flow, kv, known)
        assert np.mean(reynolds < 10.0) > 0.05
        assert np.mean((reynolds > 10.0) & (reynolds < 1e4)) > 0.2
        assert np.mean(reynolds > 1e4) > 0.2


def test_capacity(duty):
    _, kv, p1, p2, flow, known = duty
    assert_allclose(liquid_kv(flow, p1, p2, **known), kv, rtol=1e-9)


def test_outlet_pressure(duty):
    kind, kv, p1, p2, flow, known = duty
    again, feasible = liquid_outlet_pressure(flow, kv, p1, **known, return_feasible=True, warn=False)
    # flow backwards comes from the outlet, whose pressure is defined in choked flow too
    defined = np.full(N, True) if "backward" in kind else choked(kv, p1, p2, known) < 0.0
    near = np.abs(choked(kv, p1, p2, known)) < 1e-9 * np.maximum(p1, p2)
    assert_array_equal(feasible[~near], defined[~near])
    assert np.mean(defined) > 0.2
    assert_allclose(again[feasible], p2[feasible], rtol=1e-9)
    assert_allclose(quiet_flow(kv, p1, np.where(feasible, again, p2), **known), flow, rtol=1e-9)


def test_inlet_pressure(duty):
    kind, kv, p1, p2, flow, known = duty
    again = liquid_inlet_pressure(flow, kv, p2, **known, warn=False)
    defined = choked(kv, p1, p2, known) < -1e-9 * p2 if "backward" in kind else np.full(N, True)
    assert_allclose(again[defined], p1[defined], rtol=1e-9)


@pytest.mark.parametrize("kind", ["viscosity", "viscosity and pipes"])
def test_capacity_where_it_decides_on_the_trim_itself(kind):
    # several capacities may pass such a flow: the answer is the smallest that does
    kv, p1, p2, known = duties(N, kind, seed=1)
    del known["kv_rated"]
    flow = liquid_flow(kv, p1, p2, **known)
    again = liquid_kv(flow, p1, p2, **known)
    assert_allclose(liquid_flow(again, p1, p2, **known), flow, rtol=1e-9)
    assert np.all(again <= kv * (1.0 + 1e-9))
    assert np.mean(again > kv * (1.0 - 1e-9)) > 0.98


@pytest.mark.parametrize("kind", ["viscosity", "viscosity and pipes"])
def test_by_the_letter_the_flow_returns_where_there_is_an_answer(kind):
    kv, p1, p2, known = duties(N, kind, seed=2)
    known["strict"] = True
    flow = quiet_flow(kv, p1, p2, **known)
    assert 0.99 < np.mean(np.isfinite(flow)) < 1.0
    again = liquid_kv(flow, p1, p2, **known, warn=False)
    found = np.isfinite(again)
    assert np.mean(found) > 0.99
    repeated = quiet_flow(np.where(found, again, kv), p1, p2, **known)
    assert_allclose(repeated[found], flow[found], rtol=1e-9)
    p1_again = liquid_inlet_pressure(flow, kv, p2, **known, warn=False)
    repeated = quiet_flow(kv, p1_again, p2, **known)
    passed = np.isfinite(flow)
    assert np.mean(np.abs(repeated[passed] / flow[passed] - 1.0) < 1e-9) > 0.99
