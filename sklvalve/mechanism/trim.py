# SPDX-License-Identifier: BSD-3-Clause
"""Kind of a trim, full-size or reduced, by which viscosity acts on the flow."""

import numpy as np

from sklvalve.mechanism._constants import FULL_SIZE, MM, N2, N32, capacity_over_bore


def trim_parameter(kv, nominal_size, *, kv_rated=None, strict=False):
    r"""Number n by which the trim enters the Reynolds factor.

    Parameters
    ----------
    kv : float or array-like
        Flow coefficient at the actual opening. [m3/h]
    nominal_size : float or array-like
        Bore of the valve's ends. [m]
    kv_rated : float or array-like, default=None
        Flow coefficient of the open valve. It decides between full-size and reduced trim and, unless
        `strict`, enters n itself. None takes `kv`: the trim may then flip as the valve travels, and with a
        full-size trim a wider opening may pass less of a very viscous liquid. [m3/h]
    strict : bool, default=False
        Put the actual `kv` into n, as the standard is written; `kv_rated` decides the kind of trim only.

    Returns
    -------
    trim : float or ndarray
        The number n; NaN where `kv_rated` is given and not positive. [1]

    Notes
    -----
    .. math:: n = N_2 \left(\frac{K_v}{d^2}\right)^{-2}
              \text{ if } \frac{K_{v100}}{N_{18} d^2} \ge 0.016, \qquad
              n = 1 + N_{32} \left(\frac{K_v}{d^2}\right)^{2/3} \text{ else}

    The factor was fitted to valves at rated travel. With the actual `kv` the first form lets laminar
    flow fall as the valve opens (:math:`Q \propto K_v^{-1/2}`), which no valve does; with the rated one it
    rises.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations, annex A.

    Examples
    --------
    Worked example 4 of the standard:

    >>> round(float(trim_parameter(0.015483, 0.015)), 3)
    1.235
    """
    actual = np.abs(capacity_over_bore(kv, nominal_size))
    rated = actual
    if kv_rated is not None:
        # nothing is known of a trim whose rated capacity is not
        rated = np.where(np.asarray(kv_rated) > 0.0, capacity_over_bore(kv_rated, nominal_size), np.nan)
        actual = np.where(np.isnan(rated), np.nan, actual)
    return trim_of(actual if strict else rated, full=np.abs(rated) >= FULL_SIZE)


def trim_of(relative, full):
    """Trim parameter of a capacity over bore squared whose kind of trim is known."""
    with np.errstate(divide="ignore"):
        return np.where(full, N2 / (relative * relative), 1.0 + N32 * np.cbrt(relative * relative))[()]


def full_size_kv(nominal_size):
    """Flow coefficient from which on a trim counts as full-size."""
    size = MM * np.asarray(nominal_size, dtype=float)
    return FULL_SIZE * size * size
