# SPDX-License-Identifier: BSD-3-Clause
"""Private: the rows of one matrix as a valve sees them, whatever flows through it."""

from functools import cached_property

import numpy as np

from sklvalve.mechanism.characteristic import relative_capacity
from sklvalve.mechanism.piping import combined_recovery_factor, fitting_loss, piping_factor
from sklvalve.mechanism.travel import at_travel
from sklvalve.mechanism.validity import MissingDatum

_STEP = 1e-5
_FACTORS = {
    "fl": "the pressure recovery factor of the valve",
    "fd": "the valve style modifier",
    "xt": "the pressure drop ratio factor of the valve",
}


class ValveRows:
    """Signals by role and what follows from them, worked out at first use; a feature is an attribute.

    What depends on the fluid is in `LiquidRows` and `GasRows`: `flow_through`, `outlet_pressure_behind`,
    `inlet_pressure_before`, `kv_for`, `determined` and `linear`.
    """

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

    def setting(self, name, what):
        """Parameter of the transformer; MissingDatum where it is not given."""
        value = getattr(self._settings, name)
        if value is None:
            raise MissingDatum(f"this needs {what}: give {name}=...")
        return value

    def feature(self, name):
        """Values of a feature; MissingDatum where it belongs to another kind of fluid."""
        if not hasattr(type(self), name):
            raise MissingDatum(f"there is no {name!r} of a {self.kind}: leave it out, or set fluid=...")
        return getattr(self, name)

    def can_give(self, name):
        """Whether the roles, the valve and the fluid suffice for a feature."""
        try:
            self.feature(name)
        except MissingDatum:
            return False
        return True

    def _factor(self, name):
        factor = self.setting(name, _FACTORS[name])
        return at_travel(factor, None if np.ndim(factor) == 0 else self.opening)

    @cached_property
    def opening(self):
        return self.signal("opening")

    @cached_property
    def dp(self):
        return self.signal("p1") - self.signal("p2")

    @cached_property
    def backward(self):
        return self.dp < 0.0

    @cached_property
    def upstream(self):
        return np.maximum(self.signal("p1"), self.signal("p2"))

    @cached_property
    def sqrt_dp_over_density(self):
        return np.copysign(np.sqrt(np.abs(self.dp) / self.density), self.dp)

    @cached_property
    def fl(self):
        return self._factor("fl")

    @cached_property
    def fd(self):
        return self._factor("fd")

    @cached_property
    def relative_capacity(self):
        known = self._settings
        return relative_capacity(
            self.opening,
            known.characteristic,
            rangeability=known.rangeability,
            shutoff=known.shutoff,
            leakage=known.leakage,
            warn=known.warn,
        )

    @cached_property
    def kv(self):
        rated = self.setting("kv_rated", "the rated flow coefficient of the valve [m3/h]")
        return rated * self.relative_capacity

    @cached_property
    def pipes(self):
        """Bores that are given, and not one of them where there are no reducers."""
        known = self._settings
        given = {name: getattr(known, name) for name in ("inlet_pipe", "outlet_pipe")}
        given = {name: bore for name, bore in given.items() if bore is not None}
        return {"nominal_size": known.nominal_size, **given} if given else {}

    @cached_property
    def losses(self):
        """Loss coefficients of the reducers in the direction of the flow: their sum and the inlet's part."""
        size = self.setting("nominal_size", "the bore of the valve's ends [m]")
        first, second = (self.pipes.get(name, size) for name in ("inlet_pipe", "outlet_pipe"))
        return fitting_loss(
            size, np.where(self.backward, second, first), np.where(self.backward, first, second)
        )

    @cached_property
    def fp(self):
        if not self.pipes:
            return 1.0
        return piping_factor(self.kv, self.pipes["nominal_size"], self.losses[0], warn=self._settings.warn)

    @cached_property
    def flp(self):
        if not self.pipes:
            return self.fl
        return combined_recovery_factor(self.kv, self.pipes["nominal_size"], self.losses[1], self.fl)

    @cached_property
    def flow(self):
        return self.flow_through(self.kv)

    @cached_property
    def outlet_pressure(self):
        return self.outlet_pressure_behind(self.kv)

    @cached_property
    def inlet_pressure(self):
        return self.inlet_pressure_before(self.kv)

    @cached_property
    def required_kv(self):
        return self.kv_for(self.signal("flow"), self.signal("p1"), self.signal("p2"))

    @cached_property
    def trim_settings(self):
        """What `opening_for_flow` and its like for gas need to know of the trim."""
        known = self._settings
        rated = self.setting("kv_rated", "the rated flow coefficient of the valve [m3/h]")
        names = ("characteristic", "rangeability", "shutoff", "leakage", "warn")
        return {"kv_rated": rated, **{name: getattr(known, name) for name in names}}

    def flow_slope(self, kv):
        """Derivative of the flow by kv."""
        if self.linear:
            return np.where(np.isnan(kv), np.nan, self.flow_through(1.0))
        return _slope(self.flow_through, kv)

    def outlet_pressure_slope(self, kv):
        """Derivative of the outlet pressure by kv, at the measured flow."""
        return _slope(self.outlet_pressure_behind, kv)


def _slope(function, kv):
    step = _STEP * np.where(kv == 0.0, 1.0, np.abs(kv))
    above, below, at = function(kv + step), function(kv - step), function(kv)
    # where less capacity has no answer, or kv is at its end, the slope is that towards more capacity
    one_sided = (above - at) / step
    return np.where(np.isnan(below) | (kv <= step), one_sided, (above - below) / (2.0 * step))
