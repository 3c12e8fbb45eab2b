# SPDX-License-Identifier: BSD-3-Clause
"""What passes the benchmark's valve and its bypass, and how the jet pushes the plug, compiled.

Relations and tables are those of the library's help text (Bartys and Syfert, 2002) and of Bartys and de las
Heras, "Actuator simulation of the DAMADICS benchmark actuator system", SAFEPROCESS 2003. Openings are shares
of *closing*: zero is open.
"""

import numpy as np
from numba import njit

_CRITICAL_AT = np.array([0.0, 1723763.0, 3447527.0, 6895055.0, 13790111.0, 17237639.0, 20685166.0])
_CRITICAL = np.array([0.94, 0.87, 0.84, 0.79, 0.75, 0.725, 0.685])
#: Recovery coefficient [1], which is F_L squared, of the valve by its share of closing [1].
RECOVERY_AT = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99, 1.0])
RECOVERY = np.array([1.0, 0.95, 0.9, 0.85, 0.785, 0.725, 0.67, 0.61, 0.555, 0.5, 0.45, 0.4])
#: Share of closing beyond which the trim closes down, linearly, to nothing [1].
SHUTS_FROM = 0.975
_BYPASS_AT = np.linspace(0.0, 1.0, 11)
_BYPASS = np.array([0.45, 0.5, 0.555, 0.61, 0.67, 0.725, 0.785, 0.85, 0.9, 0.95, 1.0])
_COMPRESSED_AT = np.array([0.0, 10.0, 20.0, 50.0, 110.0])
_COMPRESSED = np.array([5.26e-10, 5.02e-10, 4.81e-10, 4.69e-10, 4.42e-10])


@njit(cache=True, nogil=True)
def table(x, at, values):
    """Linear between the points of a table, constant beyond."""
    if x <= at[0]:
        return values[0]
    for k in range(1, len(at)):
        if x <= at[k]:
            return values[k - 1] + (values[k] - values[k - 1]) * (x - at[k - 1]) / (at[k] - at[k - 1])
    return values[-1]


@njit(cache=True, nogil=True)
def clip(x, low, high):
    """What `numpy.clip` does, for one number."""
    return min(max(x, low), high)


@njit(cache=True, nogil=True)
def density(celsius, p1):
    """Density of water [kg/m3] as the benchmark has it, by temperature [degC] and pressure [Pa]."""
    t = clip(celsius, 0.0, 110.0)
    if t < 30.0:
        rho = 1000.0 - (t - 4.0) ** 2 / 503570.0 * (t + 283.0) * 1000.0 / (t + 67.2)
    else:
        fall = (t - 4.0) ** 2 / 466700.0 * (t + 273.0) * 1000.0 * (350.0 - t)
        rho = 1000.0 - fall / ((t + 67.0) * (365.0 - t))
    return rho / (1.0 - table(t, _COMPRESSED_AT, _COMPRESSED) * p1)


@njit(cache=True, nogil=True)
def vapour_pressure(celsius):
    """Vapour pressure of water [Pa] as the benchmark has it, by temperature [degC]."""
    return 10.0 ** (10.7167 - 2141.0 / (celsius + 273.15))


@njit(cache=True, nogil=True)
def closing(x, f, par):
    """Share of closing [1] that the flow meets where the stem stands at x [m]."""
    closed = clip(x / par.stroke, 0.0, 1.0)
    if f[2] > 0.0:
        closed = min(1.0, closed + 0.2 * f[2])
    if f[3] > 0.0:
        closed = max(0.0, closed - 0.1 * f[3])
    return closed


@njit(cache=True, nogil=True)
def jet_force(closed, p1, p2, celsius, par):
    """Force [N] of the jet, towards open."""
    upstream = max(p1, vapour_pressure(celsius))
    return (upstream - p2) / table(closed, RECOVERY_AT, RECOVERY) * np.pi * par.plug**2 / 4.0


@njit(cache=True, nogil=True)
def _relative_capacity(closed, f, par):
    relative = np.exp(-par.slope * min(closed, SHUTS_FROM))
    if closed > SHUTS_FROM:
        relative *= (1.0 - closed) / (1.0 - SHUTS_FROM)
    relative *= 1.0 - 0.2 * f[2]
    relative = min(1.0, relative * (1.0 + 0.1 * f[3]))
    return relative + 0.1 * f[6] if par.leakage_adds > 0.0 else relative * (1.0 + 0.1 * f[6])


@njit(cache=True, nogil=True)
def _drop(p1, p2, pv, recovery, critical):
    """What of the pressure drop makes flow: all of it, or what choking lets through."""
    allowed = max(0.0, recovery * (p1 - critical * pv))
    return p1 - p2 if allowed > p1 - p2 else allowed


@njit(cache=True, nogil=True)
def mass_flow(closed, p1, p2, celsius, f, par):
    """Flow [t/h] through valve and bypass, by share of closing [1], pressures [Pa] and temperature [degC]."""
    pv = vapour_pressure(celsius)
    upstream = max(p1, pv)
    rho = density(celsius, upstream)
    critical = table(upstream, _CRITICAL_AT, _CRITICAL)
    drop = _drop(upstream, p2, pv, table(closed, RECOVERY_AT, RECOVERY), critical)
    capacity = par.kv * _relative_capacity(closed, f, par)
    flow = 100.0 * capacity * np.sqrt(abs(drop) * 1e-6 / rho) * rho / 1000.0
    bypass = 0.0
    if f[18] > 0.0:
        critical = table(p1, _CRITICAL_AT, _CRITICAL)
        drop = _drop(upstream, p2, pv, table(1.0 - f[18], _BYPASS_AT, _BYPASS), critical)
        # the original adds m3/h to t/h
        bypass = 100.0 * par.bypass_kv * f[18] * np.sqrt(abs(drop) * 1e-6 / 1000.0)
    return flow * (1.0 - 0.05 * f[5]) + bypass
