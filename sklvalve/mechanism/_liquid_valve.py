# SPDX-License-Identifier: BSD-3-Clause
"""What the liquid functions may know of a valve beyond its capacity: recovery, pipes, viscosity."""

from dataclasses import dataclass, fields, replace

import numpy as np

from sklvalve.mechanism._constants import TURBULENT_REYNOLDS, WIDEST, capacity_over_bore
from sklvalve.mechanism._liquid_inputs import positive
from sklvalve.mechanism.piping import combined_recovery_factor, fitting_loss, piping_factor
from sklvalve.mechanism.trim import trim_parameter
from sklvalve.mechanism.validity import warn_rows
from sklvalve.mechanism.viscosity import (
    nonturbulent_flow_ratio,
    reynolds_factor,
    valve_reynolds_number,
)


@dataclass(frozen=True)
class LiquidValve:
    """Data of a valve and its liquid, each a number, an array or None; what is not positive becomes NaN."""

    fl: object = None
    viscosity: object = None
    fd: object = None
    kv_rated: object = None
    nominal_size: object = None
    inlet_pipe: object = None
    outlet_pipe: object = None
    strict: bool = False

    def __post_init__(self):
        nonsense = {}
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None and field.name != "strict":
                value = np.asarray(value, dtype=float)
                nonsense[field.name] = value <= 0.0
                object.__setattr__(self, field.name, positive(value))
        object.__setattr__(self, "_nonsense", nonsense)
        if self.nominal_size is None and self.piped:
            raise ValueError(
                "a pipe is given without nominal_size: reducers need the bore of the valve's ends [m]."
            )
        missing = [name for name in ("fl", "fd", "nominal_size") if getattr(self, name) is None]
        if self.viscous and missing:
            raise ValueError(
                f"viscosity is given without {' and '.join(missing)}: the valve Reynolds number needs them; "
                f"give them or leave viscosity out."
            )

    @property
    def piped(self):
        return self.inlet_pipe is not None or self.outlet_pipe is not None

    @property
    def viscous(self):
        return self.viscosity is not None

    @property
    def extended(self):
        return self.piped or self.viscous

    @property
    def senseless(self):
        """Rows in which a datum that is used cannot be; a viscosity that cannot be is told by itself."""
        rows = False
        for name in self._used():
            if name != "viscosity":
                rows = rows | self._nonsense[name]
        return rows

    def given(self):
        """What is given, by name."""
        return {
            field.name: getattr(self, field.name)
            for field in fields(self)
            if field.name != "strict" and getattr(self, field.name) is not None
        }

    def turned(self):
        """The same valve seen from its outlet."""
        return replace(self, inlet_pipe=self.outlet_pipe, outlet_pipe=self.inlet_pipe)

    def losses(self, backward):
        """Loss coefficients of the reducers in the direction of the flow: their sum and the inlet's part."""
        return fitting_loss(
            self.nominal_size, self._pipe_before(backward), self._pipe_before(np.logical_not(backward))
        )

    def with_pipes(self, kv, backward):
        """Capacity and recovery factor between the pipes, from those of the valve alone."""
        if not self.piped:
            return kv, self.fl
        zeta_sum, zeta_inlet = self.losses(backward)
        fp = piping_factor(kv, self.nominal_size, zeta_sum, warn=False)
        if self.fl is None:
            return kv * fp, None
        return kv * fp, combined_recovery_factor(kv, self.nominal_size, zeta_inlet, self.fl) / fp

    def reynolds(self, flow, kv, backward):
        pipe = self._pipe_before(backward)
        return valve_reynolds_number(flow, kv, self.viscosity, fl=self.fl, fd=self.fd, inlet_pipe=pipe)

    def trim(self, kv):
        return trim_parameter(kv, self.nominal_size, kv_rated=self.kv_rated, strict=self.strict)

    def factor(self, reynolds, kv):
        """Reynolds factor at the actual flow."""
        return reynolds_factor(reynolds, self.trim(kv), self.fl, strict=self.strict)

    def ratio(self, reynolds_turbulent, kv):
        """Reynolds factor from the turbulent flow."""
        return nonturbulent_flow_ratio(reynolds_turbulent, self.trim(kv), self.fl, strict=self.strict)

    def slowed(self, turbulent, kv, backward):
        """Flow that viscosity leaves of the turbulent one, which `turbulent` gives from kv and fl."""
        flow = turbulent(*self.with_pipes(kv, backward))
        if not self.viscous:
            return flow
        if self.strict and self.piped:
            # annex A knows no reducers: F_P comes in with a jump where the flow turns turbulent
            fast = self.reynolds(flow, kv, backward) >= TURBULENT_REYNOLDS
            bare = turbulent(kv, self.fl)
            slow = bare * self.ratio(self.reynolds(bare, kv, backward), kv)
            return np.where(flow == 0.0, flow, np.where(fast | np.isnan(flow), flow, slow))[()]
        ratio = self.ratio(self.reynolds(flow, kv, backward), kv)
        return np.where(flow == 0.0, flow, flow * ratio)[()]

    def recovery_in(self, turbulent, kv, backward):
        """Recovery factor that limits the flow of `slowed`."""
        capacity, fl = self.with_pipes(kv, backward)
        if not (self.viscous and self.strict and self.piped):
            return fl
        flow = turbulent(capacity, fl)
        fast = self.reynolds(flow, kv, backward) >= TURBULENT_REYNOLDS
        return np.where(fast | np.isnan(flow), fl, self.fl)[()]

    def as_turbulent(self, flow, kv, backward):
        """The turbulent flow with the same pressures as `flow`, and capacity and recovery factor for it."""
        if not self.viscous:
            return flow, *self.with_pipes(kv, backward)
        reynolds = self.reynolds(flow, kv, backward)
        with np.errstate(invalid="ignore", divide="ignore"):
            turbulent = np.where(flow == 0.0, flow, flow / self.factor(reynolds, kv))[()]
        capacity, fl = self.with_pipes(kv, backward)
        if self.strict and self.piped:
            fast = reynolds >= TURBULENT_REYNOLDS
            capacity, fl = np.where(fast, capacity, kv)[()], np.where(fast, fl, self.fl)[()]
        return turbulent, capacity, fl

    def known(self):
        """Rows in which no datum is missing or senseless."""
        rows = True
        for value in self._used().values():
            rows = rows & np.isfinite(value)
        return rows

    def warn(self, kv, where, *, stacklevel=4):
        """Say which rows leave what the standard was fitted to."""
        if not self.extended:
            return
        limit = WIDEST
        wide = np.abs(capacity_over_bore(kv, self.nominal_size)) > limit
        warn_rows(
            wide,
            where,
            "have a kv beyond 0.047 N18 d2: outside the accuracy of the standard.",
            stacklevel=stacklevel,
        )
        if self.viscous:
            bad = self._nonsense["viscosity"]
            warn_rows(
                bad, where, "have a viscosity that is not positive and give NaN.", stacklevel=stacklevel
            )

    def _used(self):
        """What is given and enters the flow, by name."""
        needless = set() if self.viscous else {"fd", "kv_rated"}
        if not self.extended:
            needless.add("nominal_size")
        return {name: value for name, value in self.given().items() if name not in needless}

    def _pipe_before(self, backward):
        near = self.nominal_size if self.inlet_pipe is None else self.inlet_pipe
        far = self.nominal_size if self.outlet_pipe is None else self.outlet_pipe
        return near if near is far else np.where(backward, far, near)[()]
