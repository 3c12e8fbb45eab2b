# SPDX-License-Identifier: BSD-3-Clause
"""Liquid through a control valve: flow from capacity, and capacity from flow.

IEC 60534-2-1 for incompressible fluids, written for arrays and in SI: turbulent and, where the data for it
are given, choked, viscous, and between reducers. With :math:`F_P` and :math:`F_{LP}` from elsewhere call any
of these functions with ``kv * fp`` and ``fl=flp / fp``.
"""

import numpy as np

from sklvalve.mechanism._constants import FLOW_CONSTANT
from sklvalve.mechanism._liquid_inputs import BOILS, Screen
from sklvalve.mechanism._liquid_sizing import SizingDuty, required_kv
from sklvalve.mechanism._liquid_valve import LiquidValve
from sklvalve.mechanism.choking import (
    WATER_CRITICAL_PRESSURE,
    boiling_pressure,
    choked_limit,
    choked_pressure_drop,
    critical_pressure_ratio_factor,
    floats,
    with_choking,
)
from sklvalve.mechanism.validity import quiet, warn_rows

__all__ = [
    "FLOW_CONSTANT",
    "WATER_CRITICAL_PRESSURE",
    "boiling_pressure",
    "choked_limit",
    "choked_pressure_drop",
    "critical_pressure_ratio_factor",
    "floats",
    "liquid_flow",
    "liquid_kv",
    "with_choking",
]


def liquid_flow(
    kv,
    p1,
    p2,
    density,
    *,
    fl=None,
    p_vapour=None,
    p_critical=WATER_CRITICAL_PRESSURE,
    viscosity=None,
    fd=None,
    kv_rated=None,
    nominal_size=None,
    inlet_pipe=None,
    outlet_pipe=None,
    strict=False,
    warn=True,
):
    r"""Volume flow of a liquid through a valve: turbulent, and by what else is given.

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
        Vapour pressure at the inlet temperature; needed with `fl` unless `viscosity` is what `fl` is given
        for. [Pa]
    p_critical : float or array-like, default=22.064e6
        Critical pressure. [Pa]
    viscosity : float or array-like, default=None
        Kinematic viscosity; None takes the flow as turbulent. Needs `fl`, `fd` and `nominal_size`. [m2/s]
    fd : float or array-like, default=None
        Valve style modifier, for `viscosity`. [1]
    kv_rated : float or array-like, default=None
        Flow coefficient of the open valve, for `viscosity`: it decides what kind of trim the valve has. None
        takes `kv` itself; the trim may then flip with the travel, see `trim_parameter`. [m3/h]
    nominal_size : float or array-like, default=None
        Bore of the valve's ends; needed with `viscosity` and with pipes. [m]
    inlet_pipe, outlet_pipe : float or array-like, default=None
        Bore of the pipes before and behind the valve; either one None is as wide as the valve. With both None
        there are no reducers. Flow backwards goes through them the other way round. [m]
    strict : bool, default=False
        Take viscosity by the letter of the standard, jumps included: see `reynolds_factor` and
        `trim_parameter`; and reducers count in turbulent flow only.
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows outside the validity.

    Returns
    -------
    flow : float or ndarray
        Volume flow, odd in the pressure drop: where `p2` exceeds `p1` the flow is negative and chokes by the
        conditions at `p2`. NaN where an input is NaN or senseless (a pressure below zero absolute, a
        `p_vapour` outside 0 to `p_critical`, anything else but `kv` that is not positive), or the pressure
        upstream lies at or under F_F p_v, where no liquid enters; with `strict`, where the standard jumps
        over the answer. Of the data of the valve only those count that are used. [m3/s]

    Raises
    ------
    ValueError
        If `fl` is given without `p_vapour` or `viscosity`, or `viscosity` or a pipe without what it needs.

    Warns
    -----
    ValidityWarning
        Rows where the liquid boils before the valve, `kv` is negative (the linear continuation is returned)
        or wider than the standard covers, an input is senseless, or there is no answer.

    See Also
    --------
    liquid_kv : The same equation solved for kv.
    liquid_outlet_pressure, liquid_inlet_pressure : Solved for a pressure.
    liquid_state : Which of the regimes a row is in.

    Notes
    -----
    .. math:: Q = F_R F_P N_1 K_v \sqrt{\frac{\min(\Delta p,\, \Delta p_{choked})}{\rho_1 / \rho_0}},
              \qquad \Delta p_{choked} = \left(\frac{F_{LP}}{F_P}\right)^2 (p_1 - F_F p_v)

    with :math:`N_1 = 0.1` for m3/h and kPa and :math:`\rho_0` = 999.1026 kg/m3; F_P and F_R are 1 and F_LP is
    F_L where no pipe or viscosity is given. F_R depends on the flow, which follows all the same without
    iteration: `nonturbulent_flow_ratio`. Valid for a Newtonian pure liquid and C below 0.047 N18 d2. The
    standard has no F_P in flow that is not turbulent; the product of both is an extension that keeps the flow
    continuous where it turns turbulent, and `strict` goes without it.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    Worked example 1 of the standard, the other way round (360 m3/h is the flow it sizes for), and with a
    liquid 6000 times as viscous:

    >>> q = liquid_flow(165.0, 680e3, 220e3, 965.4, fl=0.9, p_vapour=70.1e3)
    >>> round(float(q) * 3600.0)
    360
    >>> q = liquid_flow(
    ...     165.0, 680e3, 220e3, 965.4, fl=0.9, p_vapour=70.1e3, viscosity=2e-3, fd=0.46, nominal_size=0.15
    ... )
    >>> round(float(q) * 3600.0)
    256
    """
    kv, p1, p2, density = floats(kv, p1, p2, density)
    valve = LiquidValve(fl, viscosity, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict)
    chokes = with_choking(fl, p_vapour, valve.viscous)
    screen = Screen(valve)
    p1, p2 = screen.pressures(p1, p2)
    boiling = screen.boiling(p_vapour, p_critical) if chokes else ()
    with quiet():
        dp, upstream = p1 - p2, np.maximum(p1, p2)

        def turbulent(kv, fl):
            return _turbulent_flow(kv, dp, upstream, density, fl, boiling)

        flow = valve.slowed(turbulent, kv, dp < 0.0)
        lost = (
            valve.known() & np.isnan(flow) & ~np.isnan(turbulent(kv, valve.fl)) if valve.extended else False
        )
    if warn:
        if chokes:
            warn_rows(upstream <= boiling[0], "liquid_flow", BOILS)
        warn_rows(kv < 0.0, "liquid_flow", "have a negative kv; the linear continuation is returned.")
        warn_rows(density <= 0.0, "liquid_flow", "have a density that is not positive and give NaN.")
        screen.warn("liquid_flow", flow)
        valve.warn(kv, "liquid_flow")
        warn_rows(lost, "liquid_flow", "have no flow that satisfies the equations and give NaN.")
    return flow


def liquid_kv(
    flow,
    p1,
    p2,
    density,
    *,
    fl=None,
    p_vapour=None,
    p_critical=WATER_CRITICAL_PRESSURE,
    viscosity=None,
    fd=None,
    kv_rated=None,
    nominal_size=None,
    inlet_pipe=None,
    outlet_pipe=None,
    strict=False,
    warn=True,
):
    r"""Flow coefficient that passes a given flow: sizing, the paper's equation 6 and its choked form.

    Parameters
    ----------
    flow : float or array-like
        Volume flow at inlet conditions. [m3/s]
    p1, p2, density, fl, p_vapour, p_critical
        As in `liquid_flow`.
    viscosity, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict, warn
        As in `liquid_flow`.

    Returns
    -------
    kv : float or ndarray
        Flow coefficient of the valve alone; NaN where the pressure drop is zero, the liquid boils before the
        valve, an input is senseless as in `liquid_flow`, or no valve of the size passes the flow between its
        pipes. Negative, with a warning, where the flow runs against the pressure drop. Where a viscous duty
        has several answers, which it can have without `kv_rated` or with `strict`, the smallest; by the
        letter and with reducers a turbulent one goes first. [m3/h]

    Raises
    ------
    ValueError
        As in `liquid_flow`.

    Notes
    -----
    .. math:: K_v = \frac{Q}{N_1} \sqrt{\frac{\rho_1/\rho_0}{\min(\Delta p, \Delta p_{choked})}}

    The paper gives the turbulent form only; the choked one follows with
    :math:`\Delta p_{choked} = F_L^2 (p_1 - F_F p_v)`. Between reducers, with q the result above for turbulent
    and for choked flow,

    .. math:: K_v = \max\left(\frac{q_t}{\sqrt{1 - \tfrac{\sum\zeta}{N_2 d^4} q_t^2}},\;
              \frac{q_c}{\sqrt{1 - \tfrac{F_L^2 \zeta_i}{N_2 d^4} q_c^2}}\right)

    Each form asks for what the flow needs at least, so the larger one is the one that holds. Viscosity makes
    F_R depend on the answer: a bracketed iteration that always ends.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    Worked examples 1 and 2 of the standard: the same duty in a globe and in a ball valve.

    >>> kv = liquid_kv(360 / 3600, 680e3, 220e3, 965.4, fl=[0.9, 0.6], p_vapour=70.1e3, p_critical=22.12e6)
    >>> kv.round(0)
    array([165., 238.])

    A globe valve of 80 mm between reducers:

    >>> pipes = {"nominal_size": 0.08, "inlet_pipe": 0.1, "outlet_pipe": 0.09}
    >>> kv = liquid_kv(360 / 3600, 680e3, 220e3, 965.4, fl=0.9, p_vapour=70.1e3, **pipes)
    >>> round(float(kv), 1)
    177.9
    """
    flow, p1, p2, density = floats(flow, p1, p2, density)
    valve = LiquidValve(fl, viscosity, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict)
    chokes = with_choking(fl, p_vapour, valve.viscous)
    screen = Screen(valve)
    p1, p2 = screen.pressures(p1, p2)
    boiling = screen.boiling(p_vapour, p_critical) if chokes else ()
    with quiet():
        dp, upstream = p1 - p2, np.maximum(p1, p2)
        if valve.extended:
            unit = _turbulent_flow(1.0, np.abs(dp), upstream, density, None, ())
            choked_unit = _turbulent_flow(1.0, np.inf, upstream, density, 1.0, boiling) if chokes else None
            duty = SizingDuty(valve, np.abs(flow), np.where(unit > 0.0, unit, np.nan), choked_unit, p2 > p1)
            kv = np.copysign(required_kv(duty), np.copysign(1.0, flow) * np.copysign(1.0, dp))[()]
        else:
            unit = _turbulent_flow(1.0, dp, upstream, density, valve.fl, boiling)
            kv = np.where(unit == 0.0, np.nan, flow / unit)[()]
        entering = ~np.isnan(flow / np.where(unit > 0.0, unit, np.nan))
        if valve.extended and chokes:
            entering = entering & ~np.isnan(choked_unit)
    if warn:
        warn_rows(p1 == p2, "liquid_kv", "have no pressure drop and give NaN.")
        warn_rows(kv < 0.0, "liquid_kv", "have the flow against the pressure drop; their kv is negative.")
        warn_rows(density <= 0.0, "liquid_kv", "have a density that is not positive and give NaN.")
        if chokes:
            warn_rows(upstream <= boiling[0], "liquid_kv", BOILS)
        screen.warn("liquid_kv", kv)
        valve.warn(kv, "liquid_kv")
        if valve.extended:
            lost = np.isnan(kv) & entering & valve.known()
            warn_rows(lost, "liquid_kv", "ask for a flow that no valve of this size passes and give NaN.")
    return kv


def _turbulent_flow(kv, dp, upstream, density, fl, boiling):
    """Turbulent flow, choked by `boiling`, the vapour and the critical pressure, where those are given."""
    drop = np.abs(dp)
    if boiling:
        drop = np.minimum(drop, choked_limit(upstream, fl, *boiling))
    # a density of zero must not pass as an infinite flow
    root = np.sqrt(drop / np.where(density > 0.0, density, np.nan))
    return FLOW_CONSTANT * kv * np.copysign(root, dp)
