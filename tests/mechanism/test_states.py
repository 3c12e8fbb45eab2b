# SPDX-License-Identifier: BSD-3-Clause
"""States of liquid flow: each by what defines it."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from sklvalve.mechanism import (
    LIQUID_STATES,
    choked_pressure_drop,
    incipient_xfz,
    liquid_flow,
    liquid_state,
    pressure_ratio_xf,
)
from tests.mechanism.liquid_duties import duties, jet_reynolds

HOT = {"density": 965.4, "fl": 0.9, "fd": 0.46, "p_vapour": 70.1e3}
CODE = {name: code for code, name in LIQUID_STATES.items()}


def test_all_the_way_down():
    p2 = np.linspace(680e3, 10e3, 2000)
    state = liquid_state(165.0, 680e3, p2, **HOT)
    assert state.dtype == np.int8
    names = [LIQUID_STATES[code] for code in np.unique(state)]
    assert names == ["no flow", "turbulent", "incipient cavitation", "choked", "flashing"]
    assert np.all(np.diff(state) >= 0)
    xf = pressure_ratio_xf(680e3, p2, 70.1e3)
    assert_array_equal(state >= 4, xf >= incipient_xfz(165.0, 0.9, 0.46, p1=680e3))
    assert_array_equal(state >= 5, 680e3 - p2 >= choked_pressure_drop(680e3, 70.1e3, 22.064e6, 0.9))
    assert_array_equal(state == 6, p2 < 70.1e3)


def test_measured_incipient_cavitation():
    p2 = 680e3 - np.array([0.29, 0.31]) * (680e3 - 70.1e3)
    assert_array_equal(liquid_state(165.0, 680e3, p2, **HOT, xfz=0.3), [3, 4])


def test_by_reynolds_number():
    kv, p1, p2, known = duties(3000, "viscosity and pipes", seed=6)
    del known["p_vapour"]
    state = liquid_state(kv, p1, p2, **known)
    reynolds = jet_reynolds(liquid_flow(kv, p1, p2, **known), kv, known)
    assert_array_equal(state, np.select([reynolds < 10.0, reynolds < 1e4], [1, 2], 3))
    assert set(state) == {1, 2, 3}


def test_backward_flow_is_judged_from_its_own_side():
    kv, p1, p2, known = duties(3000, "viscosity and pipes", seed=7)
    turned = known | {"inlet_pipe": known["outlet_pipe"], "outlet_pipe": known["inlet_pipe"]}
    forward = liquid_state(kv, p1, p2, **known)
    assert_array_equal(liquid_state(kv, p2, p1, **turned), forward)
    assert set(forward) == {1, 2, 3, 4, 5, 6}


def test_reducers_choke_earlier():
    p2 = 200e3
    assert liquid_state(100.0, 680e3, p2, **HOT) == CODE["incipient cavitation"]
    between = {"nominal_size": 0.06, "inlet_pipe": 0.12, "outlet_pipe": 0.12}
    assert liquid_state(100.0, 680e3, p2, **HOT, **between) == CODE["choked"]


def test_no_answer():
    state = liquid_state(
        [10.0, 0.0, np.nan, -1.0, 10.0, 10.0, 10.0],
        [3e5, 3e5, 3e5, 3e5, 0.6e5, 3e5, 3e5],
        [3e5, 1e5, 1e5, 1e5, 0.1e5, 1e5, np.inf],
        [1000.0, 1000.0, 1000.0, 1000.0, 1000.0, 0.0, 1000.0],
        fl=0.9,
        p_vapour=0.7e5,
    )
    expected = ["no flow", "no flow", "unknown", "unknown", "infeasible", "unknown", "unknown"]
    assert [LIQUID_STATES[code] for code in state] == expected


def test_what_is_not_given_is_not_looked_for():
    assert liquid_state(10.0, 3e5, 0.1e5, 1000.0) == CODE["turbulent"]
    assert liquid_state(10.0, 3e5, 0.1e5, 1000.0, p_vapour=0.2e5) == CODE["flashing"]
    assert liquid_state(10.0, 3e5, 2.99e5, 1000.0, fl=0.9, p_vapour=0.2e5) == CODE["turbulent"]


def test_by_the_letter_a_duty_may_have_no_state():
    trim = {
        "kv_rated": 1e-4,
        "viscosity": 1e-6,
        "nominal_size": 0.05,
        "fl": 0.95,
        "fd": 0.5,
        "density": 900.0,
    }
    p2 = 1e6 - np.geomspace(1e2, 9e5, 5000)
    strict = liquid_state(1e-4, 1e6, p2, **trim, strict=True)
    assert set(strict) == {-1, 1, 2}
    assert set(liquid_state(1e-4, 1e6, p2, **trim)) == {1, 2}


def test_by_the_letter_choked_is_where_a_lower_pressure_passes_no_more():
    # flow that is not turbulent knows no reducers by the letter, so its choking must not know them either
    kv, p1, p2, known = duties(4000, "viscosity and pipes", seed=8)
    known["viscosity"] = 10.0 ** np.random.default_rng(9).uniform(-6.0, -3.0, kv.size)
    state = liquid_state(kv, p1, p2, **known, strict=True)
    flow = liquid_flow(kv, p1, p2, **known, strict=True, warn=False)
    lower = liquid_flow(kv, p1, 0.999 * p2, **known, strict=True, warn=False)
    at = ~np.isnan(flow + lower)
    assert_array_equal(state[at] >= CODE["choked"], (flow == lower)[at] | (p2 < known["p_vapour"])[at])
    slow = jet_reynolds(flow, kv, known) < 1e4
    assert np.sum((state == CODE["choked"]) & slow) > 500
    assert np.sum((state < CODE["choked"]) & slow) > 500


def test_by_the_letter_all_rows_of_one_choked_flow_are_choked():
    valve = {"fl": 0.501738, "fd": 0.339365, "nominal_size": 0.0396359, "kv_rated": 62.8403, "strict": True}
    valve |= {"inlet_pipe": 0.0978239, "outlet_pipe": 0.1163355, "viscosity": 5.45898e-3, "p_vapour": 2e3}
    p2 = np.linspace(1.1e6, 0.9e6, 400)
    flow = liquid_flow(29.3286, 1351609.0, p2, 1000.0, **valve)
    state = liquid_state(29.3286, 1351609.0, p2, 1000.0, **valve)
    assert_array_equal(state == CODE["choked"], flow == flow[-1])
    assert set(state) > {CODE["choked"]}


def test_what_misses():
    with pytest.raises(ValueError, match="viscosity is given without fd and nominal_size"):
        liquid_state(10.0, 3e5, 1e5, 1000.0, fl=0.9, p_vapour=0.2e5, viscosity=1e-3)
    with pytest.raises(ValueError, match="a pipe is given without nominal_size"):
        liquid_state(10.0, 3e5, 1e5, 1000.0, inlet_pipe=0.1)
