# SPDX-License-Identifier: BSD-3-Clause
"""Private: the rows of one matrix as a valve in gas service sees them."""

from functools import cached_property
from typing import ClassVar

import numpy as np

from sklvalve.mechanism._rows import ValveRows
from sklvalve.mechanism.gas import gas_flow, gas_kv
from sklvalve.mechanism.gas_factors import (
    choked_drop_ratio,
    combined_drop_ratio_factor,
    expansion_factor,
    specific_heat_ratio_factor,
)
from sklvalve.mechanism.gas_inputs import positive
from sklvalve.mechanism.gas_pressure import gas_inlet_pressure, gas_outlet_pressure
from sklvalve.mechanism.gas_states import GAS_STATES, gas_state
from sklvalve.mechanism.gas_units import gas_density, gas_mass_flow
from sklvalve.mechanism.opening import opening_for_gas_flow
from sklvalve.mechanism.trim import trim_parameter
from sklvalve.mechanism.viscosity import reynolds_factor, valve_reynolds_number

_CHOKED = next(code for code, name in GAS_STATES.items() if name == "choked")


class GasRows(ValveRows):
    """Rows of a gas."""

    kind: ClassVar[str] = "gas"

    def check(self):
        """Raise at once what the equations would raise for want of a datum."""
        gas_flow(1.0, 2e5, 1e5, *self._state_before(), **self.known, warn=False)

    @cached_property
    def temperature(self):
        return self.signal("temperature")

    @cached_property
    def gamma(self):
        return self.setting("gamma", "the ratio of the heat capacities of the gas")

    @cached_property
    def molar_mass(self):
        return self.setting("molar_mass", "the molar mass of the gas [kg/mol]")

    @cached_property
    def xt(self):
        return self._factor("xt")

    @cached_property
    def viscous(self):
        return self._settings.dynamic_viscosity is not None

    @cached_property
    def known(self):
        """Keywords of the gas functions: as much physics as the facts allow."""
        known = {**self._gas(), "xt": self.xt, **self.pipes, **self._viscosity()}
        if self.viscous:
            known |= {name: self._factor(name) for name in ("fl", "fd")}
            known |= {"kv_rated": self._settings.kv_rated}
        return known

    @property
    def linear(self):
        """Whether the flow is proportional to kv."""
        return not self.viscous and not self.pipes

    @cached_property
    def density(self):
        return gas_density(self.upstream, *self._state_before(), self._settings.compressibility)

    @cached_property
    def dynamic_viscosity(self):
        return self.setting("dynamic_viscosity", "the dynamic viscosity of the gas [Pa s]")

    @cached_property
    def kinematic_viscosity(self):
        return self.dynamic_viscosity / self.density

    @cached_property
    def x(self):
        return np.abs(self.dp) / positive(self.upstream)

    @cached_property
    def f_gamma(self):
        return specific_heat_ratio_factor(self.gamma)

    @cached_property
    def xtp(self):
        if not self.pipes:
            return self.xt
        size, warn = self.pipes["nominal_size"], self._settings.warn
        return combined_drop_ratio_factor(self.kv, size, *self.losses, self.xt, warn=warn)

    @cached_property
    def x_choked(self):
        return choked_drop_ratio(self.gamma, self.xtp)

    @cached_property
    def expansion_factor(self):
        return expansion_factor(self.x, self.x_choked)

    @cached_property
    def dp_choked(self):
        return self.x_choked * self.upstream

    @cached_property
    def choked(self):
        return np.where(np.isnan(self.x) | np.isnan(self.x_choked), np.nan, self.x >= self.x_choked)

    @cached_property
    def state(self):
        return self._state(self.kv, self.signal("p2"))

    @cached_property
    def mass_flow(self):
        known = self._settings
        return gas_mass_flow(
            self.flow, known.basis, self.upstream, *self._state_before(), known.compressibility
        )

    @cached_property
    def reynolds(self):
        size = self.setting("nominal_size", "the bore of the valve's ends [m]")
        first, second = (self.pipes.get(name, size) for name in ("inlet_pipe", "outlet_pipe"))
        pipe = np.where(self.backward, second, first)
        known = {"fl": self.fl, "fd": self.fd, "inlet_pipe": pipe}
        # mass flow over dynamic viscosity is volume flow over kinematic viscosity
        return valve_reynolds_number(self.mass_flow, self.kv, self.dynamic_viscosity, **known)

    @cached_property
    def fr(self):
        known = self._settings
        size = self.setting("nominal_size", "the bore of the valve's ends [m]")
        return reynolds_factor(self.reynolds, trim_parameter(self.kv, size, kv_rated=known.kv_rated), self.fl)

    @cached_property
    def required_opening(self):
        known = self._settings
        facts = {**self._gas(), **self.pipes, **self._viscosity(), "xt": known.xt}
        if self.viscous:
            facts |= {"fl": known.fl, "fd": known.fd}
        flow, p1, p2 = (self.signal(role) for role in ("flow", "p1", "p2"))
        return opening_for_gas_flow(flow, p1, p2, *self._state_before(), **facts, **self.trim_settings)

    def flow_through(self, kv):
        """Flow through the flow coefficients `kv` between the measured pressures."""
        return self._with(gas_flow, kv, self.signal("p1"), self.signal("p2"))

    def outlet_pressure_behind(self, kv):
        """Pressure behind the flow coefficients `kv` at the measured flow and inlet pressure."""
        return self._with(gas_outlet_pressure, self.signal("flow"), kv, self.signal("p1"))

    def inlet_pressure_before(self, kv):
        """Pressure before the flow coefficients `kv` at the measured flow and outlet pressure."""
        return self._with(gas_inlet_pressure, self.signal("flow"), kv, self.signal("p2"))

    def kv_for(self, flow, p1, p2):
        """Flow coefficients that pass a flow between two pressures."""
        return self._with(gas_kv, flow, p1, p2)

    def determined(self, kv, p1, p2):
        """Where p2 follows from flow and kv: not where lower pressures give the same flow."""
        return (self._state(kv, p2) != _CHOKED) | (p2 > p1)

    def _with(self, function, *given):
        return function(*given, *self._state_before(), **self.known, warn=self._settings.warn)

    def _state_before(self):
        return self.temperature, self.molar_mass

    def _state(self, kv, p2):
        known = {name: value for name, value in self.known.items() if name != "basis"}
        return gas_state(kv, self.signal("p1"), p2, *self._state_before(), **known)

    def _gas(self):
        known = self._settings
        return {"gamma": self.gamma, "compressibility": known.compressibility, "basis": known.basis}

    def _viscosity(self):
        if not self.viscous:
            return {}
        size = self.setting("nominal_size", "the bore of the valve's ends [m]")
        return {"dynamic_viscosity": self.dynamic_viscosity, "nominal_size": size}
