# SPDX-License-Identifier: BSD-3-Clause
"""Liquid through a control valve: the pressure behind it or before it, from the flow."""

import numpy as np

from sklvalve.mechanism._constants import FLOW_CONSTANT
from sklvalve.mechanism._liquid_inputs import Screen, complete
from sklvalve.mechanism._liquid_valve import LiquidValve
from sklvalve.mechanism.choking import (
    WATER_CRITICAL_PRESSURE,
    boiling_pressure,
    choked_limit,
    floats,
    with_choking,
)
from sklvalve.mechanism.validity import quiet, warn_rows

# the flow of a choked valve must not come back as feasible by the rounding of its own root
_ROUNDING = 32.0 * np.finfo(float).eps
_ROUNDING_OF_FACTORS = 1e-12


def liquid_outlet_pressure(
    flow,
    kv,
    p1,
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
    return_feasible=False,
    warn=True,
):
    r"""Pressure behind the valve from the flow through it.

    Parameters
    ----------
    flow : float or array-like
        Volume flow; negative flow runs from `p2` to `p1`. [m3/s]
    kv : float or array-like
        Flow coefficient at the actual opening. [m3/h]
    p1 : float or array-like
        Inlet pressure, absolute. [Pa]
    density, fl, p_vapour, p_critical
        As in `liquid_flow`.
    viscosity, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict, warn
        As in `liquid_flow`.
    return_feasible : bool, default=False
        Also return the mask of rows that have an answer.

    Returns
    -------
    p2 : float or ndarray
        Outlet pressure, absolute. NaN where the valve cannot pass the flow: `kv` is not positive, or the flow
        reaches the choked flow, from where on any lower `p2` gives the same flow; and where an input is NaN
        or senseless as in `liquid_flow`. [Pa]
    feasible : bool or ndarray of bool
        Only with ``return_feasible=True``.

    Raises
    ------
    ValueError
        As in `liquid_flow`.

    Warns
    -----
    ValidityWarning
        Rows that are infeasible or hold senseless data; and, without `fl`, rows whose `p2` falls below zero
        absolute: they are returned as they are, because without `fl` nobody said where choking sets in.

    Notes
    -----
    .. math:: p_2 = p_1 - \frac{\rho_1}{\rho_0} \left(\frac{Q}{N_1 K_v}\right)^2
              \quad\text{for}\quad \Delta p < F_L^2 (p_1 - F_F p_v)

    with Q / F_R for Q, F_P K_v for K_v and F_LP / F_P for F_L where viscosity or pipes are given: F_R follows
    from the flow without iteration. A relative error of the flow counts twice in the drop.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    >>> p2 = liquid_outlet_pressure(300 / 3600, 165.0, 680e3, 965.4, fl=0.9, p_vapour=70.1e3)
    >>> round(float(p2) / 1e3, 3)
    360.573
    """
    flow, kv, p1, density = floats(flow, kv, p1, density)
    valve = LiquidValve(fl, viscosity, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict)
    screen = Screen(valve)
    (p1,) = screen.pressures(p1)
    boiling = screen.boiling(p_vapour, p_critical) if with_choking(fl, p_vapour, valve.viscous) else ()
    p2 = _outlet_pressure(flow, kv, p1, density, valve, boiling)
    if warn:
        _warn("liquid_outlet_pressure", p2, (flow, kv, p1), density, boiling, screen, valve)
        if fl is None:
            warn_rows(p2 < 0.0, "liquid_outlet_pressure", "fall below zero absolute: give fl and p_vapour.")
    return (p2, ~np.isnan(p2)) if return_feasible else p2


def liquid_inlet_pressure(
    flow,
    kv,
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
    r"""Pressure before the valve from the flow and the pressure behind it.

    Parameters
    ----------
    flow, kv : float or array-like
        As in `liquid_outlet_pressure`.
    p2 : float or array-like
        Outlet pressure, absolute. [Pa]
    density, fl, p_vapour, p_critical
        As in `liquid_flow`.
    viscosity, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict, warn
        As in `liquid_flow`.

    Returns
    -------
    p1 : float or ndarray
        Inlet pressure, absolute; defined in choked flow too. NaN where `kv` is not positive or, for a flow
        that runs backwards, where it is choked; and where an input is NaN or senseless as in `liquid_flow`.
        [Pa]

    Raises
    ------
    ValueError
        As in `liquid_flow`.

    Notes
    -----
    With the turbulent drop :math:`\Delta p = (\rho_1/\rho_0)(Q / N_1 K_v)^2`

    .. math:: p_1 = \max\left(p_2 + \Delta p,\; F_F p_v + \Delta p / F_L^2\right):

    the second holds from the onset of choking on, and there the two are equal. Viscosity and pipes enter as
    in `liquid_outlet_pressure`.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    >>> p1 = liquid_inlet_pressure(300 / 3600, 165.0, 360.573e3, 965.4, fl=0.9, p_vapour=70.1e3)
    >>> round(float(p1) / 1e3, 2)
    680.0
    """
    # the valve seen from its other side: the flow changes sign, the wanted pressure becomes the outlet
    flow, kv, p2, density = floats(flow, kv, p2, density)
    valve = LiquidValve(fl, viscosity, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict)
    screen = Screen(valve)
    (p2,) = screen.pressures(p2)
    boiling = screen.boiling(p_vapour, p_critical) if with_choking(fl, p_vapour, valve.viscous) else ()
    p1 = _outlet_pressure(-flow, kv, p2, density, valve.turned(), boiling)
    if warn:
        _warn("liquid_inlet_pressure", p1, (flow, kv, p2), density, boiling, screen, valve)
    return p1


def _outlet_pressure(flow, kv, p1, density, valve, boiling):
    with quiet():
        turbulent, capacity, recovery = valve.as_turbulent(flow, kv, flow < 0.0)
        drop = _turbulent_drop(turbulent, capacity, density)
        p2 = p1 - drop
        if not boiling:
            return p2
        rounding = _ROUNDING_OF_FACTORS if valve.extended else _ROUNDING
        forward_limit = choked_limit(p1, recovery, *boiling) * (1.0 - rounding)
        # flow backwards: p1 is then the known pressure behind the valve, p2 the wanted one before it
        backward = _pressure_before(-drop, p1, recovery, *boiling)
        return np.where(drop < 0.0, backward, np.where(drop < forward_limit, p2, np.nan))[()]


def _warn(where, found, knowns, density, boiling, screen, valve):
    lost = np.isnan(found) & complete(*knowns, *boiling) & (density > 0.0) & valve.known()
    warn_rows(lost, where, "ask for a flow that the valve cannot pass and give NaN.", stacklevel=4)
    warn_rows(density <= 0.0, where, "have a density that is not positive and give NaN.", stacklevel=4)
    screen.warn(where, found, stacklevel=5)
    valve.warn(knowns[1], where, stacklevel=5)


def _turbulent_drop(flow, kv, density):
    """Drop with the sign of the flow; NaN where the valve is shut or the density is none."""
    possible = (kv > 0.0) & (density > 0.0)
    speed = np.where(possible, flow / (FLOW_CONSTANT * kv), np.nan)[()]
    return density * speed * np.abs(speed)


def _pressure_before(drop, p_behind, fl, p_vapour, p_critical):
    return np.maximum(p_behind + drop, boiling_pressure(p_vapour, p_critical) + drop / (fl * fl))
