# SPDX-License-Identifier: BSD-3-Clause
"""Elementary functions without branches or calls, so that a compiler turns loops over them into vectors.

The library functions behind `math.exp` and `math.log` stop a loop from being vectorised; these cost a few
additions a value instead. Each is within a few units in the last place inside the range it names, gives NaN
for NaN, and promises nothing outside its range.
"""

import numba as nb
import numpy as np

# no assumption about NaN or order of sums: rounding tricks below live on both being kept
FAST = {"contract", "nsz"}

# 1.5 * 2^52: adding it leaves the nearest integer in the low bits of a double
_SHIFTER = 6755399441055744.0
_SHIFTER_BITS = np.int64(np.float64(_SHIFTER).view(np.int64))
_ONE_BITS = np.int64(0x3FF0000000000000)
_MANTISSA = np.int64(0x000FFFFFFFFFFFFF)
# the bits of sqrt(1/2), so that a mantissa ends up within a factor sqrt(2) about one
_HALF_ROOT_BITS = np.int64(0x3FE6A09E667F3BCD)
_TWO_52 = 4503599627370496.0
_TWO_52_BITS = np.int64(np.float64(_TWO_52).view(np.int64))
# log(2) in two parts; the first has zeros at its end, so that its small multiples are exact
_LN2_HIGH = 6.93147180369123816490e-01
_LN2_LOW = 1.90821492927058770002e-10


@nb.njit(inline="always", fastmath=FAST)
def exp(x):
    """e to the power x, for x in [-700, 700]."""
    shifted = x * 1.4426950408889634 + _SHIFTER
    whole = shifted - _SHIFTER
    r = (x - whole * _LN2_HIGH) - whole * _LN2_LOW
    # Taylor on |r| <= log(2) / 2, in four interleaved parts: shorter chains than Horner's
    r2 = r * r
    r4 = r2 * r2
    p0 = 1.0 + r
    p1 = 0.5 + r * (1.0 / 6.0)
    p2 = (1.0 / 24.0) + r * (1.0 / 120.0)
    p3 = (1.0 / 720.0) + r * (1.0 / 5040.0)
    p4 = (1.0 / 40320.0) + r * (1.0 / 362880.0)
    p5 = (1.0 / 3628800.0) + r * (1.0 / 39916800.0)
    p6 = (1.0 / 479001600.0) + r * (1.0 / 6227020800.0)
    high = (p4 + r2 * p5) + r4 * p6
    series = (p0 + r2 * p1) + r4 * ((p2 + r2 * p3) + r4 * high)
    scale = ((np.float64(shifted).view(np.int64) - _SHIFTER_BITS) << 52) + _ONE_BITS
    return series * np.int64(scale).view(np.float64)


@nb.njit(inline="always", fastmath=FAST)
def log(x):
    """Natural logarithm, for normal positive x."""
    bits = np.float64(x).view(np.int64) - _HALF_ROOT_BITS
    exponent = bits >> 52
    m = np.int64((bits & _MANTISSA) + _HALF_ROOT_BITS).view(np.float64)
    # the exponent as a double by the same shift, for want of a vector conversion on older machines
    whole = np.int64(exponent + _SHIFTER_BITS).view(np.float64) - _SHIFTER
    f = m - 1.0
    s = f / (2.0 + f)
    z = s * s
    z2 = z * z
    z4 = z2 * z2
    # atanh: 2 s (1 + z/3 + z^2/5 + ...), |s| <= 0.1716
    t0 = (1.0 / 3.0) + z * (1.0 / 5.0)
    t1 = (1.0 / 7.0) + z * (1.0 / 9.0)
    t2 = (1.0 / 11.0) + z * (1.0 / 13.0)
    t3 = (1.0 / 15.0) + z * (1.0 / 17.0)
    tail = z * ((t0 + z2 * t1) + z4 * (t2 + z2 * (t3 + z2 * ((1.0 / 19.0) + z * (1.0 / 21.0)))))
    # f - f^2/2 exact in its leading part, as log(1+f) = f - s (f - R) wants it
    half = 0.5 * f * f
    # the difference is zero, but for a NaN: taking the number apart loses that
    return (x - x) + whole * _LN2_HIGH - ((half - (s * (half + 2.0 * tail) + whole * _LN2_LOW)) - f)


@nb.njit(inline="always", fastmath=FAST)
def one_over_cube_root(x):
    """x to the power -1/3, for x in [1e-300, 1e300]."""
    # a third of the upper word, taken as a number, is a third of the exponent and nearly of the mantissa
    upper = np.int64((np.float64(x).view(np.int64) >> 32) + _TWO_52_BITS).view(np.float64) - _TWO_52
    third = (1430188287.0 - upper * (1.0 / 3.0)) + _SHIFTER
    y = np.int64((np.float64(third).view(np.int64) - _SHIFTER_BITS) << 32).view(np.float64)
    for _ in range(2):
        left = 1.0 - x * y * y * y
        y = y + y * left * ((1.0 / 3.0) + left * ((2.0 / 9.0) + left * (14.0 / 81.0)))
    return y
