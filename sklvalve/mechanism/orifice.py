# SPDX-License-Identifier: BSD-3-Clause
"""The paper's form: the valve as a thin orifice between the inlet and the vena contracta."""

import numpy as np

from sklvalve.mechanism._constants import FLOW_CONSTANT
from sklvalve.mechanism._liquid_inputs import Screen
from sklvalve.mechanism._liquid_valve import LiquidValve
from sklvalve.mechanism.choking import WATER_CRITICAL_PRESSURE, boiling_pressure
from sklvalve.mechanism.validity import quiet, warn_rows


def orifice_flow(
    area, p1, p_vc, density, *, velocity_coef=1.0, expansibility=1.0, beta=None, pipe_area=None, warn=True
):
    r"""Volume flow through the vena contracta: the paper's equations 1 and 16.

    Parameters
    ----------
    area : float or array-like
        Flow area at the vena contracta: A_c of equation 1, the unknown f(x) of equation 16. [m2]
    p1 : float or array-like
        Pressure before the valve, absolute. [Pa]
    p_vc : float or array-like
        Pressure at the vena contracta, see `vena_contracta_pressure`. [Pa]
    density : float or array-like
        Density before the valve. [kg/m3]
    velocity_coef : float or array-like, default=1.0
        Velocity coefficient, the paper's C_v; not the flow coefficient. [1]
    expansibility : float or array-like, default=1.0
        Expansibility factor epsilon; 1 for liquids. [1]
    beta : float or array-like, default=None
        Diameter ratio of vena contracta and pipe, where it is known. [1]
    pipe_area : float or array-like, default=None
        Cross-section of the pipe, from which ``beta**2 = area / pipe_area``. With neither, beta is 0. [m2]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows whose `p_vc` exceeds `p1`.

    Returns
    -------
    flow : float or ndarray
        Volume flow; NaN where `p_vc` exceeds `p1`, or the orifice is not narrower than the pipe. [m3/s]

    Raises
    ------
    ValueError
        If both `beta` and `pipe_area` are given.

    Notes
    -----
    .. math:: Q = C_v \varepsilon \frac{A_c}{\sqrt{1 - \beta^4}} \sqrt{\frac{2 (p_1 - p_{vc})}{\rho_1}}

    The paper writes p_c for the pressure at the vena contracta, and again for the critical pressure in its
    equation 5; and it calls the density before the valve an average one. Only the product of coefficient and
    area can be learnt from flows.

    Examples
    --------
    >>> round(float(orifice_flow(1e-3, 3e5, 1e5, 1000.0)), 4)
    0.02
    """
    area = np.asarray(area, dtype=float)
    speed = _vena_contracta_speed(p1, p_vc, density, velocity_coef, expansibility)
    if warn:
        warn_rows(np.asarray(p_vc) > np.asarray(p1), "orifice_flow", "have p_vc above p1 and give NaN.")
    ratio = _area_ratio(area, beta, pipe_area)
    with np.errstate(invalid="ignore", divide="ignore"):
        return area * speed / np.sqrt(np.where(ratio < 1.0, 1.0 - ratio * ratio, np.nan))


def orifice_area(
    flow, p1, p_vc, density, *, velocity_coef=1.0, expansibility=1.0, beta=None, pipe_area=None, warn=True
):
    r"""Flow area at the vena contracta from the flow: equation 16 inverted for f(x).

    Parameters
    ----------
    flow : float or array-like
        Volume flow. [m3/s]
    p1, p_vc, density, velocity_coef, expansibility, beta, pipe_area, warn
        As in `orifice_flow`.

    Returns
    -------
    area : float or ndarray
        Flow area; NaN where `p_vc` is not below `p1`. [m2]

    Raises
    ------
    ValueError
        If both `beta` and `pipe_area` are given.

    Notes
    -----
    With :math:`S = Q / (C_v \varepsilon \sqrt{2 (p_1 - p_{vc}) / \rho_1})`

    .. math:: A_c = S \sqrt{1 - \beta^4}
              \quad\text{or, in a pipe of area } A_1,\quad A_c = \frac{S}{\sqrt{1 + (S / A_1)^2}}

    the second because beta holds the unknown area itself. Noise of the flow grows as one over the root of the
    pressure drop.

    Examples
    --------
    >>> q = orifice_flow(1e-3, 3e5, 1e5, 1000.0, pipe_area=2e-3)
    >>> round(float(orifice_area(q, 3e5, 1e5, 1000.0, pipe_area=2e-3)), 12)
    0.001
    """
    _area_ratio(0.0, beta, pipe_area)
    flow = np.asarray(flow, dtype=float)
    speed = _vena_contracta_speed(p1, p_vc, density, velocity_coef, expansibility)
    if warn:
        bad = np.asarray(p_vc) >= np.asarray(p1)
        warn_rows(bad, "orifice_area", "have no pressure drop to the vena contracta and give NaN.")
    with np.errstate(invalid="ignore", divide="ignore"):
        equivalent = flow / np.where(speed > 0.0, speed, np.nan)[()]
    if pipe_area is not None:
        return equivalent / np.sqrt(1.0 + (equivalent / np.asarray(pipe_area, dtype=float)) ** 2)
    ratio = _area_ratio(0.0, beta, None)
    return equivalent * np.sqrt(np.where(ratio < 1.0, 1.0 - ratio * ratio, np.nan))[()]


def vena_contracta_pressure(
    p1,
    p2,
    fl,
    *,
    p_vapour=None,
    p_critical=WATER_CRITICAL_PRESSURE,
    kv=None,
    nominal_size=None,
    inlet_pipe=None,
    outlet_pipe=None,
    warn=True,
):
    r"""Pressure at the narrowest section of the stream.

    Parameters
    ----------
    p1, p2 : float or array-like
        Pressures before and behind the valve, absolute. [Pa]
    fl : float or array-like
        Pressure recovery factor of the valve alone. [1]
    p_vapour : float or array-like, default=None
        Vapour pressure; None leaves choking out. [Pa]
    p_critical : float or array-like, default=22.064e6
        Critical pressure. [Pa]
    kv : float or array-like, default=None
        Flow coefficient; needed with pipes. [m3/h]
    nominal_size, inlet_pipe, outlet_pipe : float or array-like, default=None
        Bores of the valve and its pipes, as in `liquid_flow`. [m]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows outside the validity.

    Returns
    -------
    p_vc : float or ndarray
        Pressure at the vena contracta. Once the flow is choked it stays at F_F p_v. NaN where the pressure
        upstream lies at or under F_F p_v, where no liquid enters, and where an input is NaN or senseless as
        in `liquid_flow`. [Pa]

    Raises
    ------
    ValueError
        If a pipe is given without `kv` or `nominal_size`.

    Warns
    -----
    ValidityWarning
        Rows where the liquid boils before the valve or an input is senseless; and, without `p_vapour`, rows
        whose `p_vc` falls below zero absolute: they are returned as they are, because nobody said where
        choking sets in.

    Notes
    -----
    .. math:: p_{vc} = \max\left(p_1 - \frac{\Delta p}{F_L^2},\; F_F p_v\right)

    which is the paper's equation 2, both its forms, solved for the pressure: the first holds at every point
    that is not choked, the second from the onset of choking on. Between reducers F_LP / F_P stands for F_L.
    For reversed flow the two sides swap roles.

    Examples
    --------
    Worked example 1 of IEC 60534-2-1:

    >>> round(float(vena_contracta_pressure(680e3, 220e3, 0.9, p_vapour=70.1e3)) / 1e3, 1)
    112.1
    """
    valve = LiquidValve(fl, nominal_size=nominal_size, inlet_pipe=inlet_pipe, outlet_pipe=outlet_pipe)
    if valve.piped and kv is None:
        raise ValueError("a pipe is given without kv: how much reducers take depends on it; give kv [m3/h].")
    screen = Screen(valve)
    p1, p2 = screen.pressures(p1, p2)
    with quiet():
        upstream = np.maximum(p1, p2)
        fl = valve.with_pipes(None if kv is None else np.asarray(kv, dtype=float), p2 > p1)[1]
        p_vc = upstream - np.abs(p1 - p2) / (fl * fl)
        if p_vapour is not None:
            p_vapour, p_critical = screen.boiling(p_vapour, p_critical)
            floor = boiling_pressure(p_vapour, p_critical)
            p_vc = np.where(upstream > floor, np.maximum(p_vc, floor), np.nan)[()]
    if warn:
        screen.warn("vena_contracta_pressure", p_vc, stacklevel=4)
        if p_vapour is None:
            warn_rows(p_vc < 0.0, "vena_contracta_pressure", "fall below zero absolute: give p_vapour.")
        else:
            warn_rows(upstream <= p_vapour, "vena_contracta_pressure", _BOILS)
    return p_vc


def estimate_fl(p1, p2, p_vc):
    r"""Pressure recovery factor from a measured pressure at the vena contracta: the paper's equation 2.

    Parameters
    ----------
    p1, p2 : float or array-like
        Pressures before and behind the valve, absolute. [Pa]
    p_vc : float or array-like
        Pressure measured at the vena contracta. [Pa]

    Returns
    -------
    fl : float or ndarray
        Pressure recovery factor; NaN where `p_vc` is not below `p1` or `p2` exceeds `p1`. [1]

    Notes
    -----
    .. math:: F_L = \sqrt{\frac{p_1 - p_2}{p_1 - p_{vc}}}

    Holds for flow that is not choked. The paper sets this equal to the form for the onset of choking,
    :math:`\sqrt{\Delta p_T / (p_1 - F_F p_v)}`, which holds there alone. F_L belongs to the valve and changes
    with its travel; it does not follow from one operating point unless `p_vc` was measured there.

    Examples
    --------
    >>> round(float(estimate_fl(680e3, 220e3, 112.1e3)), 3)
    0.9
    """
    p1, p2, p_vc = (np.asarray(value, dtype=float) for value in (p1, p2, p_vc))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.sqrt((p1 - p2) / np.where(p_vc < p1, p1 - p_vc, np.nan))


def area_from_kv(kv, fl, *, velocity_coef=1.0, pipe_area=None):
    r"""Flow area at the vena contracta of a valve with a given flow coefficient.

    Parameters
    ----------
    kv : float or array-like
        Flow coefficient. [m3/h]
    fl : float or array-like
        Pressure recovery factor. [1]
    velocity_coef : float or array-like, default=1.0
        Velocity coefficient. [1]
    pipe_area : float or array-like, default=None
        Cross-section of the pipe; None takes beta = 0. [m2]

    Returns
    -------
    area : float or ndarray
        Flow area with which `orifice_flow` and `liquid_flow` agree. [m2]

    Notes
    -----
    .. math:: \frac{C_v A_c}{\sqrt{1 - \beta^4}} = 19.633\,\mathrm{mm^2}\; F_L K_v

    Examples
    --------
    >>> round(float(area_from_kv(165.0, 0.9)) * 1e6)
    2916
    """
    kv, fl, velocity_coef = (np.asarray(value, dtype=float) for value in (kv, fl, velocity_coef))
    equivalent = fl * kv * (FLOW_CONSTANT / np.sqrt(2.0)) / velocity_coef
    if pipe_area is None:
        return equivalent
    return equivalent / np.sqrt(1.0 + (equivalent / np.asarray(pipe_area, dtype=float)) ** 2)


def _vena_contracta_speed(p1, p_vc, density, velocity_coef, expansibility):
    p1, p_vc, density, velocity_coef, expansibility = (
        np.asarray(value, dtype=float) for value in (p1, p_vc, density, velocity_coef, expansibility)
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        head = 2.0 * (p1 - p_vc) / np.where(density > 0.0, density, np.nan)
        return velocity_coef * expansibility * np.sqrt(head)


def _area_ratio(area, beta, pipe_area):
    """Area of the vena contracta over that of the pipe, which is beta squared."""
    if beta is not None and pipe_area is not None:
        raise ValueError("give beta or pipe_area, not both: either one fixes the other.")
    if pipe_area is not None:
        return area / np.asarray(pipe_area, dtype=float)
    return np.asarray(0.0 if beta is None else beta, dtype=float) ** 2


_BOILS = "have liquid at or below its vapour pressure before the valve; those at or below F_F p_v give NaN."
