# SPDX-License-Identifier: BSD-3-Clause
"""Capacity from flow where pipes or viscosity make the capacity enter its own factors."""

from dataclasses import dataclass, replace

import numpy as np

from sklvalve.mechanism._constants import MM, N2, TURBULENT_REYNOLDS, capacity_over_bore
from sklvalve.mechanism._liquid_valve import LiquidValve
from sklvalve.mechanism.trim import full_size_kv, trim_of
from sklvalve.mechanism.viscosity import reynolds_factor

_EPS = np.finfo(float).eps
_GRID = 49
_NEAR = 0.1
_ZOOMS = 4
# the letter has a handful of jumps at most: of the law at two Reynolds numbers, and of the reducers at one
_REJECTIONS = 6
# log of a capacity by which a rejected answer is left behind
_STEP = 1e-9


@dataclass(frozen=True)
class SizingDuty:
    """Flows to be passed, positive, and what a valve of one m3/h would pass at the same pressures.

    ``unit`` is its turbulent flow, ``choked_unit`` its choked one with a recovery factor of 1, or None.
    """

    valve: LiquidValve
    flow: np.ndarray
    unit: np.ndarray
    choked_unit: np.ndarray | None
    backward: np.ndarray

    def turbulent_kv(self, flow, piped=True):
        """Capacity for turbulent or choked flow in closed form; NaN where no capacity passes the flow."""
        piped = piped and self.valve.piped
        gain = choked_gain = 0.0
        if piped:
            zeta_sum, zeta_inlet = self.valve.losses(self.backward)
            per_kv = capacity_over_bore(1.0, self.valve.nominal_size) ** 2 / N2
            gain, choked_gain = zeta_sum * per_kv, zeta_inlet * per_kv
        with np.errstate(invalid="ignore", divide="ignore"):
            kv = _through(flow / self.unit, gain)
            if self.choked_unit is None:
                return kv
            # more than either can pass is more than both; where both pass it, the larger is not contradicted
            fl = self.valve.fl
            return np.maximum(kv, _through(flow / (self.choked_unit * fl), choked_gain * fl * fl))

    def turbulent_flow(self, kv):
        kv, fl = self.valve.with_pipes(kv, self.backward)
        return kv * (self.unit if self.choked_unit is None else np.minimum(self.unit, self.choked_unit * fl))

    def flattened(self):
        """All data as vectors of one length, and the shape they had together."""
        names = list(self.valve.given())
        own = [
            name for name in ("flow", "unit", "choked_unit", "backward") if getattr(self, name) is not None
        ]
        values = [*self.valve.given().values(), *(getattr(self, name) for name in own)]
        values = np.broadcast_arrays(*values)
        shape = values[0].shape
        flat = [np.ravel(value) for value in values]
        valve = replace(self.valve, **dict(zip(names, flat, strict=False)))
        return replace(self, valve=valve, **dict(zip(own, flat[len(names) :], strict=True))), shape

    def rows(self, which):
        own = {name: value[which] for name, value in vars(self).items() if isinstance(value, np.ndarray)}
        of_valve = {name: value[which] for name, value in self.valve.given().items()}
        return replace(self, valve=replace(self.valve, **of_valve), **own)


def required_kv(duty):
    """Capacity that passes ``duty.flow``; NaN where none does."""
    if not duty.valve.viscous:
        return duty.turbulent_kv(duty.flow)
    duty, shape = duty.flattened()
    valve = duty.valve
    kv = duty.turbulent_kv(duty.flow)
    reynolds = valve.reynolds(duty.flow, kv, duty.backward)
    with np.errstate(invalid="ignore"):
        if valve.strict:
            slow = ~(reynolds >= TURBULENT_REYNOLDS)
        else:
            slow = valve.factor(reynolds, kv) < 1.0
    kv = np.where(valve.known(), kv, np.nan)
    slow &= (duty.flow > 0.0) & valve.known()
    if slow.any():
        kv[slow] = _nonturbulent(duty.rows(slow))
    return kv.reshape(shape)[()]


def _nonturbulent(duty):
    """Capacity of rows whose flow is not turbulent.

    At a given flow the capacity needed falls as F_R grows, and F_R depends on the capacity: a root in ln kv,
    bracketed from below by the turbulent capacity. With the trim given once for all there is one root; where
    the capacity itself decides on the trim, or the law jumps, the smallest is taken.
    """
    valve = duty.valve
    piped = valve.piped and not valve.strict
    low = duty.turbulent_kv(duty.flow, piped)
    most = (MM * valve.nominal_size) ** 2  # a bore without any valve in it passes less
    if valve.kv_rated is not None and not valve.strict:
        excess = _excess(duty, piped, valve.trim(low))
        least = valve.factor(valve.reynolds(duty.flow, 1e6 * most, duty.backward), low)
        high = duty.turbulent_kv(duty.flow / least, piped) * (1.0 + 1e-9)
        bracket = np.log(low), np.log(high)
        # between reducers that least factor may ask for too much although the factor of the answer does not
        scanned = _first_bracket(excess, np.log(low), np.log(most)) if np.isnan(high).any() else bracket
        return np.exp(_root(excess, *np.where(np.isnan(high), scanned, bracket))[0])
    flip = full_size_kv(valve.nominal_size)
    if valve.kv_rated is not None:
        trims = [(low, most, valve.kv_rated >= flip)]
    else:
        below = np.nextafter(flip, 0.0)
        trims = [
            (low, below, np.zeros(low.shape, bool)),
            (np.maximum(low, flip), most, np.ones(low.shape, bool)),
        ]
    kv = np.full(low.shape, np.nan)
    for start, end, full in trims:
        kv = np.where(np.isnan(kv), _smallest(duty, piped, full, start, end), kv)
    return kv


def _smallest(duty, piped, full, start, end):
    """Smallest capacity that needs itself; NaN where there is none.

    What looks like an answer and is none, a jump over zero, is left behind: beyond it the excess is negative,
    and the next answer lies where it rises.
    """
    start, end = np.log(start), np.log(end)
    kv = np.full(start.shape, np.nan)
    waiting = np.arange(start.size)
    for _ in range(_REJECTIONS):
        if not waiting.size:
            break
        part = duty.rows(waiting)
        excess = _excess(part, piped, None, full[waiting])
        sign = np.where(excess(start[waiting]) < -_STEP, -1.0, 1.0)

        def towards_zero(log_kv, excess=excess, sign=sign):
            return sign * excess(log_kv)

        low, high = _first_bracket(towards_zero, start[waiting], end[waiting])
        root, behind = _root(towards_zero, low, high)
        found = np.exp(root)
        if duty.valve.strict and duty.valve.piped:
            # without the reducers this capacity is right only where with them the flow is not turbulent
            reynolds = part.valve.reynolds(part.turbulent_flow(found), found, part.backward)
            found = np.where(reynolds < TURBULENT_REYNOLDS, found, np.nan)
        kv[waiting] = found
        start[waiting] = behind + _STEP
        waiting = waiting[np.isnan(found) & ~np.isnan(behind)]
    return kv


def _excess(duty, piped, trim, full=None):
    """Log of the capacity needed with the factors of a capacity, over that capacity; inf where none does."""
    valve = duty.valve

    def excess(log_kv):
        kv = np.exp(log_kv)
        n = trim_of(capacity_over_bore(kv, valve.nominal_size), full) if trim is None else trim
        factor = reynolds_factor(
            valve.reynolds(duty.flow, kv, duty.backward), n, valve.fl, strict=valve.strict
        )
        needed = duty.turbulent_kv(duty.flow / factor, piped)
        return np.where(np.isnan(needed), np.inf, np.log(needed) - log_kv)

    return excess


def _first_bracket(excess, start, end):
    """Two logs of capacities between which the excess first falls through zero; NaN where it never does."""
    low, high, nearest = _scan(excess, start, end)
    # a fall and a rise between two points of the grid show as a dip towards zero: look closer
    for zoom in range(_ZOOMS):
        again = np.isnan(low) & ~np.isnan(nearest)
        if not again.any():
            break
        cell = (end - start) * (2.0 / (_GRID - 1)) ** zoom / (_GRID - 1)
        finer = _scan(excess, np.maximum(start, nearest - cell), np.minimum(end, nearest + cell))
        low, high, nearest = (
            np.where(again, new, old) for new, old in zip(finer, (low, high, nearest), strict=True)
        )
    return low, high


def _scan(excess, start, end):
    """First fall through zero on a grid; and where the excess is least, if it comes near zero without one."""
    low, high = np.full(start.shape, np.nan), np.full(start.shape, np.nan)
    nearest, least = np.full(start.shape, np.nan), np.full(start.shape, _NEAR)
    before, value = start, excess(start)
    for step in np.linspace(0.0, 1.0, _GRID)[1:]:
        here = start + step * (end - start)
        there = excess(here)
        found = (value >= 0.0) & (there <= 0.0) & np.isnan(low) & (start <= end)
        low, high = np.where(found, before, low), np.where(found, here, high)
        nearest, least = np.where(there < least, here, nearest), np.minimum(least, there)
        before, value = here, there
    return low, high, nearest


def _root(function, low, high):
    """Root of a function that falls from `low` to `high`; NaN where it does not, or jumps over zero.

    And the upper end of the bracket that is left; NaN where there was none.

    Regula falsi with Illinois weights, halving every third step: it always ends.
    """
    f_low, f_high = function(low), function(high)
    usable = (f_low >= 0.0) & (f_high <= 0.0)
    root, residual = np.where(f_low == 0.0, low, high), np.where(f_low == 0.0, 0.0, f_high)
    side = np.zeros(low.shape)
    for turn in range(180):
        tolerance = 4.0 * _EPS * (1.0 + np.abs(root))
        open_rows = usable & (np.abs(residual) > tolerance) & (high - low > tolerance)
        if not open_rows.any():
            break
        with np.errstate(invalid="ignore", divide="ignore"):
            guess = (low * f_high - high * f_low) / (f_high - f_low)
            straight = (guess > low) & (guess < high) & np.isfinite(f_low) & (turn % 3 != 2)
        guess = np.where(straight, guess, 0.5 * (low + high))
        value = function(guess)
        above = value > 0.0
        f_high = np.where(open_rows & above & (side > 0), 0.5 * f_high, f_high)
        f_low = np.where(open_rows & ~above & (side < 0), 0.5 * f_low, f_low)
        side = np.where(above, 1.0, -1.0)
        low, f_low = np.where(open_rows & above, guess, low), np.where(open_rows & above, value, f_low)
        high, f_high = np.where(open_rows & ~above, guess, high), np.where(open_rows & ~above, value, f_high)
        root, residual = np.where(open_rows, guess, root), np.where(open_rows, value, residual)
    return np.where(usable & (np.abs(residual) < 1e-9), root, np.nan), np.where(usable, high, np.nan)


def _through(capacity, gain):
    """Capacity of the valve alone from that of valve and reducers together."""
    rest = 1.0 - gain * capacity * capacity
    return capacity / np.sqrt(np.where(rest > 0.0, rest, np.nan))
