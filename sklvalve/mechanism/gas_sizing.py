# SPDX-License-Identifier: BSD-3-Clause
"""Private: the flow coefficient of a gas valve between reducers, whose factors depend on it."""

import numpy as np

from sklvalve.mechanism.gas_factors import expansion_factor
from sklvalve.mechanism.gas_inputs import Valve, throughput

# Newton needs about six steps; halving alone would need no more than this
_STEPS = 100
_CLOSE = 1e-15
_SOLVED = 1e-11


def capacity_between_reducers(wanted, x, valve):
    """kv for which kv F_P sqrt(x) Y is `wanted`, not negative; NaN where there is none."""
    if np.ndim(valve.fittings) == 0 and valve.fittings == 0.0 and np.all(valve.inlet == 0.0):
        capacity, x_choked = valve.at(1.0)
        return wanted / (capacity * throughput(x, x_choked))
    rows = (wanted, x, valve.gamma, valve.xt, valve.fittings, valve.inlet)
    shape = np.broadcast_shapes(*map(np.shape, rows))
    wanted, x, *parts = (np.broadcast_to(row, shape).ravel() for row in rows)
    valve = Valve(*parts)
    kv = _choked_capacity(wanted, valve)
    x_choked = valve.at(kv)[1]
    kv[np.isnan(x_choked)] = np.nan
    unchoked = np.flatnonzero((x < x_choked) & (wanted > 0.0))
    few = Valve(*(part[unchoked] for part in parts))
    kv[unchoked] = _unchoked_capacity(kv[unchoked], wanted[unchoked], x[unchoked], few)
    return kv.reshape(shape)[()]


def _choked_capacity(wanted, valve):
    """Holds in choked flow and bounds from below elsewhere, for no flow exceeds the choked one."""
    square = 2.25 * wanted * wanted / valve.at(0.0)[1]
    left = 1.0 - valve.inlet * square
    return np.sqrt(square / np.where(left > 0.0, left, np.nan))


def _unchoked_capacity(least, wanted, x, valve):
    # beyond these no valve has such reducers
    most = [
        np.where(part < 0.0, 1.0 / np.sqrt(np.abs(part)), np.inf) for part in (valve.fittings, valve.inlet)
    ]
    low, high = np.log(least), np.log(np.minimum(*most))
    log = low.copy()
    step = np.full_like(log, np.inf)
    for _ in range(_STEPS):
        excess, slope = _log_flow(log, wanted, x, valve)
        low, high = np.where(excess < 0.0, log, low), np.where(excess > 0.0, log, high)
        new = log - excess / slope
        # ahead of the solution an unbounded bracket is crossed in decades, else halved
        middle = np.where(
            np.isfinite(high), 0.5 * (low + np.where(np.isfinite(high), high, 0.0)), low + np.log(10.0)
        )
        new = np.where((new >= low) & (new <= high) & (new < low + 5.0), new, middle)
        step, log = np.abs(new - log), new
        if np.all((step <= _CLOSE * (1.0 + np.abs(log))) | np.isnan(step)):
            break
    excess, slope = _log_flow(log, wanted, x, valve)
    return np.where(np.abs(excess) <= _SOLVED, np.exp(log), np.nan)


def _log_flow(log, wanted, x, valve):
    """Logarithm of the flow over the wanted one, and its derivative by the logarithm of kv."""
    kv = np.exp(log)
    capacity, x_choked = valve.at(kv)
    expansion = expansion_factor(x, x_choked)
    share = 2.0 * (1.0 - expansion) / expansion
    slope = (1.0 - share) / (1.0 + valve.fittings * kv * kv) + share / (1.0 + valve.inlet * kv * kv)
    return np.log(capacity * throughput(x, x_choked) / wanted), slope
