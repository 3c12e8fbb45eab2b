# SPDX-License-Identifier: BSD-3-Clause
"""Liquid through a control valve, turbulent and choked: flow from capacity, and capacity from flow.

IEC 60534-2-1 for incompressible fluids, written for arrays and in SI. Reducers need nothing more here: with
the piping factors :math:`F_P` and :math:`F_{LP}` call any of these functions with ``kv * fp`` and
``fl=flp / fp``.
"""

import numpy as np

from sklvalve.mechanism._constants import FLOW_CONSTANT
from sklvalve.mechanism.validity import warn_rows

WATER_CRITICAL_PRESSURE = 22.064e6
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


def liquid_flow(
    kv, p1, p2, density, *, fl=None, p_vapour=None, p_critical=WATER_CRITICAL_PRESSURE, warn=True
):
    r"""Volume flow of a liquid through a valve, turbulent and, where `fl` is given, choked.

    Parameters
    ----------
    kv : float or array-like
        Flow coefficient at the actual opening. [m3/h]
    p1, p2 : float or array-like
        Pressures before and behind the valve, absolute. [Pa]
    density : float or array-like
        Density at the inlet. [kg/m3]
    fl : float or array-like, default=None
        Pressure recovery factor; None leaves choking out. [1]
    p_vapour : float or array-like, default=None
        Vapour pressure at the inlet temperature; needed with `fl`. [Pa]
    p_critical : float or array-like, default=22.064e6
        Critical pressure. [Pa]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows outside the validity.

    Returns
    -------
    flow : float or ndarray
        Volume flow, odd in the pressure drop: where `p2` exceeds `p1` the flow is negative and chokes by the
        conditions at `p2`. NaN where an input is NaN, the density is not positive, or the pressure upstream
        lies at or under F_F p_v, where no liquid enters. [m3/s]

    Raises
    ------
    ValueError
        If `fl` is given without `p_vapour`.

    Warns
    -----
    ValidityWarning
        Rows where the liquid boils before the valve, `kv` is negative (the linear continuation is returned)
        or the density is not positive.

    See Also
    --------
    liquid_kv : The same equation solved for kv.
    liquid_outlet_pressure, liquid_inlet_pressure : Solved for a pressure.

    Notes
    -----
    .. math:: Q = N_1 K_v \sqrt{\frac{\min(\Delta p,\, \Delta p_{choked})}{\rho_1 / \rho_0}}

    with :math:`N_1 = 0.1` for m3/h and kPa and :math:`\rho_0` = 999.1026 kg/m3. Valid for a Newtonian pure
    liquid, turbulent in the valve (valve Reynolds number above 10 000).

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    Worked example 1 of the standard, the other way round (360 m3/h is the flow it sizes for):

    >>> q = liquid_flow(165.0, 680e3, 220e3, 965.4, fl=0.9, p_vapour=70.1e3)
    >>> round(float(q) * 3600.0)
    360
    """
    kv, p1, p2, density = floats(kv, p1, p2, density)
    dp = p1 - p2
    drop = np.abs(dp)
    if with_choking(fl, p_vapour):
        upstream = np.maximum(p1, p2)
        drop = np.minimum(drop, choked_limit(upstream, fl, p_vapour, p_critical))
        if warn:
            warn_rows(upstream <= np.asarray(p_vapour), "liquid_flow", _BOILS)
    if warn:
        warn_rows(kv < 0.0, "liquid_flow", "have a negative kv; the linear continuation is returned.")
        warn_rows(density <= 0.0, "liquid_flow", "have a density that is not positive and give NaN.")
    with np.errstate(invalid="ignore", divide="ignore"):
        # a density of zero must not pass as an infinite flow
        root = np.sqrt(drop / np.where(density > 0.0, density, np.nan))
    return FLOW_CONSTANT * kv * np.copysign(root, dp)


def liquid_kv(
    flow, p1, p2, density, *, fl=None, p_vapour=None, p_critical=WATER_CRITICAL_PRESSURE, warn=True
):
    r"""Flow coefficient that passes a given flow: sizing, the paper's equation 6 and its choked form.

    Parameters
    ----------
    flow : float or array-like
        Volume flow at inlet conditions. [m3/s]
    p1, p2, density, fl, p_vapour, p_critical, warn
        As in `liquid_flow`.

    Returns
    -------
    kv : float or ndarray
        Flow coefficient; NaN where the pressure drop is zero or the liquid boils before the valve. Negative,
        with a warning, where the flow runs against the pressure drop. [m3/h]

    Raises
    ------
    ValueError
        If `fl` is given without `p_vapour`.

    Notes
    -----
    .. math:: K_v = \frac{Q}{N_1} \sqrt{\frac{\rho_1/\rho_0}{\min(\Delta p, \Delta p_{choked})}}

    The paper gives the turbulent form only; the choked one follows with
    :math:`\Delta p_{choked} = F_L^2 (p_1 - F_F p_v)`.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    Worked examples 1 and 2 of the standard: the same duty in a globe and in a ball valve.

    >>> kv = liquid_kv(360 / 3600, 680e3, 220e3, 965.4, fl=[0.9, 0.6], p_vapour=70.1e3, p_critical=22.12e6)
    >>> kv.round(0)
    array([165., 238.])
    """
    flow, p1, p2, density = floats(flow, p1, p2, density)
    unit_flow = liquid_flow(1.0, p1, p2, density, fl=fl, p_vapour=p_vapour, p_critical=p_critical, warn=False)
    with np.errstate(invalid="ignore", divide="ignore"):
        kv = np.where(unit_flow == 0.0, np.nan, flow / unit_flow)[()]
    if warn:
        warn_rows(p1 == p2, "liquid_kv", "have no pressure drop and give NaN.")
        warn_rows(kv < 0.0, "liquid_kv", "have the flow against the pressure drop; their kv is negative.")
        warn_rows(density <= 0.0, "liquid_kv", "have a density that is not positive and give NaN.")
        if fl is not None:
            warn_rows(np.maximum(p1, p2) <= np.asarray(p_vapour), "liquid_kv", _BOILS)
    return kv


_BOILS = "have liquid at or below its vapour pressure before the valve; those at or below F_F p_v give NaN."


def floats(*values):
    return tuple(np.asarray(value, dtype=float) for value in values)


def with_choking(fl, p_vapour):
    if fl is None:
        return False
    if p_vapour is None:
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
