# SPDX-License-Identifier: BSD-3-Clause
"""Private: the rows of one matrix as a valve in liquid service sees them."""

from functools import cached_property
from typing import ClassVar

import numpy as np

from sklvalve.mechanism._liquid_inputs import BOILS
from sklvalve.mechanism._liquid_valve import LiquidValve
from sklvalve.mechanism._rows import ValveRows
from sklvalve.mechanism.cavitation import cavitation_index, incipient_xfz, pressure_ratio_xf
from sklvalve.mechanism.choking import choked_pressure_drop, critical_pressure_ratio_factor
from sklvalve.mechanism.liquid import liquid_flow, liquid_kv
from sklvalve.mechanism.liquid_pressure import liquid_inlet_pressure, liquid_outlet_pressure
from sklvalve.mechanism.opening import opening_for_flow
from sklvalve.mechanism.orifice import vena_contracta_pressure
from sklvalve.mechanism.states import liquid_state
from sklvalve.mechanism.travel import at_travel
from sklvalve.mechanism.validity import MissingDatum, warn_rows


class LiquidRows(ValveRows):
    """Rows of a liquid: more facts about valve and fluid, more physics."""

    kind: ClassVar[str] = "liquid"

    def check(self):
        """Raise at once what the equations would raise for want of a datum."""
        _ = self._valve, self.known

    @cached_property
    def density(self):
        return self._fluid.density(self._signals.get("temperature"), warn=self._settings.warn)

    @cached_property
    def vapour_pressure(self):
        return self._fluid.vapour_pressure(self._signals.get("temperature"), warn=self._settings.warn)

    @cached_property
    def kinematic_viscosity(self):
        return self._fluid.kinematic_viscosity(self._signals.get("temperature"), warn=self._settings.warn)

    @cached_property
    def critical_pressure(self):
        if self._fluid.critical_pressure is None:
            raise MissingDatum(
                f"the fluid {self._fluid.name!r} has no critical_pressure: give critical_pressure=... [Pa]."
            )
        return self._fluid.critical_pressure

    @cached_property
    def viscous(self):
        """Whether all that the Reynolds number needs is there, so that flow need not be turbulent."""
        known = self._settings
        given = known.fl is not None and known.fd is not None and known.nominal_size is not None
        return given and self._fluid.knows("kinematic_viscosity")

    @cached_property
    def choking(self):
        """What the liquid functions need to know of choking: nothing where the valve has no fl."""
        if self._settings.fl is None or (self.viscous and not self._fluid.knows("vapour_pressure")):
            return {}
        return {"fl": self.fl, **self.boiling}

    @cached_property
    def boiling(self):
        return {"p_vapour": self.vapour_pressure, "p_critical": self.critical_pressure}

    @cached_property
    def known(self):
        """Keywords of the liquid functions: as much physics as the facts allow."""
        known = {**self.choking, **self.pipes}
        if self.viscous:
            known |= {"fl": self.fl, "fd": self.fd, "viscosity": self.kinematic_viscosity}
            known |= {name: getattr(self._settings, name) for name in ("kv_rated", "nominal_size")}
        if not self.linear:
            known |= {"strict": self._settings.strict}
        return known

    @property
    def linear(self):
        """Whether the flow is proportional to kv."""
        return not self.viscous and not self.pipes

    @cached_property
    def _valve(self):
        facts = dict(self.pipes)
        if self.viscous:
            facts |= {"fl": self.fl, "fd": self.fd, "viscosity": self.kinematic_viscosity}
            facts |= {name: getattr(self._settings, name) for name in ("kv_rated", "nominal_size")}
        elif self._settings.fl is not None:
            facts |= {"fl": self.fl}
        return LiquidValve(**facts, strict=self._settings.strict)

    def _onset(self, kv):
        """Pressure drop at which choking begins behind a capacity that only reducers make matter."""
        recovery = (
            self._valve.with_pipes(np.asarray(kv(), dtype=float), self.backward)[1] if self.pipes else self.fl
        )
        return choked_pressure_drop(self.upstream, self.vapour_pressure, self.critical_pressure, recovery)

    @cached_property
    def dp_choked(self):
        _ = self.fl
        return self._onset(lambda: self.kv)

    @cached_property
    def ff(self):
        return critical_pressure_ratio_factor(self.vapour_pressure, self.critical_pressure)

    @cached_property
    def pressure_ratio(self):
        above_boiling = self.upstream - self.ff * self.vapour_pressure
        if self._settings.warn:
            warn_rows(self.upstream <= self.vapour_pressure, "pressure_ratio", BOILS)
        return self.dp / np.where(above_boiling > 0.0, above_boiling, np.nan)

    @cached_property
    def choked(self):
        state = np.abs(self.dp) >= self.dp_choked
        return np.where(np.isnan(self.dp) | np.isnan(self.dp_choked), np.nan, state)

    @cached_property
    def p_vc(self):
        pipes = {"kv": self.kv, **self.pipes} if self.pipes else {}
        known = {**self.boiling, **pipes, "warn": self._settings.warn}
        return vena_contracta_pressure(self.signal("p1"), self.signal("p2"), self.fl, **known)

    @cached_property
    def sigma(self):
        pressures = self.signal("p1"), self.signal("p2"), self.vapour_pressure
        return cavitation_index(*pressures, warn=self._settings.warn)

    @cached_property
    def xf(self):
        pressures = self.signal("p1"), self.signal("p2"), self.vapour_pressure
        return pressure_ratio_xf(*pressures, warn=self._settings.warn)

    @cached_property
    def xfz(self):
        measured = self._settings.xfz
        if measured is None:
            return incipient_xfz(np.abs(self.kv), self.fl, self.fd, p1=self.upstream)
        return at_travel(measured, None if np.ndim(measured) == 0 else self.opening)

    @cached_property
    def state(self):
        known = dict(self.known)
        if self._fluid.knows("vapour_pressure") and self._fluid.critical_pressure is not None:
            known |= self.boiling
        if "p_vapour" in known and self.can_give("xfz"):
            known["xfz"] = self.xfz
        return liquid_state(self.kv, self.signal("p1"), self.signal("p2"), self.density, **known)

    @cached_property
    def mass_flow(self):
        return self.flow * self.density

    @cached_property
    def reynolds(self):
        self._need_viscosity()
        return self._valve.reynolds(self.flow, self.kv, self.backward)

    @cached_property
    def fr(self):
        self._need_viscosity()
        return self._valve.factor(self.reynolds, self.kv)

    @cached_property
    def required_opening(self):
        known = {name: value for name, value in self.known.items() if name != "kv_rated"}
        # the opening is what is wanted: factors go in as tables
        known |= {name: getattr(self._settings, name) for name in ("fl", "fd") if name in known}
        flow, p1, p2 = (self.signal(role) for role in ("flow", "p1", "p2"))
        return opening_for_flow(flow, p1, p2, self.density, **known, **self.trim_settings)

    def flow_through(self, kv):
        """Flow through the flow coefficients `kv` between the measured pressures."""
        p1, p2 = self.signal("p1"), self.signal("p2")
        return liquid_flow(kv, p1, p2, self.density, warn=self._settings.warn, **self.known)

    def outlet_pressure_behind(self, kv):
        """Pressure behind the flow coefficients `kv` at the measured flow and inlet pressure."""
        flow, p1 = self.signal("flow"), self.signal("p1")
        return liquid_outlet_pressure(flow, kv, p1, self.density, warn=self._settings.warn, **self.known)

    def inlet_pressure_before(self, kv):
        """Pressure before the flow coefficients `kv` at the measured flow and outlet pressure."""
        flow, p2 = self.signal("flow"), self.signal("p2")
        return liquid_inlet_pressure(flow, kv, p2, self.density, warn=self._settings.warn, **self.known)

    def kv_for(self, flow, p1, p2):
        """Flow coefficients that pass a flow between two pressures."""
        return liquid_kv(flow, p1, p2, self.density, warn=self._settings.warn, **self.known)

    def determined(self, kv, p1, p2):
        """Where p2 follows from flow and kv: not where lower pressures give the same flow."""
        if not self.choking:
            return np.isfinite(kv)
        recovery = self._valve.with_pipes(np.asarray(kv, dtype=float), p2 > p1)[1] if self.pipes else self.fl
        return p1 - p2 < choked_pressure_drop(p1, self.vapour_pressure, self.critical_pressure, recovery)

    def outlet_pressure_slope(self, kv):
        if not self.linear:
            return super().outlet_pressure_slope(kv)
        p1, flow = self.signal("p1"), self.signal("flow")
        p2 = self.outlet_pressure_behind(kv)
        # p2 differs from a pressure that kv does not move by a drop that falls with the square of kv
        anchor = p1
        if self.choking:
            turbulent = liquid_kv(flow, p1, p2, self.density, warn=False)
            choked_backward = (flow < 0.0) & (turbulent < kv * (1.0 - 1e-9))
            anchor = np.where(choked_backward, self.ff * self.vapour_pressure, p1)
        return 2.0 * (anchor - p2) / kv

    def _need_viscosity(self):
        _ = self.kinematic_viscosity, self.fl, self.fd
        self.setting("nominal_size", "the bore of the valve's ends [m]")
