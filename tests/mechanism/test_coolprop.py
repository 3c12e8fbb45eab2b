# SPDX-License-Identifier: BSD-3-Clause
"""Fluids of CoolProp's, where it is installed; and what is said where it is not."""

import pickle
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from sklvalve.mechanism import ValidityWarning, fluid_from, liquid_flow


class TestInstalled:
    @pytest.fixture(autouse=True)
    def _needed(self):
        pytest.importorskip("CoolProp")

    def test_water_is_water(self):
        ours, theirs = fluid_from("water"), fluid_from("CoolProp::Water")
        temperature = np.linspace(274.0, 420.0, 20)
        assert_allclose(theirs.density(temperature), ours.density(temperature), rtol=1e-5)
        assert_allclose(theirs.vapour_pressure(temperature), ours.vapour_pressure(temperature), rtol=1e-4)
        assert_allclose(
            theirs.kinematic_viscosity(temperature), ours.kinematic_viscosity(temperature), rtol=2e-3
        )
        assert_allclose(theirs.critical_pressure, ours.critical_pressure, rtol=1e-9)

    def test_propane_at_its_boiling_point(self):
        propane = fluid_from("CoolProp::Propane")
        assert_allclose(propane.vapour_pressure(231.036), 101325.0, rtol=1e-3)
        assert_allclose(propane.critical_pressure, 4.2512e6, rtol=1e-4)
        assert_allclose(propane.density(), 500.06, rtol=1e-4)

    def test_it_chokes(self):
        propane = fluid_from("CoolProp::Propane")
        state = {"p_vapour": propane.vapour_pressure(300.0), "p_critical": propane.critical_pressure}
        flow = liquid_flow(40.0, 1.5e6, [9e5, 5e5], propane.density(300.0), fl=0.7, **state)
        assert flow[0] == flow[1] > 0.0

    def test_off_the_saturation_line(self):
        propane = fluid_from("CoolProp::Propane")
        with pytest.warns(
            ValidityWarning, match="density of Propane: 2 of 4 rows have a temperature outside"
        ):
            density = propane.density([[10.0, 300.0], [400.0, np.nan]])
        assert_array_equal(np.isnan(density), [[True, False], [True, True]])
        assert np.isnan(propane.density(10.0, warn=False))
        assert np.ndim(propane.density(300.0)) == 0

    def test_numbers_replace_its_own(self):
        propane = fluid_from("CoolProp::Propane", density=505.0)
        assert propane.density(300.0) == 505.0
        assert propane.knows("vapour_pressure")

    def test_it_can_be_sent_to_a_worker(self):
        propane = pickle.loads(pickle.dumps(fluid_from("CoolProp::Propane")))
        assert propane.density(300.0) == fluid_from("CoolProp::Propane").density(300.0)

    @pytest.mark.parametrize("name", ["Mead", "INCOMP::MEG-20%", "HEOS::Propane[0.5]&Ethane[0.5]"])
    def test_no_pure_liquid(self, name):
        with pytest.raises(ValueError, match="CoolProp has no pure liquid"):
            fluid_from(f"CoolProp::{name}")


def test_absent(monkeypatch):
    for module in ("CoolProp", "CoolProp.CoolProp"):
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=r'not installed: pip install "sklvalve\[fluids\]"'):
        fluid_from("CoolProp::Propane")
