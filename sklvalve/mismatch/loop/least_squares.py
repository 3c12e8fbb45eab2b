# SPDX-License-Identifier: BSD-3-Clause
"""Weights of one sign for every stem under every noise filter, from sums of products, in compiled loops."""

import numba as nb
import numpy as np
from numpy.typing import NDArray


@nb.njit(cache=True)
def nonnegative_weights(products: NDArray, cross_products: NDArray) -> tuple[NDArray, float]:
    """Weights >= 0 that bring ``w' P w - 2 w' a`` to its least: Lawson and Hanson's active set.

    Parameters
    ----------
    products : ndarray of shape (k, k)
        P, sums of products of the responses.
    cross_products : ndarray of shape (k,)
        a, sums of products of the responses and the value.

    Returns
    -------
    weights : ndarray of shape (k,)
    gain : float
        By how much the sum of squares falls.
    """
    k = len(cross_products)
    weights = np.zeros(k)
    free = np.zeros(k, dtype=np.bool_)
    limit = 1e-9 * (np.abs(cross_products).max() + 1e-300)
    for _ in range(3 * k):
        steepest = _steepest(cross_products - products @ weights, free, limit)
        if steepest < 0:
            break
        free[steepest] = True
        while free.any():
            at = np.flatnonzero(free)
            solved = _solve_free(products, cross_products, at)
            if solved.min() > 0.0:
                weights[:] = 0.0
                weights[at] = solved
                break
            _step_to_bound(weights, free, at, solved)
    return weights, 2.0 * (weights @ cross_products) - (weights @ products) @ weights


@nb.njit(cache=True)
def _steepest(gradient: NDArray, free: NDArray[np.bool_], limit: float) -> int:
    """The weight at its bound that lowers the sum of squares fastest; -1 if none does."""
    best, size = -1, limit
    for i in range(len(gradient)):
        if not free[i] and gradient[i] > size:
            best, size = i, gradient[i]
    return best


@nb.njit(cache=True)
def _solve_free(products: NDArray, cross_products: NDArray, at: NDArray) -> NDArray:
    """Weights of the free responses without a bound."""
    part = np.empty((len(at), len(at)))
    right = np.empty(len(at))
    for i in range(len(at)):
        right[i] = cross_products[at[i]]
        for j in range(len(at)):
            part[i, j] = products[at[i], at[j]]
        part[i, i] += 1e-10
    return np.linalg.solve(part, right)


@nb.njit(cache=True)
def _step_to_bound(weights: NDArray, free: NDArray[np.bool_], at: NDArray, solved: NDArray) -> None:
    """Move the weights towards a solution until the first is zero, and bind those that are."""
    step = 1.0
    for i in range(len(at)):
        if solved[i] <= 0.0:
            step = min(step, weights[at[i]] / (weights[at[i]] - solved[i] + 1e-300))
    for i in range(len(at)):
        weights[at[i]] += step * (solved[i] - weights[at[i]])
        if weights[at[i]] <= 1e-12:
            weights[at[i]] = 0.0
            free[at[i]] = False


@nb.njit(cache=True)
def _whiten_used(
    values: NDArray, begin: float, keep: float, follow: float, used: NDArray[np.bool_], out: NDArray
) -> None:
    """Innovations in the used rows, as `whiten` makes them from a value to begin with."""
    last_in, last_out, count = 0.0, 0.0, 0
    for t in range(len(values)):
        now = values[t] - begin
        last_out = now - keep * last_in + follow * last_out
        last_in = now
        if used[t]:
            out[count] = last_out
            count += 1


@nb.njit(cache=True)
def _one_sign_fit(gram: NDArray, sign: float) -> float:
    """Sum of squares that weights of one sign leave.

    The last rows of the Gram matrix are those of the value and of the level, which is projected out in place.
    """
    k = len(gram) - 2
    if gram[k + 1, k + 1] > 1e-14:
        for i in range(k + 1):
            for j in range(k + 1):
                gram[i, j] -= gram[i, k + 1] * gram[k + 1, j] / gram[k + 1, k + 1]
    scale = np.empty(k)
    for i in range(k):
        scale[i] = np.sqrt(max(gram[i, i], 1e-300))
    products, cross_products = np.empty((k, k)), np.empty(k)
    for i in range(k):
        cross_products[i] = sign * gram[i, k] / scale[i]
        for j in range(k):
            products[i, j] = gram[i, j] / (scale[i] * scale[j])
    _, gain = nonnegative_weights(products, cross_products)
    return max(gram[k, k] - gain, 1e-12 * gram[k, k] + 1e-300)


@nb.njit(cache=True)
def residual_sums(
    responses: NDArray, value: NDArray, used: NDArray[np.bool_], filters: NDArray, sign: float
) -> tuple[NDArray, NDArray]:
    """Residual sum of squares of each stem under each noise filter, a free level taken out.

    Parameters
    ----------
    responses : ndarray of shape (m, k, n)
        Of each stem [fraction of travel].
    value : ndarray of shape (n,)
        [value's unit]
    used : ndarray of bool, shape (n,)
    filters : ndarray of shape (f, 2)
    sign : float
        Of the weights.

    Returns
    -------
    sums : ndarray of shape (m, f)
        [value's unit squared]
    without_response : ndarray of shape (f,)
        The same of the value alone.
    """
    m, k, n = responses.shape
    sums, without_response = np.empty((m, len(filters))), np.empty(len(filters))
    rows = np.empty((k + 2, used.sum()))
    level = np.ones(n)
    for f in range(len(filters)):
        keep, follow = filters[f, 0], filters[f, 1]
        # the level is not started at rest, all else is
        _whiten_used(level, 0.0, keep, follow, used, rows[k + 1])
        _whiten_used(value, value[0], keep, follow, used, rows[k])
        for stem in range(m):
            for c in range(k):
                _whiten_used(responses[stem, c], responses[stem, c, 0], keep, follow, used, rows[c])
            gram = rows @ rows.T
            sums[stem, f] = _one_sign_fit(gram, sign)
            without_response[f] = gram[k, k]
    return sums, without_response
