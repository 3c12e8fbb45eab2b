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
    weights = np.zeros(len(cross_products))
    free = np.zeros(len(cross_products), dtype=np.bool_)
    limit = 1e-9 * (np.abs(cross_products).max() + 1e-300)
    for _ in range(3 * len(cross_products)):
        gradient = cross_products - products @ weights
        gradient[free] = 0.0
        steepest = np.argmax(gradient)
        if not gradient[steepest] > limit:
            break
        free[steepest] = True
        while free.any():
            at = np.flatnonzero(free)
            solved = np.linalg.solve(products[at][:, at] + 1e-10 * np.eye(len(at)), cross_products[at])
            negative = solved <= 0.0
            if not negative.any():
                weights[:] = 0.0
                weights[at] = solved
                break
            # to the first bound that the solution would cross
            now = weights[at]
            steps = now[negative] / (now[negative] - solved[negative] + 1e-300)
            now += min(1.0, steps.min()) * (solved - now)
            now[now <= 1e-12] = 0.0
            weights[at] = now
            free[at] = now > 0.0
    return weights, 2.0 * (weights @ cross_products) - (weights @ products) @ weights


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
    inner = gram[: k + 1, : k + 1]
    if gram[k + 1, k + 1] > 1e-14:
        inner -= np.outer(gram[: k + 1, k + 1], gram[k + 1, : k + 1]) / gram[k + 1, k + 1]
    scale = np.sqrt(np.maximum(np.diag(inner)[:k], 1e-300))
    products = inner[:k, :k] / np.outer(scale, scale)
    _, gain = nonnegative_weights(products, sign * inner[:k, k] / scale)
    return max(inner[k, k] - gain, 1e-12 * inner[k, k] + 1e-300)


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
