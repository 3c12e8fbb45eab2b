# SPDX-License-Identifier: BSD-3-Clause
"""Every stem under every simple noise: weights of one sign by their sums of products, in compiled loops."""

import numba as nb
import numpy as np


@nb.njit(cache=True)
def nonnegative(products, aims):
    """Weights >= 0 that bring ``w' P w - 2 w' a`` to its least: Lawson and Hanson's active set.

    Parameters
    ----------
    products : ndarray of shape (k, k)
    aims : ndarray of shape (k,)

    Returns
    -------
    weights : ndarray of shape (k,)
    gain : float
        By how much the sum of squares falls.
    """
    k = len(aims)
    weights = np.zeros(k)
    free = np.zeros(k, dtype=np.bool_)
    limit = 1e-9 * (np.abs(aims).max() + 1e-300)
    for _ in range(3 * k):
        pull = aims - products @ weights
        best, size = -1, limit
        for i in range(k):
            if not free[i] and pull[i] > size:
                best, size = i, pull[i]
        if best < 0:
            break
        free[best] = True
        while True:
            at = np.flatnonzero(free)
            part = np.empty((len(at), len(at)))
            right = np.empty(len(at))
            for i in range(len(at)):
                right[i] = aims[at[i]]
                for j in range(len(at)):
                    part[i, j] = products[at[i], at[j]]
                part[i, i] += 1e-10
            solved = np.linalg.solve(part, right)
            if solved.min() > 0.0:
                weights[:] = 0.0
                for i in range(len(at)):
                    weights[at[i]] = solved[i]
                break
            step = 1.0
            for i in range(len(at)):
                if solved[i] <= 0.0:
                    step = min(step, weights[at[i]] / (weights[at[i]] - solved[i] + 1e-300))
            for i in range(len(at)):
                weights[at[i]] += step * (solved[i] - weights[at[i]])
                if weights[at[i]] <= 1e-12:
                    weights[at[i]] = 0.0
                    free[at[i]] = False
            if not free.any():
                break
    return weights, 2.0 * (weights @ aims) - weights @ products @ weights


@nb.njit(cache=True)
def left_over(columns, value, used, filters, sense):
    """Sum of squares that each stem leaves over under each filter, a free level taken out.

    Parameters
    ----------
    columns : ndarray of shape (m, k, n)
    value : ndarray of shape (n,)
    used : ndarray of bool, shape (n,)
    filters : ndarray of shape (f, 2)
    sense : float

    Returns
    -------
    left : ndarray of shape (m, f)
    silent : ndarray of shape (f,)
        Without any response.
    """
    m, k, n = columns.shape
    count = len(filters)
    left = np.empty((m, count))
    silent = np.empty(count)
    rows = np.empty((k + 2, n))
    for f in range(count):
        keep, follow = filters[f, 0], filters[f, 1]
        for place in range(m):
            for c in range(k + 2):
                # the level is not started at rest, all else is
                begin = 0.0
                if c < k:
                    begin = columns[place, c, 0]
                elif c == k:
                    begin = value[0]
                last_in, last_out, kept = 0.0, 0.0, 0
                for t in range(n):
                    if c < k:
                        now = columns[place, c, t] - begin
                    elif c == k:
                        now = value[t] - begin
                    else:
                        now = 1.0
                    last_out = now - keep * last_in + follow * last_out
                    last_in = now
                    if used[t]:
                        rows[c, kept] = last_out
                        kept += 1
            part = np.ascontiguousarray(rows[:, :kept])
            gram = part @ part.T
            if gram[k + 1, k + 1] > 1e-14:
                for i in range(k + 1):
                    for j in range(k + 1):
                        gram[i, j] -= gram[i, k + 1] * gram[k + 1, j] / gram[k + 1, k + 1]
            scale = np.empty(k)
            for i in range(k):
                scale[i] = np.sqrt(max(gram[i, i], 1e-300))
            products, aims = np.empty((k, k)), np.empty(k)
            for i in range(k):
                aims[i] = sense * gram[i, k] / scale[i]
                for j in range(k):
                    products[i, j] = gram[i, j] / (scale[i] * scale[j])
            _, gain = nonnegative(products, aims)
            silent[f] = gram[k, k]
            left[place, f] = max(gram[k, k] - gain, 1e-12 * gram[k, k] + 1e-300)
    return left, silent
