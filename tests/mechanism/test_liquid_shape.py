# SPDX-License-Identifier: BSD-3-Clause
"""Liquid flow rises with opening and drop, without jumps; by the letter it jumps where the standard does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.mechanism import liquid_flow
from tests.mechanism.liquid_duties import duties, jet_reynolds, quiet_flow

KINDS = ["plain", "pipes", "viscosity", "viscosity and pipes"]
SLACK = 1e-9


def columns(known):
    return {name: value[:, None] for name, value in known.items()}


@pytest.mark.parametrize("kind", KINDS)
def test_rises_with_the_drop_and_never_faster_than_laminar_flow(kind):
    # d ln Q / d ln dp between 0 and 1 on every step of a fine grid leaves no room for a jump at any boundary
    kv, p1, _, known = duties(400, kind, seed=3)
    drop = np.geomspace(1e-9, 0.999, 4000)
    flow = quiet_flow(kv[:, None], p1[:, None], p1[:, None] * (1.0 - drop), **columns(known))
    drop = p1[:, None] - p1[:, None] * (1.0 - drop)
    rise, step = np.diff(np.log(flow)), np.diff(np.log(drop))
    steep = 1.0 if "viscosity" in kind else 0.5
    assert np.all(rise >= -SLACK)
    assert np.all(rise <= steep * step + SLACK)
    if "viscosity" in kind:
        reynolds = jet_reynolds(flow, kv[:, None], columns(known))
        for border in (10.0, 1e4):
            crossed = (reynolds[:, :-1] < border) & (reynolds[:, 1:] >= border)
            assert crossed.sum() > 100


@pytest.mark.parametrize("kind", KINDS)
def test_rises_with_the_capacity_of_a_valve_of_known_rated_capacity(kind):
    _, p1, p2, known = duties(400, kind, seed=4)
    widest = 0.04 * (1e3 * duties(400, "pipes", seed=4)[3]["nominal_size"]) ** 2
    if "kv_rated" in known:
        widest = known["kv_rated"]
    kv = widest[:, None] * np.geomspace(1e-5, 1.0, 2000)
    flow = quiet_flow(kv, p1[:, None], p2[:, None], **columns(known))
    rise, step = np.diff(np.log(flow)), np.diff(np.log(kv))
    assert np.all(rise > 0.0)
    assert np.all(rise <= 2.0 * step + SLACK)


def test_a_full_size_trim_taken_by_its_actual_capacity_would_fall():
    # why the trim goes by the rated capacity: the same valve, half open and open, by the letter
    known = {"density": 900.0, "fl": 0.9, "fd": 0.5, "viscosity": 0.1, "nominal_size": 0.1, "kv_rated": 300.0}
    half, full = liquid_flow([150.0, 300.0], 3e5, 2e5, **known, strict=True)
    assert half > full
    half, full = liquid_flow([150.0, 300.0], 3e5, 2e5, **known)
    assert half < full


def flows_by_the_letter(drop, **known):
    valve = {"density": 900.0, "fl": 0.95, "fd": 0.5, "nominal_size": 0.1, "kv_rated": 10.0} | known
    return liquid_flow(10.0, 1e6, 1e6 - drop, **valve, strict=True, warn=False)


def test_by_the_letter_it_jumps_at_a_reynolds_number_of_10():
    # reduced trim with n near 1: the factor falls from 0.09 to 0.02 there, and some drops have no flow
    drop = np.geomspace(1e2, 9e5, 20_000)
    trim = {
        "kv_rated": 1e-4,
        "viscosity": 1e-6,
        "nominal_size": 0.05,
        "fl": 0.95,
        "fd": 0.5,
        "density": 900.0,
    }
    flow = liquid_flow(1e-4, 1e6, 1e6 - drop, **trim, strict=True, warn=False)
    reynolds = jet_reynolds(flow, 1e-4, trim)
    assert np.nanmin(reynolds) < 9.9
    assert np.nanmax(reynolds) > 100.0
    gap = np.isnan(flow)
    assert 0 < gap.sum() < drop.size
    smooth = liquid_flow(1e-4, 1e6, 1e6 - drop, **trim)
    assert np.all(np.isfinite(smooth))
    below = reynolds < 10.0
    np.testing.assert_allclose(flow[below], smooth[below], rtol=1e-12)
    turned = reynolds > 1e3
    if turned.any():
        np.testing.assert_allclose(flow[turned], smooth[turned], rtol=1e-12)


def test_by_the_letter_it_jumps_where_reducers_come_in():
    drop = np.geomspace(1e3, 9e5, 20_000)
    pipes = {"inlet_pipe": 0.2, "outlet_pipe": 0.2, "kv_rated": 350.0, "viscosity": 4e-5}
    valve = {"density": 900.0, "fl": 0.95, "fd": 0.5, "nominal_size": 0.1}
    flow = liquid_flow(350.0, 1e6, 1e6 - drop, **valve, **pipes, strict=True)
    steps = np.diff(np.log(flow))
    assert np.sum(steps < -0.05) == 1
    assert np.sum(steps <= 0.0) == 1
    assert np.all(np.diff(liquid_flow(350.0, 1e6, 1e6 - drop, **valve, **pipes)) > 0.0)


@given(st.integers(0, 10_000), st.sampled_from(KINDS))
@settings(max_examples=40, deadline=None)
def test_shapes_and_single_rows(seed, kind):
    kv, p1, p2, known = duties(6, kind, seed=seed)
    flow = quiet_flow(kv, p1, p2, **known)
    assert flow.shape == (6,)
    one = quiet_flow(kv[2], p1[2], p2[2], **{name: value[2] for name, value in known.items()})
    assert isinstance(one, float)
    np.testing.assert_allclose(one, flow[2], rtol=1e-13)
    square = quiet_flow(kv[:, None], p1, p2, **known)
    assert square.shape == (6, 6)
    np.testing.assert_allclose(np.diag(square), flow, rtol=1e-13)


@given(st.integers(0, 10_000), st.sampled_from(["plain", "viscosity"]))
@settings(max_examples=40, deadline=None)
def test_odd_in_the_drop(seed, kind):
    kv, p1, p2, known = duties(6, kind, seed=seed)
    np.testing.assert_array_equal(quiet_flow(kv, p2, p1, **known), -quiet_flow(kv, p1, p2, **known))


def test_backward_flow_goes_through_the_pipes_the_other_way_round():
    kv, p1, p2, known = duties(1000, "viscosity and pipes", seed=5)
    turned = known | {"inlet_pipe": known["outlet_pipe"], "outlet_pipe": known["inlet_pipe"]}
    np.testing.assert_array_equal(quiet_flow(kv, p2, p1, **turned), -quiet_flow(kv, p1, p2, **known))
