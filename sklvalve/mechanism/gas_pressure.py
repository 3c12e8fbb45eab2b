# SPDX-License-Identifier: BSD-3-Clause
"""Gas through a control valve: the pressure behind it or before it, from the flow."""

import numpy as np

from sklvalve.mechanism.gas_data import GasData
from sklvalve.mechanism.gas_inputs import drop_ratio, positive, throughput, unit_speed, valve_of
from sklvalve.mechanism.gas_units import check_basis, gas_density, gas_mass_flow
from sklvalve.mechanism.gas_viscous import is_turbulent, jet_of, viscous_drop_ratio, viscous_pressure_before
from sklvalve.mechanism.liquid import floats
from sklvalve.mechanism.validity import warn_rows

_STEEP, _LARGE = 1e3, 1e12
_POLISH = 2


def gas_outlet_pressure(
    flow,
    kv,
    p1,
    temperature,
    molar_mass,
    *,
    gamma,
    xt,
    compressibility=1.0,
    basis="mass",
    dynamic_viscosity=None,
    fl=None,
    fd=None,
    kv_rated=None,
    nominal_size=None,
    inlet_pipe=None,
    outlet_pipe=None,
    strict=False,
    return_feasible=False,
    warn=True,
):
    r"""Pressure behind the valve from the flow of a gas through it.

    Parameters
    ----------
    flow : float or array-like
        Flow on the `basis`; negative flow runs from `p2` to `p1`. [kg/s] or [m3/s]
    kv : float or array-like
        Flow coefficient at the actual opening. [m3/h]
    p1 : float or array-like
        Inlet pressure, absolute. [Pa]
    temperature, molar_mass, gamma, xt, compressibility, basis
        As in `gas_flow`; the temperature and compressibility are those upstream.
    dynamic_viscosity, fl, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict, warn
        As in `gas_flow`.
    return_feasible : bool, default=False
        Also return the mask of rows that have an answer.

    Returns
    -------
    p2 : float or ndarray
        Outlet pressure, absolute. NaN where the valve cannot pass the flow: `kv` is not positive, or the flow
        reaches the choked flow, from where on any lower `p2` gives the same flow. [Pa]
    feasible : bool or ndarray of bool
        Only with ``return_feasible=True``.

    Raises
    ------
    ValueError
        If the basis is unknown, pipes are given without `nominal_size`, or a viscosity without `fl`, `fd` and
        `nominal_size`.

    Warns
    -----
    ValidityWarning
        Rows that are infeasible, that have a pressure below zero or another datum that is not positive and
        finite, and a `gamma` outside 1.08 to 1.65.

    Notes
    -----
    The cubic :math:`v (1 - v^2) = c` for :math:`v^2 = x / (3 x_c)`, with :math:`x_c = F_\gamma x_{TP}` and
    :math:`c = W / (N_6 F_P K_v \sqrt{3 x_c\, p_1 \rho_1})`, is a sine of a third of an angle:

    .. math:: v = \frac{2}{\sqrt 3} \sin\left(\tfrac13 \arcsin \tfrac{3\sqrt3}{2} c\right), \qquad
              p_2 = p_1 (1 - 3 x_c v^2)

    Near choking a small error of the flow is a large one of the pressure.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    >>> from sklvalve.mechanism import gas_flow
    >>> gas = {"gamma": 1.3, "xt": 0.6, "compressibility": 0.988}
    >>> w = gas_flow(71.0, 680e3, 310e3, 433.0, 0.04401, **gas)
    >>> round(float(gas_outlet_pressure(w, 71.0, 680e3, 433.0, 0.04401, **gas)))
    310000
    """
    flow, kv, p1 = floats(flow, kv, p1)
    gas, factors = (temperature, molar_mass, compressibility), (gamma, xt)
    viscous, pipes = (dynamic_viscosity, fl, fd, kv_rated), (nominal_size, inlet_pipe, outlet_pipe)
    p2 = _pressure_beyond((flow, kv, p1), gas, factors, viscous, pipes, basis, strict)
    if warn:
        data = GasData((*gas, *factors), viscous, pipes)
        _warn("gas_outlet_pressure", data, (flow, kv, p1), p2, basis)
    return (p2, ~np.isnan(p2)) if return_feasible else p2


def gas_inlet_pressure(
    flow,
    kv,
    p2,
    temperature,
    molar_mass,
    *,
    gamma,
    xt,
    compressibility=1.0,
    basis="mass",
    dynamic_viscosity=None,
    fl=None,
    fd=None,
    kv_rated=None,
    nominal_size=None,
    inlet_pipe=None,
    outlet_pipe=None,
    strict=False,
    warn=True,
):
    r"""Pressure before the valve from the flow of a gas and the pressure behind it.

    Parameters
    ----------
    flow, kv, temperature, molar_mass, gamma, xt, compressibility, basis
        As in `gas_outlet_pressure`.
    p2 : float or array-like
        Outlet pressure, absolute. [Pa]
    dynamic_viscosity, fl, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict, warn
        As in `gas_flow`.

    Returns
    -------
    p1 : float or ndarray
        Inlet pressure, absolute; defined in choked flow too, but not on the basis ``"actual"``, where a
        choked valve passes the same volume at any higher `p1`. NaN there, where `kv` is not positive and, for
        a flow that runs backwards, where it is choked. A volume on that basis together with a viscosity gives
        `p1` where the flow is turbulent by it, else NaN; near Re_v = 10 000 a lower, not turbulent `p1` may
        pass the same volume. [Pa]

    Raises
    ------
    ValueError
        If the basis is unknown, pipes are given without `nominal_size`, or a viscosity without `fl`, `fd` and
        `nominal_size`.

    Notes
    -----
    With :math:`q = W / (N_6 F_P K_v p_2 \sqrt{M / Z R T})` choked flow has
    :math:`p_1 = 3 q p_2 / (2 \sqrt{x_c})`; otherwise :math:`s = \sqrt x` is the middle root of

    .. math:: s^3 - 3 x_c q s^2 - 3 x_c s + 3 x_c q = 0, \qquad p_1 = p_2 / (1 - s^2).

    The compressibility is that at the wanted pressure; where it changes much, repeat with the new one.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    >>> from sklvalve.mechanism import gas_flow
    >>> gas = {"gamma": 1.3, "xt": 0.6, "compressibility": 0.988}
    >>> w = gas_flow(71.0, 680e3, 100e3, 433.0, 0.04401, **gas)
    >>> round(float(gas_inlet_pressure(w, 71.0, 100e3, 433.0, 0.04401, **gas)))
    680000
    """
    flow, kv, p2 = floats(flow, kv, p2)
    gas, factors = (temperature, molar_mass, compressibility), (gamma, xt)
    viscous, pipes = (dynamic_viscosity, fl, fd, kv_rated), (nominal_size, inlet_pipe, outlet_pipe)
    # the valve seen from its other side: the flow changes sign, the wanted pressure becomes the outlet
    turned = (nominal_size, outlet_pipe, inlet_pipe)
    p1 = _pressure_beyond((-flow, kv, p2), gas, factors, viscous, turned, basis, strict)
    if warn:
        data = GasData((*gas, *factors), viscous, pipes)
        _warn("gas_inlet_pressure", data, (-flow, kv, p2), p1, basis)
    return p1


def _pressure_beyond(duty, gas, factors, viscous, pipes, basis, strict):
    """Pressure on the other side of the valve; flow is positive towards that side."""
    check_basis(basis)
    flow, kv, given = duty
    # a flow from there comes from a pressure that nobody knows
    from_there = flow < 0.0
    with np.errstate(all="ignore"):
        valve = valve_of(*factors, from_there, *pipes)
        jet = jet_of(*viscous, from_there, *pipes)
        speed = unit_speed(*gas, basis=basis, strict=strict)
        known = np.where((given >= 0.0) & (given < np.inf), given, np.nan)
        state = (np.abs(flow), positive(kv), known, speed, gas, valve)
        if basis == "actual":
            ahead, before = _from_volume(*state, jet)
        else:
            ahead, before = _from_mass(
                gas_mass_flow(np.abs(flow), basis, known, *gas), *state[1:4], valve, jet
            )
        found = np.where(from_there, before, np.where(known > 0.0, ahead, np.nan))
        return np.where(np.isfinite(found), found, np.nan)[()]


def _warn(where, data, duty, found, basis):
    flow, kv, given = duty
    from_there = flow < 0.0
    data.warn(where, np.shape(found), stacklevel=5)
    impossible = (given < 0.0) | np.isinf(given) | ((given == 0.0) & ~from_there)
    what = "have a pressure below zero absolute, an infinite one, or none at all: NaN."
    warn_rows(impossible, where, what, stacklevel=4)
    lost = np.isnan(found) & data.known & ~impossible & ~(np.isnan(flow) | np.isnan(kv) | np.isnan(given))
    undecided = lost & from_there & (kv > 0.0) & (basis == "actual") & data.viscous
    what = "have a volume at the unknown inlet pressure, which says it only in turbulent unchoked flow: NaN."
    warn_rows(undecided, where, what, stacklevel=4)
    what = "ask for a flow that the valve cannot pass and give NaN."
    warn_rows(lost & ~undecided, where, what, stacklevel=4)


def _from_mass(mass, kv, known, speed, valve, jet):
    """Pressure behind the known one, and pressure before it."""
    if jet is not None:
        x = viscous_drop_ratio(mass, kv, positive(known) * speed, valve, jet)
        return known * (1.0 - x), viscous_pressure_before(mass, kv, known, speed, valve, jet)
    capacity, x_choked = valve.at(kv)
    demand = mass / (capacity * speed)
    x = drop_ratio(demand / positive(known), x_choked)
    return known * (1.0 - x), _pressure_before(demand, known, x_choked)


def _from_volume(volume, kv, known, speed, gas, valve, jet):
    """The same from a volume at the inlet, which says the drop ratio by itself where flow is turbulent."""
    capacity, x_choked = valve.at(kv)
    x = drop_ratio(volume * gas_density(1.0, *gas) / (capacity * speed), x_choked)
    ahead, before = known * (1.0 - x), positive(known) / (1.0 - x)
    if jet is not None:
        x = viscous_drop_ratio(volume * gas_density(known, *gas), kv, positive(known) * speed, valve, jet)
        ahead = known * (1.0 - x)
        before = np.where(is_turbulent(volume * gas_density(before, *gas), kv, jet), before, np.nan)
    return ahead, before


def _pressure_before(demand, behind, x_choked):
    """Pressure upstream from the one behind and the demand W / (capacity speed), itself a pressure."""
    choked = 1.5 * demand / np.sqrt(x_choked)
    is_choked = choked * (1.0 - x_choked) >= behind
    # only a valve that never chokes reaches the upper end, where nothing changes any more
    q = np.where(is_choked, 0.0, np.minimum(demand / behind, _LARGE))
    scale = np.sqrt(x_choked * (1.0 + x_choked * q * q))
    sine = 1.5 * x_choked * q * (2.0 / 3.0 * (x_choked * q) ** 2 + x_choked - 1.0) / scale**3
    root = x_choked * q - 2.0 * scale * np.sin(np.arcsin(np.clip(sine, -1.0, 1.0)) / 3.0)
    # an arcsine close to 1 keeps half of its digits
    root = np.where(q > _STEEP, np.sqrt(1.0 - (1.0 - 1.0 / (3.0 * x_choked)) / q), root)
    for _ in range(_POLISH):
        # the root is the difference of two larger numbers where the drop is nearly the whole pressure
        square = root * root
        excess = root * (1.0 - square / (3.0 * x_choked)) - q * (1.0 - square)
        root = root - excess / (1.0 - square / x_choked + 2.0 * q * root)
    x = root * root
    # each of the two is exact where the other loses digits
    unchoked = np.where(x < 0.5, behind / (1.0 - x), demand / throughput(x, x_choked))
    return np.where(is_choked, choked, unchoked)
