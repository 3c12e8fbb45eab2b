# SPDX-License-Identifier: BSD-3-Clause
"""The physical features that `ValveMechanismTransformer` can give out, one line of physics each."""

from functools import cached_property

import numpy as np

from sklvalve.mechanism.characteristic import relative_capacity
from sklvalve.mechanism.liquid import (
    choked_pressure_drop,
    critical_pressure_ratio_factor,
    liquid_flow,
)
from sklvalve.mechanism.liquid_pressure import liquid_outlet_pressure
from sklvalve.mechanism.orifice import vena_contracta_pressure
from sklvalve.mechanism.travel import at_travel
from sklvalve.mechanism.validity import MissingDatum


class ValveRows:
    """The rows of one matrix as a valve sees them: signals by role, properties worked out at first use."""

    def __init__(self, signals, settings, fluid):
        self._signals = signals
        self._settings = settings
        self._fluid = fluid

    def signal(self, role):
        """Measured signal of a role; MissingDatum with the mend where the role has no column."""
        values = self._signals.get(role)
        if values is None:
            raise MissingDatum(
                f"this needs the role {role!r}, which has no column: set {role}= to a name or position."
            )
        return values

    def can_give(self, name):
        """Whether the roles, the valve and the fluid suffice for a feature."""
        try:
            getattr(self, name)
        except MissingDatum:
            return False
        return True

    @cached_property
    def opening(self):
        return self.signal("opening")

    @cached_property
    def dp(self):
        return self.signal("p1") - self.signal("p2")

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
    def fl(self):
        fl = self._settings.fl
        if fl is None:
            raise MissingDatum("this needs the pressure recovery factor of the valve: give fl=...")
        return at_travel(fl, None if np.ndim(fl) == 0 else self.opening)

    @cached_property
    def choking(self):
        """What the liquid functions need to know of choking: nothing where the valve has no fl."""
        if self._settings.fl is None:
            return {}
        return {"fl": self.fl, "p_vapour": self.vapour_pressure, "p_critical": self.critical_pressure}

    @cached_property
    def dp_choked(self):
        upstream = np.maximum(self.signal("p1"), self.signal("p2"))
        return choked_pressure_drop(upstream, self.vapour_pressure, self.critical_pressure, self.fl)

    @cached_property
    def ff(self):
        return critical_pressure_ratio_factor(self.vapour_pressure, self.critical_pressure)

    @cached_property
    def pressure_ratio(self):
        upstream = np.maximum(self.signal("p1"), self.signal("p2"))
        above_boiling = upstream - self.ff * self.vapour_pressure
        return self.dp / np.where(above_boiling > 0.0, above_boiling, np.nan)

    @cached_property
    def choked(self):
        state = np.abs(self.dp) >= self.dp_choked
        return np.where(np.isnan(self.dp) | np.isnan(self.dp_choked), np.nan, state)

    @cached_property
    def sqrt_dp_over_density(self):
        return np.copysign(np.sqrt(np.abs(self.dp) / self.density), self.dp)

    @cached_property
    def p_vc(self):
        choking = {"p_vapour": self.vapour_pressure, "p_critical": self.critical_pressure}
        return vena_contracta_pressure(self.signal("p1"), self.signal("p2"), self.fl, **choking)

    @cached_property
    def relative_capacity(self):
        known = self._settings
        return relative_capacity(
            self.opening,
            known.characteristic,
            rangeability=known.rangeability,
            shutoff=known.shutoff,
            warn=known.warn,
        )

    @cached_property
    def kv(self):
        if self._settings.kv_rated is None:
            raise MissingDatum(
                "this needs the rated flow coefficient of the valve: give kv_rated=... [m3/h]."
            )
        return self._settings.kv_rated * self.relative_capacity

    @cached_property
    def flow(self):
        return self.flow_through(self.kv)

    @cached_property
    def outlet_pressure(self):
        return self.outlet_pressure_behind(self.kv)

    def flow_through(self, kv):
        """Flow through the flow coefficients `kv` between the measured pressures."""
        known = self._settings
        return liquid_flow(
            kv, self.signal("p1"), self.signal("p2"), self.density, warn=known.warn, **self.choking
        )

    def outlet_pressure_behind(self, kv):
        """Pressure behind the flow coefficients `kv` at the measured flow and inlet pressure."""
        known = self._settings
        return liquid_outlet_pressure(
            self.signal("flow"), kv, self.signal("p1"), self.density, warn=known.warn, **self.choking
        )


FEATURES = {
    "opening": "relative travel [1]",
    "dp": "pressure drop p1 - p2 [Pa]",
    "sqrt_dp_over_density": "signed root of pressure drop over density [m/s]",
    "pressure_ratio": "pressure drop over p1 - F_F p_v; choking sets in at F_L squared [1]",
    "dp_choked": "pressure drop at the onset of choking [Pa]",
    "choked": "1 where the flow is choked, else 0 [1]",
    "ff": "critical pressure ratio factor [1]",
    "p_vc": "pressure at the vena contracta [Pa]",
    "density": "density of the liquid [kg/m3]",
    "vapour_pressure": "vapour pressure of the liquid [Pa]",
    "kinematic_viscosity": "kinematic viscosity of the liquid [m2/s]",
    "relative_capacity": "kv over kv_rated by the characteristic [1]",
    "kv": "flow coefficient by the characteristic [m3/h]",
    "flow": "flow by the mechanism from the pressures [m3/s]",
    "outlet_pressure": "outlet pressure by the mechanism from the flow [Pa]",
}
"""Every feature by name: each is an attribute of `ValveRows`."""

DEFAULT_FEATURES = (
    "relative_capacity",
    "dp",
    "sqrt_dp_over_density",
    "pressure_ratio",
    "density",
    "vapour_pressure",
)
"""The features that need no datum of the valve but its characteristic."""


def compute_features(rows, names, n_rows):
    """Matrix of shape (n_rows, n_names) of the named features."""
    out = np.empty((n_rows, len(names)))
    for column, name in enumerate(names):
        # a constant fluid gives one number for all rows
        out[:, column] = getattr(rows, name)
    return out
