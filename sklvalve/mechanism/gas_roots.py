# SPDX-License-Identifier: BSD-3-Clause
"""Private: the root of a function in a bracket, for many rows at once; it always ends."""

import numpy as np

_STEPS = 120
_TOLERANCE = 4.0 * np.finfo(float).eps


@np.errstate(all="ignore")
def root_between(function, low, high):
    """Root of a continuous function of each row, by Chandrupatla's method; NaN without a change of sign.

    Inverse quadratic steps where the last three points allow them, else halving, so that the bracket shrinks
    to rounding in at most the number of its binary digits.
    """
    a, b = np.broadcast_arrays(np.asarray(high, dtype=float), np.asarray(low, dtype=float))
    f_a, f_b = function(a), function(b)
    bracketed = np.sign(f_a) * np.sign(f_b) <= 0.0
    c, f_c = a, f_a
    share = np.full(np.shape(f_a), 0.5)
    for _ in range(_STEPS):
        best = np.where(np.abs(f_a) < np.abs(f_b), a, b)
        least = np.minimum(np.abs(f_a), np.abs(f_b))
        near = _TOLERANCE * np.maximum(np.abs(best), np.finfo(float).tiny) / np.abs(b - a)
        if np.all((near > 0.5) | (least == 0.0) | ~bracketed | np.isnan(near)):
            break
        new = a + np.clip(share, near, 1.0 - near) * (b - a)
        f_new = function(new)
        same = np.sign(f_new) == np.sign(f_a)
        c, f_c = np.where(same, a, b), np.where(same, f_a, f_b)
        b, f_b = np.where(same, b, a), np.where(same, f_b, f_a)
        a, f_a = new, f_new
        share = _next_share(a, b, c, f_a, f_b, f_c)
    return np.where(bracketed, np.where(np.abs(f_a) < np.abs(f_b), a, b), np.nan)[()]


def _next_share(a, b, c, f_a, f_b, f_c):
    xi, phi = (a - b) / (c - b), (f_a - f_b) / (f_c - f_b)
    monotone = (phi * phi < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
    quadratic = f_a / (f_b - f_a) * f_c / (f_b - f_c)
    quadratic = quadratic + (c - a) / (b - a) * f_a / (f_c - f_a) * f_b / (f_c - f_b)
    return np.where(monotone & np.isfinite(quadratic), quadratic, 0.5)
