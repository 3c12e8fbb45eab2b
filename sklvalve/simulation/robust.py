# SPDX-License-Identifier: BSD-3-Clause
"""Robust cost of whitened residuals, and the steps that lower it within bounds, compiled.

A search asks these small questions some ten thousand times; compiled they cost little beside the simulations,
and leave the interpreter to other threads.
"""

from math import sqrt

import numba as nb
import numpy as np

# residuals beyond three standard deviations weigh linearly: spikes must not steer a fit
ROBUST_FROM = 3.0
_SQUARE = ROBUST_FROM**2
# of its own curvature: a parameter of which less is left beside the others is one that nothing speaks of
_NOTHING_LEFT = 1e-13
# rows of a block that a score of parameters keep in the first cache
_BLOCK = 256


@nb.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "nsz"})
def robust_cost(left):
    """Soft L1 cost of whitened residuals: half their squares where small, linear where large."""
    total = 0.0
    for k in range(len(left)):
        total += sqrt(1.0 + left[k] * left[k] * (1.0 / _SQUARE)) - 1.0
    return _SQUARE * total


@nb.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "nsz"})
def robust_weights(left):
    """Weight of each whitened residual in the quadratic that touches the soft L1 cost from above."""
    weights = np.empty_like(left)
    for k in range(len(left)):
        weights[k] = 1.0 / sqrt(1.0 + left[k] * left[k] * (1.0 / _SQUARE))
    return weights


@nb.njit(cache=True, nogil=True)
def _solved(hessian, right):
    """Solution of a system with unit diagonal; a parameter that the others leave nothing of stays at zero."""
    n = len(right)
    lower, kept, found = np.zeros((n, n)), np.ones(n, dtype=np.bool_), right.copy()
    for i in range(n):
        for j in range(i + 1):
            s = hessian[i, j]
            for k in range(j):
                s -= lower[i, k] * lower[j, k]
            if i > j:
                lower[i, j] = s / lower[j, j] if kept[j] else 0.0
            elif s > _NOTHING_LEFT:
                lower[i, i] = sqrt(s)
            else:
                kept[i] = False
    for i in range(n):
        for k in range(i):
            found[i] -= lower[i, k] * found[k]
        found[i] = found[i] / lower[i, i] if kept[i] else 0.0
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            found[i] -= lower[k, i] * found[k]
        found[i] = found[i] / lower[i, i] if kept[i] else 0.0
    return found


@nb.njit(cache=True, nogil=True)
def step_inside(hessian, gradient, lowest, highest):
    """Newton step between bounds: parameters that would leave are set on theirs, the others solved again.

    Parameters
    ----------
    hessian : ndarray of shape (m, m)
    gradient, lowest, highest : ndarray of shape (m,)
        Of the cost; how far each parameter may go down (negative) and up.

    Returns
    -------
    step : ndarray of shape (m,)
    """
    m = len(gradient)
    # in each parameter's own curvature: in raw units a pascal beside a m3/s falls below the solver's rounding
    unit = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    low, high, step = lowest / unit, highest / unit, np.zeros(m)
    free = np.ones(m, dtype=np.bool_)
    for i in range(m):
        pull = gradient[i]
        free[i] = not ((low[i] >= 0.0 and pull > 0.0) or (high[i] <= 0.0 and pull < 0.0))
    for _ in range(m):
        own = np.flatnonzero(free)
        part, pull = np.empty((len(own), len(own))), np.empty(len(own))
        for a in range(len(own)):
            i = own[a]
            pull[a] = -gradient[i] * unit[i]
            for b in range(len(own)):
                part[a, b] = hessian[i, own[b]] * unit[i] * unit[own[b]]
            for j in range(m):
                if not free[j]:
                    pull[a] -= hessian[i, j] * unit[i] * unit[j] * step[j]
        step[own] = _solved(part, pull)
        left = False
        for i in own:
            if step[i] < low[i] or step[i] > high[i]:
                step[i] = min(max(step[i], low[i]), high[i])
                free[i], left = False, True
        if not left:
            break
    return np.minimum(np.maximum(step, low), high) * unit


@nb.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "nsz"})
def normal_equations(rows, weights, left):
    """Gradient and Hessian of half the weighed squares of errors, without squares of the weights.

    Parameters
    ----------
    rows : ndarray of shape (p, n), C order
        Derivatives of the errors, a parameter a row: so each sum runs along memory.
    weights, left : ndarray of shape (n,)

    Returns
    -------
    gradient : ndarray of shape (p,)
    hessian : ndarray of shape (p, p)
    """
    p, n = rows.shape
    gradient, hessian, weighed = np.zeros(p), np.zeros((p, p)), np.empty(_BLOCK)
    for begin in range(0, n, _BLOCK):
        many = min(_BLOCK, n - begin)
        weight, error = weights[begin : begin + many], left[begin : begin + many]
        for i in range(p):
            own, pull = rows[i, begin : begin + many], 0.0
            for k in range(many):
                weighed[k] = weight[k] * own[k]
                pull += weighed[k] * error[k]
            gradient[i] += pull
            for j in range(i + 1):
                other, both = rows[j, begin : begin + many], 0.0
                for k in range(many):
                    both += weighed[k] * other[k]
                hessian[i, j] += both
    for i in range(p):
        for j in range(i):
            hessian[j, i] = hessian[i, j]
    return gradient, hessian


@nb.njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "nsz"})
def _gradient(rows, weights, left):
    gradient, pull = np.empty(len(rows)), weights * left
    for i in range(len(rows)):
        total = 0.0
        for k in range(len(pull)):
            total += pull[k] * rows[i, k]
        gradient[i] = total
    return gradient


@nb.njit(cache=True, nogil=True, fastmath={"contract", "nsz"})
def stepped(left, rows, step):
    """Errors after a step, to first order; arguments as in `normal_equations`."""
    moved = left.copy()
    for i in range(len(rows)):
        for k in range(len(moved)):
            moved[k] += step[i] * rows[i, k]
    return moved


@nb.njit(cache=True, nogil=True)
def least_within(rows, errors, lowest, highest):
    """Least robust cost of errors that change in proportion to parameters, these within bounds.

    Parameters
    ----------
    rows : ndarray of shape (p, n), C order
        Derivatives of the errors, a parameter a row.
    errors : ndarray of shape (n,)
    lowest, highest : ndarray of shape (p,)
        How far each parameter may go.

    Returns
    -------
    cost : float
    at : ndarray of shape (p,)
        Where the parameters end.

    Notes
    -----
    Reweighted least squares; the quadratic of one step serves the next as long as that lowers the cost.
    """
    at, left, hessian = np.zeros(len(rows)), errors, np.zeros((len(rows), len(rows)))
    cost, stale = robust_cost(left), True
    for _ in range(8):
        weights = robust_weights(left)
        fresh = stale
        if stale:
            gradient, hessian = normal_equations(rows, weights, left)
            # of each parameter's own curvature: that of one in pascals is nothing beside others
            for i in range(len(rows)):
                hessian[i, i] += 1e-12 * hessian[i, i] + 1e-300
            stale = False
        else:
            gradient = _gradient(rows, weights, left)
        step = step_inside(hessian, gradient, lowest - at, highest - at)
        moved = stepped(left, rows, step)
        lower = robust_cost(moved)
        # a parameter that was set on its bound may have been needed there no longer: not so far, then
        if fresh and lower >= cost:
            step *= 0.3
            moved = stepped(left, rows, step)
            lower = robust_cost(moved)
        if lower >= cost:
            # weights grow as errors shrink: old ones promise too long a step
            if fresh:
                break
            stale = True
            continue
        gained = cost - lower
        cost, left, at = lower, moved, at + step
        if gained < 0.05 + 1e-4 * cost:
            break
    return cost, at
