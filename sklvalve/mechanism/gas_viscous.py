# SPDX-License-Identifier: BSD-3-Clause
"""Private: gas so viscous or so little of it that the flow in the valve is not turbulent.

IEC 60534-2-1, annex A, is not clear here, and its public transcriptions disagree. What is taken: the
turbulent form with the Reynolds factor at the *actual* flow, and between Re_v = 1000 and 10 000 a blend of
the turbulent sqrt(x) Y with the laminar sqrt(x (1 - x/2)), whose square is proportional to the difference of
the squared pressures. The laminar part does not choke. So the flow is continuous in everything, and smooth at
choking.
"""

from dataclasses import dataclass, fields, replace

import numpy as np

from sklvalve.mechanism._constants import TURBULENT_REYNOLDS
from sklvalve.mechanism.gas_data import sensible
from sklvalve.mechanism.gas_inputs import drop_ratio, throughput
from sklvalve.mechanism.gas_roots import root_between
from sklvalve.mechanism.gas_sizing import capacity_between_reducers
from sklvalve.mechanism.viscosity import (
    full_size_kv,
    nonturbulent_flow_ratio,
    reynolds_factor,
    trim_parameter,
    valve_reynolds_number,
)

# between these Reynolds numbers the laminar form of the flow gives way to the turbulent one
BLEND_START, BLEND_END = 1e3, TURBULENT_REYNOLDS
_SHORT_STEP, _LONG_STEP, _STEPS = 0.5 * np.log(2.0), np.log(16.0), 120
_HAIR = 1e-14
_SOLVED = 1e-11


@dataclass(frozen=True)
class Jet:
    """What the Reynolds number of a valve needs besides flow and kv."""

    viscosity: np.ndarray
    fl: np.ndarray
    fd: np.ndarray
    size: np.ndarray
    pipe: np.ndarray
    kv_rated: np.ndarray | None

    def reynolds(self, mass, kv):
        # mass flow over dynamic viscosity is volume flow over kinematic viscosity
        return valve_reynolds_number(mass, kv, self.viscosity, fl=self.fl, fd=self.fd, inlet_pipe=self.pipe)

    def factor(self, reynolds, kv):
        return reynolds_factor(reynolds, self.trim(kv), self.fl)

    def trim(self, kv):
        return trim_parameter(kv, self.size, kv_rated=self.kv_rated)


def jet_of(dynamic_viscosity, fl, fd, kv_rated, backward, nominal_size, inlet_pipe, outlet_pipe):
    if dynamic_viscosity is None:
        return None
    if fl is None or fd is None or nominal_size is None:
        raise ValueError(
            "dynamic_viscosity is given: flow that is not turbulent needs fl, fd and nominal_size too."
        )
    first = nominal_size if inlet_pipe is None else inlet_pipe
    second = nominal_size if outlet_pipe is None else outlet_pipe
    pipe = sensible(np.where(backward, second, first))
    kv_rated = None if kv_rated is None else sensible(kv_rated)
    return Jet(
        sensible(dynamic_viscosity), sensible(fl), sensible(fd), sensible(nominal_size), pipe, kv_rated
    )


def blended_throughput(x, x_choked, reynolds):
    """sqrt(x) Y over all regimes: rises with x, and falls as the jet turns turbulent."""
    turbulent = np.clip((reynolds - BLEND_START) / (BLEND_END - BLEND_START), 0.0, 1.0)
    return turbulent * throughput(x, x_choked) + (1.0 - turbulent) * np.sqrt(x * (1.0 - 0.5 * x))


def viscous_mass(kv, x, unit, valve, jet):
    """Mass flow, not negative, of a valve with kv >= 0; `unit` is pressure upstream times `unit_speed`."""
    capacity, x_choked = valve.at(kv)
    base = capacity * unit
    per_mass = jet.reynolds(1.0, kv)
    trim = jet.trim(kv)

    def settled(through):
        return base * through * nonturbulent_flow_ratio(per_mass * base * through, trim, jet.fl)

    turbulent = settled(throughput(x, x_choked))
    laminar = settled(np.sqrt(x * (1.0 - 0.5 * x)))
    # without gamma and x_T nobody knows that the flow is laminar
    laminar = np.where(np.isnan(x_choked), np.nan, laminar)
    mass = np.where(per_mass * turbulent >= BLEND_END, turbulent, laminar)
    between = np.flatnonzero((per_mass * turbulent < BLEND_END) & (per_mass * laminar > BLEND_START))
    if between.size:
        shape = np.shape(mass)
        rows = (base, per_mass, trim, x, x_choked, jet.fl)
        most, per, n, ratio, choked, fl = (np.broadcast_to(row, shape).ravel()[between] for row in rows)

        def surplus(log):
            re = np.exp(log)
            return log - np.log(
                per * most * blended_throughput(ratio, choked, re) * reynolds_factor(re, n, fl)
            )

        mass = mass.ravel()
        mass[between] = (
            np.exp(root_between(surplus, np.log(BLEND_START), np.full(len(between), np.log(BLEND_END)))) / per
        )
        mass = mass.reshape(shape)
    return np.where(kv == 0.0, 0.0 * unit * x, mass)[()]


def is_turbulent(mass, kv, jet):
    """Whether a mass flow feels nothing of the viscosity."""
    reynolds = jet.reynolds(mass, kv)
    return (mass == 0.0) | ((reynolds >= BLEND_END) & (jet.factor(reynolds, kv) == 1.0))


def viscous_drop_ratio(mass, kv, unit, valve, jet):
    """x at which a mass flow goes through, the pressure upstream being known; NaN where none passes it."""
    capacity, x_choked = valve.at(kv)
    reynolds = jet.reynolds(mass, kv)
    wanted = np.where(mass == 0.0, 0.0, mass / (capacity * unit * jet.factor(reynolds, kv)))
    root = root_between(
        lambda s: blended_throughput(s * s, x_choked, reynolds) - wanted, 0.0 * wanted, 1.0 + 0.0 * wanted
    )
    return np.where(reynolds >= BLEND_END, drop_ratio(wanted, x_choked), root * root)[()]


def viscous_pressure_before(mass, kv, behind, speed, valve, jet):
    """Pressure upstream at which a mass flow goes through, the pressure behind being known."""
    capacity, x_choked = valve.at(kv)
    reynolds = jet.reynolds(mass, kv)
    demand = np.where(mass == 0.0, 0.0, mass / (capacity * speed * jet.factor(reynolds, kv)))
    # without any pressure behind; the true one is higher by less than that pressure over the drop ratio
    least = demand / blended_throughput(1.0, x_choked, reynolds)
    low, high = np.maximum(least * (1.0 - _SOLVED), behind), least * (1.0 + _SOLVED) + behind

    def surplus(p):
        x = np.where(p > 0.0, (p - behind) / p, 0.0)
        return p * blended_throughput(x, x_choked, reynolds) - demand

    return root_between(surplus, low, high)


def viscous_capacity(mass, x, unit, valve, jet):
    """kv that passes a mass flow; NaN where none does or none was found."""
    kv = capacity_between_reducers(mass / unit, x, valve)
    # most gas is turbulent, and then this is the answer; NaN there does not mean that there is none
    settled = is_turbulent(mass, kv, jet)
    shape = np.broadcast_shapes(np.shape(settled), np.shape(x))
    rows = np.flatnonzero(~np.broadcast_to(settled, shape))
    found = np.array(np.broadcast_to(kv, shape)).ravel()
    few = [np.broadcast_to(part, shape).ravel()[rows] for part in (mass, x, unit)]
    found[rows] = _searched_capacity(*few, _rows_of(valve, shape, rows), _rows_of(jet, shape, rows))
    return found.reshape(shape)[()]


def _rows_of(parts, shape, rows):
    """The same valve or jet for some rows of a shape that all its parts broadcast to."""
    named = {field.name: getattr(parts, field.name) for field in fields(parts)}
    return replace(
        parts,
        **{
            name: None if part is None else np.broadcast_to(part, shape).ravel()[rows]
            for name, part in named.items()
        },
    )


def _searched_capacity(mass, x, unit, valve, jet):
    start = np.where(mass > 0.0, mass / (unit * np.sqrt(x * (1.0 - 0.5 * x))), np.nan)

    def surplus(log):
        kv = np.exp(log)
        capacity, x_choked = valve.at(kv)
        reynolds = jet.reynolds(mass, kv)
        through = blended_throughput(x, x_choked, reynolds) * jet.factor(reynolds, kv)
        excess = np.log(capacity * unit * through / mass)
        # beyond the size that the reducers allow
        return np.where(np.isnan(capacity) & ~np.isnan(valve.fittings + valve.inlet), np.inf, excess)

    low = np.log(start)
    floor, limit = np.full_like(low, -np.inf), np.full_like(low, np.inf)
    if jet.kv_rated is None:
        # at this kv the kind of trim changes and the flow jumps: look on one side, then on the other
        flip = np.log(full_size_kv(jet.size)) + 0.0 * low
        reduced = surplus(flip - _HAIR) >= 0.0
        floor, limit = np.where(reduced, -np.inf, flip), np.where(reduced, flip - _HAIR, np.inf)
        low = np.clip(low, floor, limit)
    for _ in range(_STEPS):
        over = (surplus(low) > 0.0) & (low > floor)
        if not np.any(over):
            break
        low = np.where(over, np.maximum(low - _LONG_STEP, floor), low)
    high = low
    # without a rated kv, or far beyond the bore of reducers, the flow falls again as kv rises: short steps
    falls_again = jet.kv_rated is None or np.any(valve.fittings != 0.0)
    step = _SHORT_STEP if falls_again else _LONG_STEP
    for _ in range(_STEPS):
        short = (surplus(high) < 0.0) & (high < limit)
        if not np.any(short):
            break
        low, high = np.where(short, high, low), np.where(short, np.minimum(high + step, limit), high)
    log = root_between(surplus, low, high)
    found = np.abs(surplus(log)) <= _SOLVED
    return np.where(found, np.exp(log), np.nan)
