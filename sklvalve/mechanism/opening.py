# SPDX-License-Identifier: BSD-3-Clause
"""The opening at which a valve passes a wanted flow."""

from sklvalve.mechanism._opening_search import Trim, opening_for
from sklvalve.mechanism.gas import gas_flow, gas_kv
from sklvalve.mechanism.liquid import WATER_CRITICAL_PRESSURE, liquid_flow, liquid_kv
from sklvalve.mechanism.validity import quiet


def opening_for_flow(
    flow,
    p1,
    p2,
    density,
    *,
    kv_rated,
    characteristic,
    rangeability=None,
    shutoff=0.0,
    leakage=0.0,
    fl=None,
    p_vapour=None,
    p_critical=WATER_CRITICAL_PRESSURE,
    viscosity=None,
    fd=None,
    nominal_size=None,
    inlet_pipe=None,
    outlet_pipe=None,
    strict=False,
    warn=True,
):
    r"""Opening at which a valve passes a flow of liquid between two pressures.

    Parameters
    ----------
    flow : float or array-like
        Wanted volume flow at inlet conditions. [m3/s]
    p1, p2, density, p_vapour, p_critical, viscosity, nominal_size, inlet_pipe, outlet_pipe, strict
        As in `liquid_flow`.
    kv_rated : float
        Flow coefficient of the open valve. [m3/h]
    characteristic, rangeability, shutoff, leakage
        As in `relative_capacity`.
    fl, fd : float, array-like or table, default=None
        As in `liquid_flow`, or a table of pairs opening, factor, see `at_travel`: anything of two dimensions
        with two columns is one. [1]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows that have no answer.

    Returns
    -------
    opening : float or ndarray
        The smallest opening in [0, 1] that passes the flow; NaN where there is no pressure drop, the flow
        runs against it, no opening passes so much or the shut valve lets by more, or no liquid enters. [1]

    Raises
    ------
    ValueError
        As `relative_capacity`, `at_travel` and `liquid_flow`.

    See Also
    --------
    liquid_flow : The flow at an opening.
    installed_characteristic : Where the pressures change with the flow.

    Notes
    -----
    With factors that do not change with travel: `liquid_kv`, then `opening_for_capacity`. With tables the
    flow coefficient and the factors hang on each other through the opening: the first of at least 16 steps
    over the travel in which the flow is reached is narrowed down to rounding, by halving where nothing faster
    is safe. Where F_L falls so fast that the largest flow lies before the end of the travel, that place is
    looked for as well. What goes unseen is a hump narrower than such a step with a higher one behind it.

    Examples
    --------
    A valve that recovers more pressure the further it opens:

    >>> fl = [[0.1, 0.95], [0.5, 0.85], [1.0, 0.6]]
    >>> valve = {"kv_rated": 240.0, "characteristic": "equal_percentage", "rangeability": 50.0}
    >>> opening_for_flow([0.02, 0.08], 680e3, 220e3, 965.4, fl=fl, p_vapour=70.1e3, **valve).round(4)
    array([0.4972, 0.9207])
    """
    trim = Trim(kv_rated, characteristic, rangeability, shutoff, leakage)
    given = {"viscosity": viscosity, "nominal_size": nominal_size}
    given |= {"inlet_pipe": inlet_pipe, "outlet_pipe": outlet_pipe, "p_vapour": p_vapour}
    given = _known(given) | {"p1": p1, "p2": p2, "density": density, "p_critical": p_critical}
    if viscosity is not None:
        given |= {"kv_rated": kv_rated, "strict": strict}
    factors = _known({"fl": fl, "fd": fd})
    with quiet():
        return opening_for(flow, liquid_flow, liquid_kv, trim, given, factors, "opening_for_flow", warn)


def opening_for_gas_flow(
    flow,
    p1,
    p2,
    temperature,
    molar_mass,
    *,
    kv_rated,
    characteristic,
    gamma,
    xt,
    rangeability=None,
    shutoff=0.0,
    leakage=0.0,
    compressibility=1.0,
    basis="mass",
    dynamic_viscosity=None,
    fl=None,
    fd=None,
    nominal_size=None,
    inlet_pipe=None,
    outlet_pipe=None,
    warn=True,
):
    r"""Opening at which a valve passes a flow of gas between two pressures.

    Parameters
    ----------
    flow : float or array-like
        Wanted flow, counted in what `basis` says. [kg/s or m3/s]
    p1, p2, temperature, molar_mass, gamma, compressibility, basis, dynamic_viscosity
        As in `gas_flow`.
    kv_rated : float
        Flow coefficient of the open valve. [m3/h]
    characteristic, rangeability, shutoff, leakage
        As in `relative_capacity`.
    xt, fl, fd : float, array-like or table
        As in `gas_flow`, or a table of pairs opening, factor, as in `opening_for_flow`. [1]
    nominal_size, inlet_pipe, outlet_pipe
        As in `gas_flow`.
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows that have no answer.

    Returns
    -------
    opening : float or ndarray
        As in `opening_for_flow`. [1]

    Raises
    ------
    ValueError
        As `relative_capacity`, `at_travel` and `gas_flow`.

    Notes
    -----
    By `gas_kv` and `opening_for_capacity`; with tables as `opening_for_flow` does it.

    Examples
    --------
    >>> valve = {"kv_rated": 100.0, "characteristic": "linear", "xt": [[0.1, 0.8], [1.0, 0.6]]}
    >>> opening = opening_for_gas_flow(1.0, 680e3, 310e3, 433.0, 0.04401, gamma=1.3, **valve)
    >>> round(float(opening), 3)
    0.276
    """
    trim = Trim(kv_rated, characteristic, rangeability, shutoff, leakage)
    given = {"dynamic_viscosity": dynamic_viscosity, "nominal_size": nominal_size}
    given |= {"inlet_pipe": inlet_pipe, "outlet_pipe": outlet_pipe}
    given = _known(given) | {"p1": p1, "p2": p2, "temperature": temperature, "molar_mass": molar_mass}
    given |= {"gamma": gamma, "compressibility": compressibility, "basis": basis}
    if dynamic_viscosity is not None:
        given |= {"kv_rated": kv_rated}
    factors = _known({"xt": xt, "fl": fl, "fd": fd})
    with quiet():
        return opening_for(flow, gas_flow, gas_kv, trim, given, factors, "opening_for_gas_flow", warn)


def _known(values):
    return {name: value for name, value in values.items() if value is not None}
