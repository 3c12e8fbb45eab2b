# SPDX-License-Identifier: BSD-3-Clause
"""In which state the gas in a valve flows."""

import numpy as np

from sklvalve.mechanism._constants import LAMINAR_REYNOLDS, TURBULENT_REYNOLDS
from sklvalve.mechanism.gas import gas_flow
from sklvalve.mechanism.gas_inputs import valve_of
from sklvalve.mechanism.gas_units import gas_mass_flow
from sklvalve.mechanism.gas_viscous import jet_of
from sklvalve.mechanism.liquid import floats
from sklvalve.mechanism.states import LIQUID_STATES

# no gas boils in a valve
_OF_LIQUIDS_ALONE = ("incipient cavitation", "flashing")

GAS_STATES = {code: name for code, name in LIQUID_STATES.items() if name not in _OF_LIQUIDS_ALONE}
"""Codes of `gas_state` and their names; a gas and a liquid have the same code in the same state."""

_CODE = {name: code for code, name in GAS_STATES.items()}


def gas_state(
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
):
    r"""State of the flow of a gas through a valve.

    Parameters
    ----------
    kv, p1, p2, temperature, molar_mass, gamma, xt, compressibility
        As in `gas_flow`.
    basis : {"mass", "actual", "normal", "standard"}, default="mass"
        What the flow is counted in; matters only for the constant that `strict` takes.
    dynamic_viscosity, fl, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict
        As in `gas_flow`.

    Returns
    -------
    state : int or ndarray of int8
        Code, with its name in ``GAS_STATES``:

        - -2 unknown: a datum is NaN or senseless;
        - -1 infeasible: the reducers would give back more than the valve takes;
        - 0 no flow: no pressure drop, or the valve shut;
        - 1 laminar, 2 transitional: valve Reynolds number below 10, below 10 000; looked for only with
          `dynamic_viscosity`;
        - 3 turbulent, and the flow still grows as the pressure behind the valve falls;
        - 5 choked: turbulent, and it does not, :math:`x \ge F_\gamma x_{TP}`.

    Raises
    ------
    ValueError
        As `gas_flow`.

    Notes
    -----
    For flow backwards the sides of the valve swap roles. No warning: the codes say it row by row.

    Examples
    --------
    >>> gas_state(10.0, 6e5, [6e5, 5e5, 1e5], 300.0, 0.029, gamma=1.4, xt=0.7)
    array([0, 3, 5], dtype=int8)
    """
    known = {"dynamic_viscosity": dynamic_viscosity, "fl": fl, "fd": fd, "kv_rated": kv_rated}
    pipes = {"nominal_size": nominal_size, "inlet_pipe": inlet_pipe, "outlet_pipe": outlet_pipe}
    gas = {"gamma": gamma, "xt": xt, "compressibility": compressibility, "basis": basis, "strict": strict}
    flow = gas_flow(kv, p1, p2, temperature, molar_mass, warn=False, **gas, **known, **pipes)
    kv, p1, p2 = floats(kv, p1, p2)
    with np.errstate(all="ignore"):
        backward = p2 > p1
        valve = valve_of(gamma, xt, backward, **pipes)
        jet = jet_of(backward=backward, **known, **pipes)
        x = np.abs(p1 - p2) / np.maximum(p1, p2)
        capacity, x_choked = valve.at(kv)
        mass = gas_mass_flow(flow, basis, np.maximum(p1, p2), temperature, molar_mass, compressibility)
        reynolds = np.inf if jet is None else jet.reynolds(mass, kv)
        rules = {
            "infeasible": np.isnan(capacity) & ~np.isnan(kv + valve.fittings + valve.inlet),
            "unknown": np.isnan(flow),
            "no flow": flow == 0.0,
            "laminar": reynolds < LAMINAR_REYNOLDS,
            "transitional": reynolds < TURBULENT_REYNOLDS,
            "choked": x >= x_choked,
        }
    met = [np.broadcast_to(rule, np.shape(flow)) for rule in rules.values()]
    return np.select(met, [_CODE[name] for name in rules], _CODE["turbulent"]).astype(np.int8)[()]
