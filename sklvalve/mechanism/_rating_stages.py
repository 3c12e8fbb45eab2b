# SPDX-License-Identifier: BSD-3-Clause
"""Stages of the fused pass behind `rate_liquid`: the laws, each as one plain loop over a block of rows.

No loop has a branch or a call, so that each runs as vectors. A block lies in rows of one small work array,
whose constant distances let the compiler see that no row overlaps another.
"""

from math import sqrt

import numba as nb
import numpy as np

from sklvalve.mechanism._constants import (
    COLDEST,
    CRITICAL_DENSITY,
    CRITICAL_PRESSURE,
    CRITICAL_TEMPERATURE,
    FLOW_CONSTANT,
    FULL_SIZE,
    HOUR,
    LAMINAR_REYNOLDS,
    MM,
    N2,
    N4,
    N32,
    TURBULENT_REYNOLDS,
)
from sklvalve.mechanism._vector_math import FAST, exp, log, one_over_cube_root

BLOCK = 256
# a line of the cache more than a block, so that equal positions of two rows are not 4 KiB apart
ROW = BLOCK + 8

# rows of the work array: what is read, in the order of the arguments, then what is found
INPUTS = (
    "kv",
    "p1",
    "p2",
    "temperature",
    "density",
    "p_vapour",
    "viscosity",
    "p_critical",
    "fl",
    "fd",
    "kv_rated",
    "nominal_size",
    "inlet_pipe",
    "outlet_pipe",
)
OUTPUTS = ("density", "p_vapour", "viscosity", "flow", "mass_flow", "dp_choked", "reynolds", "fr")
KV, P1, P2, T, RHO, PV, NU, PC, FL, FD, RATED, SIZE, INLET, OUTLET = (k * ROW for k in range(14))
FLOW, MASS, DPC, RE, FR, KVP, FL2, BOIL, LAM, SLOPE, EXCESS, FAST_FLOW, FAST_RE = (
    k * ROW for k in range(14, 27)
)
# 1 in rows that hold nonsense
MARK = 27 * ROW
WORK = 28 * ROW
PLACE = np.array([RHO, PV, NU, FLOW, MASS, DPC, RE, FR])

_PER_CRITICAL_TEMPERATURE = 1.0 / CRITICAL_TEMPERATURE
_FLOW_CONSTANT = float(FLOW_CONSTANT)
_SLOPE_FACTOR = float(0.33 / np.log(10.0))

# not kept on disk: what `rate` calls is kept with it
compiled = nb.njit(nogil=True, fastmath=FAST, error_model="numpy")


@compiled
def water(w, n):
    """Density, vapour pressure and boiling pressure F_F p_v of water (IAPWS SR1-86)."""
    for i in range(n):
        t = w[T + i]
        t = t if (t >= COLDEST) & (t <= CRITICAL_TEMPERATURE) else np.nan
        tau = (CRITICAL_TEMPERATURE - t) * _PER_CRITICAL_TEMPERATURE
        tau2 = tau * tau
        tau3 = tau2 * tau
        tau4 = tau2 * tau2
        root = sqrt(tau)
        series = tau * (-7.85951783 + 1.84408259 * root) + tau3 * (
            (-11.7866497 + 22.6807411 * root) + tau * (-15.9618719 + 1.80122502 * tau3 * root)
        )
        # the root of p_v / p_c, which is all that F_F asks for
        half = 0.5 * CRITICAL_TEMPERATURE / t * series
        reduced = exp(-700.0 if half < -700.0 else half)
        p_vapour = CRITICAL_PRESSURE * reduced * reduced
        w[PV + i] = p_vapour
        w[BOIL + i] = (0.96 - 0.28 * reduced) * p_vapour
    for i in range(n):
        t = w[T + i]
        t = t if (t >= COLDEST) & (t <= CRITICAL_TEMPERATURE) else np.nan
        tau = (CRITICAL_TEMPERATURE - t) * _PER_CRITICAL_TEMPERATURE
        inverse = one_over_cube_root(1e-280 if tau < 1e-280 else tau)
        third = tau * inverse * inverse
        two_thirds = third * third
        tau2 = tau * tau
        tau4 = tau2 * tau2
        tau5 = tau4 * tau
        tau9 = tau5 * tau4
        tau11 = tau9 * tau2
        series = 1.99274064 * third + two_thirds * (1.09965342 - 0.510839303 * tau)
        series += third * tau5 * (-1.75493479 - 45.5170352 * tau9)
        w[RHO + i] = CRITICAL_DENSITY * (
            1.0 + (series - 6.74694450e5 * two_thirds * (tau11 * tau11) * (tau9 * tau5))
        )


@compiled
def water_viscosity(w, n):
    """Kinematic viscosity of water (IAPWS SR6-08), its powers from the tenth part of one."""
    for i in range(n):
        t = w[T + i]
        t = t if t >= COLDEST else np.nan
        a = 300.0 / t
        tenth = exp(0.1 * log(a))
        third = tenth * tenth * tenth
        a2 = a * a
        a4 = a2 * a2
        a8 = a4 * a4
        a16 = a8 * a8
        series = 280.68 * (a2 / tenth) + 511.45 * (a8 / third)
        series += 61.131 * (a16 * a4 / (tenth * third)) + 0.45903 * (a16 * a16 * a8)
        w[NU + i] = 1e-6 * series / w[RHO + i]


@compiled
def boiling(w, n):
    """F_F p_v of a liquid whose vapour pressure was read."""
    for i in range(n):
        ratio = w[PV + i] / w[PC + i]
        bad = (w[PV + i] < 0.0) | (w[PC + i] <= 0.0) | (ratio > 1.0)
        ratio = np.nan if bad else ratio
        w[MARK + i] = 1.0 if bad else w[MARK + i]
        w[BOIL + i] = (0.96 - 0.28 * sqrt(ratio)) * w[PV + i]


@compiled
def pipes(w, n, choking):
    """Capacity and recovery factor of the valve between its reducers."""
    for i in range(n):
        size = w[SIZE + i]
        backward = w[P2 + i] > w[P1 + i]
        inlet, outlet = w[INLET + i], w[OUTLET + i]
        before = size / (outlet if backward else inlet)
        behind = size / (inlet if backward else outlet)
        before *= before
        behind *= behind
        zeta_inlet = 0.5 * (1.0 - before) * (1.0 - before) + (1.0 - before * before)
        zeta_outlet = (1.0 - behind) * (1.0 - behind) - (1.0 - behind * behind)
        size *= MM
        relative = w[KV + i] / (size * size)
        relative = relative * relative / N2
        taken = (zeta_inlet + zeta_outlet) * relative
        # F_P squared, as one of two under the root, saves a root
        whole = 1.0 + (taken if taken > -1.0 else np.nan)
        w[KVP + i] = w[KV + i] / sqrt(whole)
        if choking:
            fl2 = w[FL + i] * w[FL + i]
            taken = fl2 * zeta_inlet * relative
            w[FL2 + i] = fl2 * whole / (1.0 + (taken if taken > -1.0 else np.nan))


@compiled
def no_pipes(w, n):
    for i in range(n):
        w[KVP + i] = w[KV + i]
        w[FL2 + i] = w[FL + i] * w[FL + i]


@compiled
def turbulent(w, n, choking):
    """Turbulent flow, choked where the drop is large."""
    for i in range(n):
        p1, p2 = w[P1 + i], w[P2 + i]
        dp = p1 - p2
        drop = abs(dp)
        if choking:
            limit = w[FL2 + i] * ((p1 if dp > 0.0 else p2) - w[BOIL + i])
            limit = limit if drop == drop else np.nan
            w[DPC + i] = limit
            limit = limit if limit > 0.0 else np.nan
            # either being NaN goes through: it makes the limit NaN, which is not above the drop
            drop = drop if drop < limit else limit
        density = w[RHO + i]
        flow = _FLOW_CONSTANT * w[KVP + i] * sqrt(drop / (density if density > 0.0 else np.nan))
        flow = flow if dp >= 0.0 else -flow
        w[FLOW + i] = flow
        w[MASS + i] = flow * density


@compiled
def reynolds(w, n, strict):
    """Reynolds number of the turbulent flow, and what the trim makes of it."""
    for i in range(n):
        kv, fl, nu = abs(w[KV + i]), w[FL + i], w[NU + i]
        inlet, outlet = w[INLET + i], w[OUTLET + i]
        pipe = MM * (outlet if w[P2 + i] > w[P1 + i] else inlet)
        pipe = fl * kv / (pipe * pipe)
        jet = (nu if (nu > 0.0) & (kv > 0.0) else np.nan) * sqrt(kv * fl)
        reynolds = N4 * HOUR * w[FD + i] * abs(w[FLOW + i]) / jet * sqrt(sqrt(pipe * pipe / N2 + 1.0))
        size = MM * w[SIZE + i]
        size *= size
        rated = abs(w[RATED + i]) / size
        relative = kv / size if strict else rated
        square = relative * relative
        inverse = one_over_cube_root(1e-280 if square < 1e-280 else square)
        trim = N2 / square if rated >= FULL_SIZE else 1.0 + N32 * square * inverse * inverse
        # by the letter the rated kv only chooses, which would hide that it is missing
        trim = trim if rated == rated else np.nan
        w[RE + i] = reynolds
        w[LAM + i] = 0.026 * 0.026 / (fl * fl) * trim
        w[SLOPE + i] = _SLOPE_FACTOR * sqrt(fl / sqrt(trim))


@compiled
def transitional(w, n):
    """Ratio of transitional to turbulent flow: the branch -1 of Lambert's function, through its logarithm."""
    for i in range(n):
        reynolds, slope = w[RE + i], w[SLOPE + i]
        grown = reynolds * slope / TURBULENT_REYNOLDS
        grown = 1e300 if grown > 1e300 else grown
        shift = 1.0 / slope + log(1e-300 if grown < 1e-300 else grown)
        excess = shift - 1.0
        excess = excess if excess > 0.0 else np.nan
        w[EXCESS + i] = excess
        w[FR + i] = shift + log(1.0 + excess + sqrt(2.0 * excess))
    # step by step over the whole block: within a row each step waits for the one before
    for _ in range(4):
        for i in range(n):
            y = w[FR + i]
            w[FR + i] = y * (w[EXCESS + i] + log(y)) / (y - 1.0)
    for i in range(n):
        w[FR + i] *= w[SLOPE + i]


@compiled
def smaller(w, n):
    """The continuous Reynolds factor out of the laminar, the transitional law and the floor under that."""
    for i in range(n):
        laminar, slope = w[LAM + i], w[SLOPE + i]
        floor = sqrt(LAMINAR_REYNOLDS * laminar)
        floor = floor if floor > slope else slope
        transitional = w[FR + i]
        ratio = transitional if transitional > floor else floor
        laminar *= w[RE + i]
        ratio = ratio if laminar == laminar else np.nan
        ratio = laminar if laminar < ratio else ratio
        w[FR + i] = 1.0 if ratio > 1.0 else ratio


@compiled
def literal(w, n):
    """The Reynolds factor by the letter of the standard; NaN where that has no answer."""
    for i in range(n):
        reynolds, law, slope, transitional = w[RE + i], w[LAM + i], w[SLOPE + i], w[FR + i]
        laminar = law * reynolds
        low = 1.0 if laminar > 1.0 else laminar
        high = low if low < transitional else transitional
        ratio = low if reynolds * low < LAMINAR_REYNOLDS else high
        ratio = 1.0 + 0.0 * low if reynolds >= TURBULENT_REYNOLDS else ratio
        actual = reynolds * ratio
        positive = 1e-300 if actual < 1e-300 else actual
        found = sqrt(law * actual)
        later = 1.0 + slope * log(positive / TURBULENT_REYNOLDS)
        found = later if (actual >= LAMINAR_REYNOLDS) & (later < found) else found
        found = 1.0 if (found > 1.0) | (actual >= TURBULENT_REYNOLDS) else found
        w[FR + i] = ratio if abs(found - ratio) <= 1e-9 * ratio else np.nan


@compiled
def reduce(w, n):
    """Flow by the Reynolds factor; no flow stays none, whatever its Reynolds number."""
    for i in range(n):
        fr = w[FR + i]
        factor = fr if w[FLOW + i] != 0.0 else 1.0
        w[FLOW + i] *= factor
        w[MASS + i] *= factor
        w[RE + i] *= fr


@compiled
def keep_fast(w, n):
    """Set aside the turbulent flow between reducers."""
    for i in range(n):
        w[FAST_FLOW + i] = w[FLOW + i]
        w[FAST_RE + i] = w[RE + i]


@compiled
def turn_fast(w, n):
    """Flow by the letter: with reducers where it is turbulent, without them where it is not."""
    for i in range(n):
        flow, found = w[FAST_FLOW + i], w[FAST_RE + i]
        fast = (found >= TURBULENT_REYNOLDS) | (flow != flow) | (flow == 0.0)
        flow = flow if fast else w[FLOW + i]
        w[FLOW + i] = flow
        w[MASS + i] = flow * w[RHO + i]
        w[RE + i] = found if fast else w[RE + i]
        turbulent_found = found >= TURBULENT_REYNOLDS
        w[FR + i] = 1.0 if turbulent_found else w[FR + i]
