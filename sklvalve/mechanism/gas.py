# SPDX-License-Identifier: BSD-3-Clause
"""Gas through a control valve: flow from capacity, and capacity from flow, with reducers and choking."""

import numpy as np

from sklvalve.mechanism.gas_data import GasData, sensible
from sklvalve.mechanism.gas_inputs import throughput, unit_speed, valve_of
from sklvalve.mechanism.gas_sizing import capacity_between_reducers
from sklvalve.mechanism.gas_units import check_basis, gas_mass_flow, gas_volume_flow
from sklvalve.mechanism.gas_viscous import jet_of, viscous_capacity, viscous_mass
from sklvalve.mechanism.liquid import floats
from sklvalve.mechanism.validity import warn_rows


def gas_flow(
    kv,
    p1,
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
    r"""Flow of a gas through a valve: turbulent, choked and, with a viscosity, not turbulent.

    Parameters
    ----------
    kv : float or array-like
        Flow coefficient at the actual opening. [m3/h]
    p1, p2 : float or array-like
        Pressures before and behind the valve, absolute. [Pa]
    temperature : float or array-like
        Temperature before the valve. [K]
    molar_mass : float or array-like
        Molar mass. [kg/mol]
    gamma : float or array-like
        Ratio of the heat capacities. [1]
    xt : float or array-like
        Pressure drop ratio factor of the valve at its actual travel. [1]
    compressibility : float or array-like, default=1.0
        Compressibility factor Z before the valve. [1]
    basis : {"mass", "actual", "normal", "standard"}, default="mass"
        What the flow is counted in, see `gas_volume_flow`.
    dynamic_viscosity : float or array-like, default=None
        Dynamic viscosity; with it, `fl`, `fd` and `nominal_size` flow may be laminar. [Pa s]
    fl, fd : float or array-like, default=None
        Pressure recovery factor and valve style modifier; used with `dynamic_viscosity` only. [1]
    kv_rated : float or array-like, default=None
        Flow coefficient of the open valve, which decides the kind of trim in flow that is not turbulent; None
        takes `kv`, and the kind may then change as the valve travels. [m3/h]
    nominal_size, inlet_pipe, outlet_pipe : float or array-like, default=None
        Bores of the valve's ends and of the pipes before and behind it; without pipes there are no reducers.
        [m]
    strict : bool, default=False
        The letter of the standard: its constants as it prints them, each rounded by itself.
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows outside the validity.

    Returns
    -------
    flow : float or ndarray
        Flow, odd in the pressure drop: where `p2` exceeds `p1` it is negative, enters by the outlet's reducer
        and chokes by the conditions there. NaN where an input is NaN, a pressure is negative, another
        quantity is not positive and finite, or the reducers would give back more than the valve takes.
        [kg/s] or [m3/s]

    Raises
    ------
    ValueError
        If the basis is unknown, pipes are given without `nominal_size`, or a viscosity without `fl`, `fd` and
        `nominal_size`.

    Warns
    -----
    ValidityWarning
        Rows with a negative pressure, another datum that is not positive and finite, a negative `kv` (the odd
        continuation is returned), impossible reducers, or a `gamma` outside 1.08 to 1.65.

    See Also
    --------
    gas_kv : The same equation solved for kv.
    gas_outlet_pressure, gas_inlet_pressure : Solved for a pressure.

    Notes
    -----
    With :math:`x = \Delta p / p_1` and :math:`x_s = \min(x, F_\gamma x_{TP})`

    .. math:: W = N_6 F_P K_v Y \sqrt{x_s\, p_1 \rho_1}, \qquad Y = 1 - \frac{x_s}{3 F_\gamma x_{TP}},
              \qquad \rho_1 = \frac{p_1 M}{Z R T}

    The standard rounds its constants N6, N8 and N9 to three digits one by one, and so disagrees with itself
    by up to 0.4 %. Here all follow from N1 = 0.1, the density of water at 15 degC and the gas constant:
    N6 = 3.1609 (3.16 there), N8 = 1.0962 (1.10), N9 = 24.570 (24.6) and, for 15 degC, 25.919 (26.0). With
    `strict` the printed figures are taken: N8 for mass, N6 for the actual volume, N9 for the other two. For a
    pure gas without liquid.

    Flow that is not turbulent is approximate: with t = 0 up to Re_v = 1000, rising to 1 at 10 000,

    .. math:: W = N_6 F_R F_P K_v \sqrt{p_1 \rho_1}
              \left(t\, Y \sqrt{x_s} + (1-t) \sqrt{x (1 - x/2)}\right)

    where Re_v is that of the actual flow. The public transcriptions of annex A disagree about this Y; here
    laminar flow goes with :math:`p_1^2 - p_2^2`, as it must, and everything is continuous, with `strict` too:
    it changes no more than the constants.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    Worked example 3 of the standard the other way round: carbon dioxide, 3800 normal cubic metres an hour.

    >>> pipes = {"nominal_size": 0.05, "inlet_pipe": 0.08, "outlet_pipe": 0.1}
    >>> gas = {"gamma": 1.3, "xt": 0.6, "compressibility": 0.988, "basis": "normal"}
    >>> q = gas_flow(71.0, 680e3, 310e3, 433.0, 0.04401, **gas, **pipes)
    >>> round(float(q) * 3600.0, -1)
    3800.0
    """
    check_basis(basis)
    kv, p1, p2 = floats(kv, p1, p2)
    backward = p2 > p1
    gas = (temperature, molar_mass, compressibility)
    viscous, pipes = (dynamic_viscosity, fl, fd, kv_rated), (nominal_size, inlet_pipe, outlet_pipe)
    with np.errstate(all="ignore"):
        upstream, x = _drop_ratio_of(p1, p2)
        valve = valve_of(gamma, xt, backward, *pipes)
        capacity, x_choked = valve.at(kv)
        speed = unit_speed(*gas, basis=basis, strict=strict)
        jet = jet_of(*viscous, backward, *pipes)
        if jet is None:
            mass = capacity * throughput(x, x_choked) * upstream * speed
        else:
            mass = np.sign(kv) * viscous_mass(np.abs(kv), x, upstream * speed, valve, jet)
        mass = np.where(backward, -mass, mass)
        flow = gas_volume_flow(mass, basis, upstream, *gas)
        vast = np.isinf(kv * kv)
    if warn:
        data = GasData((*gas, gamma, xt), viscous, pipes)
        _warn("gas_flow", p1, p2, data, np.shape(flow))
        warn_rows((kv < 0.0) & ~vast, "gas_flow", "have a negative kv; the odd continuation is returned.")
        warn_rows(vast, "gas_flow", "have a kv too large to reckon with: NaN.")
        lost = np.isnan(flow) & data.known & ~(np.isnan(kv) | vast | np.isnan(x))
        warn_rows(lost, "gas_flow", "have reducers that no such valve can have: NaN.")
    return flow[()]


def gas_kv(
    flow,
    p1,
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
    r"""Flow coefficient that passes a given flow of a gas: sizing.

    Parameters
    ----------
    flow : float or array-like
        Flow on the `basis`. [kg/s] or [m3/s]
    p1, p2, temperature, molar_mass, gamma, xt, compressibility, basis
        As in `gas_flow`.
    dynamic_viscosity, fl, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict, warn
        As in `gas_flow`.

    Returns
    -------
    kv : float or ndarray
        Flow coefficient; NaN where the pressure drop is zero or no valve of that size between these reducers
        passes the flow. Negative, with a warning, where the flow runs against the pressure drop. [m3/h]

    Raises
    ------
    ValueError
        If the basis is unknown, pipes are given without `nominal_size`, or a viscosity without `fl`, `fd` and
        `nominal_size`.

    Notes
    -----
    Explicit without reducers. With them the choked form is explicit too,

    .. math:: K_v^2 = \frac{q^2}{1 - x_T \zeta_i q^2 / (N_5 d^4)}, \qquad
              q = \frac{3}{2} \frac{W}{N_6 \sqrt{F_\gamma x_T\, p_1 \rho_1}},

    and holds where the valve of that size is choked; elsewhere it is a lower bound, from which Newton steps
    in logarithms, kept inside a bracket, reach the only solution: the flow rises with kv everywhere.
    With a viscosity a bracket is widened step by step and closed. Give `kv_rated` there: without it the kind
    of trim is that of the kv found, a reduced trim being tried first, and there may be other answers or none.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    Worked example 3 of the standard, which finds 70.9 with its rounded N9, as `strict` does:

    >>> pipes = {"nominal_size": 0.05, "inlet_pipe": 0.08, "outlet_pipe": 0.1}
    >>> gas = {"gamma": 1.3, "xt": 0.6, "compressibility": 0.988, "basis": "normal"}
    >>> duty = 3800 / 3600, 680e3, 310e3, 433.0, 0.04401
    >>> [round(float(gas_kv(*duty, **gas, **pipes, strict=letter)), 1) for letter in (False, True)]
    [71.0, 70.9]
    """
    check_basis(basis)
    flow, p1, p2 = floats(flow, p1, p2)
    backward = p2 > p1
    gas = (temperature, molar_mass, compressibility)
    viscous, pipes = (dynamic_viscosity, fl, fd, kv_rated), (nominal_size, inlet_pipe, outlet_pipe)
    with np.errstate(all="ignore"):
        upstream, x = _drop_ratio_of(p1, p2)
        mass = gas_mass_flow(flow, basis, upstream, *gas)
        valve = valve_of(gamma, xt, backward, *pipes)
        speed = unit_speed(*gas, basis=basis, strict=strict)
        wanted = np.where(x > 0.0, np.abs(mass), np.nan)
        jet = jet_of(*viscous, backward, *pipes)
        if jet is None:
            kv = capacity_between_reducers(wanted / (upstream * speed), x, valve)
        else:
            kv = viscous_capacity(wanted, x, upstream * speed, valve, jet)
        kv = np.where((mass < 0.0) != backward, -kv, kv)
    if warn:
        data = GasData((*gas, gamma, xt), viscous, pipes)
        _warn("gas_kv", p1, p2, data, np.shape(kv))
        warn_rows(p1 == p2, "gas_kv", "have no pressure drop and give NaN.")
        warn_rows(kv < 0.0, "gas_kv", "have the flow against the pressure drop; their kv is negative.")
        lost = np.isnan(kv) & data.known & ~(np.isnan(flow) | np.isnan(x) | (x == 0.0))
        warn_rows(lost, "gas_kv", "ask for a flow that no such valve was found to pass: NaN.")
    return kv[()]


def _drop_ratio_of(p1, p2):
    """Pressure upstream and ratio of the drop to it, NaN where there is no such gas."""
    upstream, downstream = sensible(np.maximum(p1, p2)), np.minimum(p1, p2)
    x = (upstream - downstream) / upstream
    return upstream, np.where(downstream >= 0.0, x, np.nan)[()]


def _warn(where, p1, p2, data, shape):
    most = np.maximum(p1, p2)
    impossible = (np.minimum(p1, p2) < 0.0) | (most <= 0.0) | np.isinf(most)
    what = "have a pressure below zero absolute, an infinite one, or none at all: NaN."
    warn_rows(impossible, where, what, stacklevel=4)
    data.warn(where, shape, stacklevel=5)
