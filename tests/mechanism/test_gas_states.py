# SPDX-License-Identifier: BSD-3-Clause
"""The state of a gas flow agrees with what the flow does."""

import numpy as np
import pytest

from sklvalve.mechanism import GAS_STATES, gas_flow, gas_state
from tests.mechanism.gas_duties import KINDS, duties


def test_each_state_is_met():
    known = {"gamma": 1.4, "xt": 0.7, "fl": 0.9, "fd": 0.46, "nominal_size": 0.05, "kv_rated": 30.0}
    p2 = np.array([-1.0, 6e5, 5e5, 5e5, 5e5, 1e5, 1e5])
    viscosity = np.array([1e-5, 1e-5, 10.0, 1e-2, 1e-5, 1e-2, 1e-5])
    state = gas_state(10.0, 6e5, p2, 300.0, 0.029, dynamic_viscosity=viscosity, **known)
    names = ["unknown", "no flow", "laminar", "transitional", "turbulent", "transitional", "choked"]
    assert [GAS_STATES[code] for code in state] == names
    back = gas_state(10.0, p2, 6e5, 300.0, 0.029, dynamic_viscosity=viscosity, **known)
    assert back.tolist() == state.tolist()


@pytest.mark.parametrize("kind", KINDS)
def test_choked_is_what_a_lower_pressure_does_not_change(kind):
    (kv, p1, p2, *gas), known = duties(kind, 5000, seed=21)
    state = gas_state(kv, p1, p2, *gas, **known)
    flow = gas_flow(kv, p1, p2, *gas, **known)
    lower = gas_flow(kv, p1, 0.9 * p2, *gas, **known)
    choked = np.array([GAS_STATES[code] == "choked" for code in state])
    assert 50 < np.sum(choked) < 2500
    np.testing.assert_allclose(lower[choked], flow[choked], rtol=1e-14)
    assert np.all(lower[~choked] > flow[~choked])


def test_what_has_no_answer():
    gas = {"temperature": 300.0, "molar_mass": 0.029, "gamma": 1.4, "xt": 0.7}
    assert gas_state(10.0, 6e5, [-5e5, np.nan, 5e5], **gas).tolist() == [-2, -2, 3]
    assert isinstance(gas_state(10.0, 6e5, 5e5, **gas), np.int8)
    # a far wider pipe behind a valve that is hardly there: pressure would be won
    pipes = {"nominal_size": 0.05, "inlet_pipe": 0.05, "outlet_pipe": 0.07}
    assert gas_state([10.0, 500.0], 6e5, 5e5, **gas, **pipes).tolist() == [3, -1]
