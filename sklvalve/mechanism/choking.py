# SPDX-License-Identifier: BSD-3-Clause
"""Where the flow of a liquid stops to grow: critical pressure ratio factor and choked pressure drop."""

import numpy as np

from sklvalve.mechanism._constants import CRITICAL_PRESSURE

WATER_CRITICAL_PRESSURE = CRITICAL_PRESSURE
"""Critical pressure of water, IAPWS. [Pa]"""


def critical_pressure_ratio_factor(p_vapour, p_critical=WATER_CRITICAL_PRESSURE):
    r"""Liquid critical pressure ratio factor F_F, the paper's equation 5.

    Parameters
    ----------
    p_vapour : float or array-like
        Vapour pressure of the liquid at the inlet temperature, absolute. [Pa]
    p_critical : float or array-like, default=22.064e6
        Thermodynamic critical pressure; the default is that of water. [Pa]

    Returns
    -------
    ff : float or ndarray
        Factor between 0.68 and 0.96; NaN where `p_vapour` lies outside [0, p_critical], for there is no
        liquid. [1]

    Notes
    -----
    .. math:: F_F = 0.96 - 0.28 \sqrt{p_v / p_c}

    For pure liquids. The paper prints 22 565 kPa as the critical pressure of water; it is 22 064 kPa (IAPWS).

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    >>> round(float(critical_pressure_ratio_factor(70.1e3, 22.12e6)), 4)
    0.9442
    """
    ratio = np.asarray(p_vapour, dtype=float) / np.asarray(p_critical, dtype=float)
    ratio = np.where((ratio >= 0.0) & (ratio <= 1.0), ratio, np.nan)[()]
    return 0.96 - 0.28 * np.sqrt(ratio)


def choked_pressure_drop(p1, p_vapour, p_critical, fl):
    r"""Pressure drop from which on the flow of a liquid no longer grows.

    Parameters
    ----------
    p1 : float or array-like
        Inlet pressure, absolute. [Pa]
    p_vapour : float or array-like
        Vapour pressure at the inlet temperature. [Pa]
    p_critical : float or array-like
        Critical pressure. [Pa]
    fl : float or array-like
        Pressure recovery factor of the valve at its actual travel; ``flp / fp`` with reducers. [1]

    Returns
    -------
    dp_choked : float or ndarray
        Onset of choking; negative or zero where the liquid boils before the valve. [Pa]

    Notes
    -----
    .. math:: \Delta p_{choked} = F_L^2 (p_1 - F_F p_v)

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    >>> round(float(choked_pressure_drop(680e3, 70.1e3, 22.12e6, 0.9)) / 1e3)
    497
    """
    fl = np.asarray(fl, dtype=float)
    return fl * fl * (np.asarray(p1, dtype=float) - boiling_pressure(p_vapour, p_critical))


def floats(*values):
    return tuple(np.asarray(value, dtype=float) for value in values)


def with_choking(fl, p_vapour, viscous=False):
    if fl is None:
        return False
    if p_vapour is None:
        if viscous:
            return False
        raise ValueError(
            "fl is given but p_vapour is not: choking needs both; give p_vapour or leave fl out."
        )
    return True


def boiling_pressure(p_vapour, p_critical):
    return critical_pressure_ratio_factor(p_vapour, p_critical) * np.asarray(p_vapour, dtype=float)


def choked_limit(upstream, fl, p_vapour, p_critical):
    """Onset of choking, NaN where no liquid enters (so that no root of a negative number is taken)."""
    limit = choked_pressure_drop(upstream, p_vapour, p_critical, fl)
    return np.where(limit > 0.0, limit, np.nan)[()]
