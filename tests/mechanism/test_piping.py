# SPDX-License-Identifier: BSD-3-Clause
"""Reducers: published factors, and the exact solution of a case that iterations miss."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from sklvalve.mechanism import (
    ValidityWarning,
    choked_pressure_drop,
    combined_recovery_factor,
    fitting_loss,
    liquid_flow,
    piping_factor,
)

INCH = 0.0254
KV_OF_CV = 0.8649777


def test_example_3_losses():
    # IEC 60534-2-1 worked example 3
    assert_allclose(fitting_loss(0.050, 0.080, 0.100), (0.6580810546875, 1.0330810546875), rtol=1e-9)


def test_emerson_propane():
    # Emerson Control Valve Handbook, liquid sizing problem: 3 in. body in 8 in. pipe, Cv 121
    zeta_sum, _ = fitting_loss(3 * INCH, 8 * INCH, 8 * INCH)
    assert_allclose(zeta_sum, 1.11, rtol=5e-3)
    assert_allclose(piping_factor(121.0 * KV_OF_CV, 3 * INCH, zeta_sum), 0.9, rtol=6e-3)


def test_unequal_reducers_at_the_exact_fixed_point():
    # Kv = 177.88 passes 360 m3/h and is just choked there; the turbulent form alone would say 177.34
    zeta_sum, zeta_inlet = fitting_loss(0.080, 0.100, 0.090)
    fp = piping_factor(177.87988, 0.080, zeta_sum)
    flp = combined_recovery_factor(177.87988, 0.080, zeta_inlet, 0.9)
    known = {"fl": flp / fp, "p_vapour": 70.1e3, "p_critical": 22.12e6}
    flow = liquid_flow(177.87988 * fp, 680e3, 220e3, 965.4, **known)
    assert_allclose(flow * 3600.0, 360.0, rtol=1e-5)
    assert choked_pressure_drop(680e3, 70.1e3, 22.12e6, flp / fp) < 460e3


def test_no_reducers_no_change():
    zeta_sum, zeta_inlet = fitting_loss(0.1, 0.1, 0.1)
    assert zeta_sum == zeta_inlet == 0.0
    assert piping_factor(100.0, 0.1, zeta_sum) == 1.0
    assert combined_recovery_factor(100.0, 0.1, zeta_inlet, 0.9) == 0.9


@given(st.floats(0.02, 0.5), st.floats(1.0, 3.0), st.floats(1.0, 3.0), st.floats(0.1, 1.0))
@settings(max_examples=50, deadline=None)
def test_same_reducers_take_more_the_larger_the_valve_is_open(size, wider_in, wider_out, fl):
    zeta_sum, zeta_inlet = fitting_loss(size, size * wider_in, size * max(wider_in, wider_out))
    kv = np.linspace(0.0, 0.04 * (1e3 * size) ** 2, 20)
    fp = piping_factor(kv, size, zeta_sum, warn=False)
    flp = combined_recovery_factor(kv, size, zeta_inlet, fl)
    assert fp[0] == 1.0
    assert flp[0] == fl
    assert np.all(np.diff(fp) * np.sign(zeta_sum) <= 0.0)
    assert np.all(np.diff(flp) <= 0.0)


def test_impossible_reducers():
    with pytest.warns(ValidityWarning, match="1 of 3 rows have reducers"):
        fp = piping_factor([10.0, 500.0, np.nan], 0.05, -1.0)
    assert np.isfinite(fp[0])
    assert np.isnan(fp[1:]).all()
