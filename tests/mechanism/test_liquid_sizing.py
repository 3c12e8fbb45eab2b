# SPDX-License-Identifier: BSD-3-Clause
"""Sizing by the letter of the standard, whose laws jump: whatever a valve passes, a valve is found for."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sklvalve.mechanism import liquid_flow, liquid_kv
from tests.mechanism.liquid_duties import duties


def test_the_answer_beyond_a_jump():
    # the law jumps over the wanted capacity at a Reynolds number of 10, and reaches it behind that
    valve = {
        "density": 1000.0,
        "fl": 0.8999159444948484,
        "p_vapour": 2e3,
        "viscosity": 2.7185381983489827e-5,
        "fd": 0.8308211780328076,
        "nominal_size": 0.02219110680291305,
        "kv_rated": 19.19188107818954,
        "strict": True,
    }
    pressures = 576818.4107666763, 576816.4019891062
    flow = liquid_flow(6.347250253844233, *pressures, **valve)
    assert_allclose(liquid_kv(flow, *pressures, **valve), 6.347250253844233, rtol=1e-9)


@pytest.mark.parametrize("rated", [True, False])
@pytest.mark.parametrize("kind", ["viscosity", "viscosity and pipes"])
def test_every_flow_by_the_letter_has_a_capacity(kind, rated):
    kv, p1, _, known = duties(5000, kind, seed=5)
    # small drops too, where flow is laminar
    p2 = p1 * (1.0 - 10.0 ** np.random.default_rng(1).uniform(-7.0, -0.01, p1.size))
    if not rated:
        del known["kv_rated"]
    known |= {"strict": True, "warn": False}
    flow = liquid_flow(kv, p1, p2, **known)
    possible = ~np.isnan(flow)
    assert possible.sum() > 4900
    found = liquid_kv(flow, p1, p2, **known)
    assert_allclose(liquid_flow(found, p1, p2, **known)[possible], flow[possible], rtol=1e-7)
    if kind == "viscosity":
        assert np.all(found[possible] <= kv[possible] * (1.0 + 1e-8))
