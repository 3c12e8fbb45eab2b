# SPDX-License-Identifier: BSD-3-Clause
"""Private: the opening that passes a flow, whatever flows and whichever factors change with travel."""

from dataclasses import dataclass

import numpy as np

from sklvalve.mechanism.characteristic import opening_for_capacity, relative_capacity
from sklvalve.mechanism.gas_roots import root_between
from sklvalve.mechanism.travel import at_travel
from sklvalve.mechanism.validity import warn_rows

# rounding of a flow against that of the open valve
_ROUNDING = 1e-10
_STEPS = np.linspace(0.0, 1.0, 17)
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


@dataclass(frozen=True)
class Trim:
    """What turns an opening into a flow coefficient, and back."""

    kv_rated: float
    characteristic: object
    rangeability: float | None
    shutoff: float
    leakage: float

    def __post_init__(self):
        if not (np.ndim(self.kv_rated) == 0 and 0.0 < self.kv_rated < np.inf):
            raise ValueError(f"kv_rated must be a positive number [m3/h]; got {self.kv_rated!r}.")

    def kv(self, opening):
        return self.kv_rated * relative_capacity(opening, self.characteristic, warn=False, **self._shape)

    def opening(self, kv):
        phi = kv / self.kv_rated
        return opening_for_capacity(phi, self.characteristic, warn=False, **self._shape)

    @property
    def _shape(self):
        return {"rangeability": self.rangeability, "shutoff": self.shutoff, "leakage": self.leakage}


def opening_for(flow, flow_of, kv_of, trim, given, factors, where, warn):
    """Smallest opening with ``flow_of(kv, ...) == flow``.

    `flow_of` and its inverse `kv_of` take, by name, what is `given` and the `factors`, of which some may be
    tables over travel. They are called with ``warn=False``: the warnings are given here, under the name
    `where`.
    """
    tables = {name: value for name, value in factors.items() if _is_table(value)}
    given = given | {name: value for name, value in factors.items() if name not in tables}
    rows = _Rows(given, flow)
    direction = np.sign(rows.column("p1") - rows.column("p2"))
    wanted = rows.column("flow") * np.where(direction == 0.0, np.nan, direction)

    def surplus(opening, at=slice(None)):
        changing = {name: at_travel(table, opening) for name, table in tables.items()}
        found = flow_of(trim.kv(opening), **rows.named(at), **changing, warn=False)
        return found * direction[at] - wanted[at]

    shut, full = surplus(np.zeros(rows.size)), surplus(np.ones(rows.size))
    if tables:
        opening = _search(surplus, shut, _nodes(tables))
    else:
        opening = trim.opening(kv_of(rows.column("flow"), **rows.named(), warn=False))
    # what rounding has put just beyond an end is at that end
    slack = _ROUNDING * (full + wanted)
    beyond = np.isnan(opening)
    opening = np.where(beyond & (np.abs(shut) <= slack), 0.0, opening)
    opening = np.where(beyond & (np.abs(full) <= slack), 1.0, opening)
    if warn:
        _warn(rows, direction, wanted, shut, full, opening, where)
    return opening.reshape(rows.shape)[()]


def _search(surplus, shut, nodes):
    opening = np.where(shut == 0.0, 0.0, np.nan)
    waiting = np.flatnonzero(shut < 0.0)
    low, high = np.zeros(shut.size), np.full(shut.size, np.nan)
    best, nearest = np.zeros(shut.size, dtype=int), shut.copy()
    for number, node in enumerate(nodes[1:], start=1):
        if not waiting.size:
            break
        found = surplus(np.full(waiting.size, node), waiting)
        better = found > nearest[waiting]
        best[waiting[better]], nearest[waiting[better]] = number, found[better]
        reached = found >= 0.0
        high[waiting[reached]] = node
        waiting = waiting[~reached]
        low[waiting] = node
    # a factor that falls as fast as the trim opens puts the largest flow before the end of the travel
    if waiting.size:
        before = nodes[np.maximum(best[waiting] - 1, 0)]
        after = nodes[np.minimum(best[waiting] + 1, len(nodes) - 1)]
        peak = _peak(lambda at: surplus(at, waiting), before, after)
        reached = surplus(peak, waiting) >= 0.0
        low[waiting[reached]], high[waiting[reached]] = before[reached], peak[reached]
    inside = np.flatnonzero(~np.isnan(high))
    if inside.size:
        opening[inside] = root_between(lambda at: surplus(at, inside), low[inside], high[inside])
    return opening


def _peak(function, low, high):
    """Where a function with one hump is largest, by golden section."""
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    f_left, f_right = function(left), function(right)
    # a peak is flat: half the digits of its place are all the digits of its height
    for _ in range(36):
        leftwards = f_left > f_right
        low, high = np.where(leftwards, low, left), np.where(leftwards, right, high)
        new = np.where(leftwards, high - _GOLDEN * (high - low), low + _GOLDEN * (high - low))
        f_new = function(new)
        left, right = np.where(leftwards, new, right), np.where(leftwards, left, new)
        f_left, f_right = np.where(leftwards, f_new, f_right), np.where(leftwards, f_left, f_new)
    return np.where(f_left > f_right, left, right)


def _nodes(tables):
    corners = [np.asarray(table, dtype=float)[:, 0] for table in tables.values()]
    return np.unique(np.clip(np.concatenate([_STEPS, *corners]), 0.0, 1.0))


def _is_table(value):
    return np.ndim(value) == 2 and np.shape(value)[1] == 2


def _warn(rows, direction, wanted, shut, full, opening, where):
    whole = ~rows.gap
    none = np.isnan(opening) & whole & (direction != 0.0) & (wanted >= 0.0)
    reasons = (
        ((direction == 0.0) & whole, "have no pressure drop and give NaN."),
        ((wanted < 0.0) & whole, "have the flow against the pressure drop and give NaN."),
        (none & (shut > 0.0), "ask for less than the shut valve lets by: NaN."),
        (none & (shut <= 0.0) & (full < 0.0), "ask for more than the valve passes at any opening: NaN."),
        (
            none & np.isnan(full),
            "have pressures or properties with which these equations give no flow: NaN.",
        ),
    )
    for bad, what in reasons:
        warn_rows(bad, where, what, stacklevel=5)


class _Rows:
    """Broadcast inputs as flat columns; what is one number for all rows stays one number."""

    def __init__(self, given, flow):
        values = {**given, "flow": flow}
        self._fixed = {name: value for name, value in values.items() if isinstance(value, str | bool)}
        numbers = {
            name: np.asarray(value, dtype=float) for name, value in values.items() if name not in self._fixed
        }
        self.shape = np.broadcast_shapes(*(value.shape for value in numbers.values()))
        self.size = int(np.prod(self.shape))
        self._columns = {
            name: np.broadcast_to(value, self.shape).ravel() if value.ndim else value
            for name, value in numbers.items()
        }
        self.gap = np.zeros(self.size, dtype=bool)
        for value in self._columns.values():
            self.gap |= np.isnan(value)

    def column(self, name):
        return np.broadcast_to(self._columns[name], (self.size,))

    def named(self, at=slice(None)):
        """Arguments of the flow equations at some rows; the flow is their result."""
        columns = {
            name: value[at] if value.ndim else value
            for name, value in self._columns.items()
            if name != "flow"
        }
        return {**columns, **self._fixed}
