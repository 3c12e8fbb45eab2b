# SPDX-License-Identifier: BSD-3-Clause
"""Which regime the flow of a liquid through a valve is in, as a code for each row."""

import numpy as np

from sklvalve.mechanism._constants import LAMINAR_REYNOLDS, TURBULENT_REYNOLDS
from sklvalve.mechanism._liquid_inputs import Screen
from sklvalve.mechanism._liquid_valve import LiquidValve
from sklvalve.mechanism.cavitation import incipient_xfz, pressure_ratio_xf
from sklvalve.mechanism.choking import WATER_CRITICAL_PRESSURE, choked_limit, floats, with_choking
from sklvalve.mechanism.liquid import liquid_flow
from sklvalve.mechanism.validity import quiet

LIQUID_STATES = {
    -2: "unknown",
    -1: "infeasible",
    0: "no flow",
    1: "laminar",
    2: "transitional",
    3: "turbulent",
    4: "incipient cavitation",
    5: "choked",
    6: "flashing",
}
"""Codes of `liquid_state` and their names; the further down a row, the harder the duty."""


def liquid_state(
    kv,
    p1,
    p2,
    density,
    *,
    fl=None,
    p_vapour=None,
    p_critical=WATER_CRITICAL_PRESSURE,
    xfz=None,
    viscosity=None,
    fd=None,
    kv_rated=None,
    nominal_size=None,
    inlet_pipe=None,
    outlet_pipe=None,
    strict=False,
):
    """State of the flow of a liquid through a valve.

    Parameters
    ----------
    kv, p1, p2, density, fl, p_vapour, p_critical
        As in `liquid_flow`.
    xfz : float or array-like, default=None
        Differential pressure ratio at which cavitation begins at `p1`. None takes `incipient_xfz` where `fl`
        and `fd` are given, and else tells no incipient cavitation. [1]
    viscosity, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict
        As in `liquid_flow`.

    Returns
    -------
    state : int or ndarray of int8
        Code, with its name in ``LIQUID_STATES``:

        - -2 unknown: a datum is NaN, infinite or senseless as in `liquid_flow`, or `kv` is negative;
        - -1 infeasible: the liquid boils before the valve so far that none enters, or no flow satisfies the
          equations;
        - 0 no flow: no pressure drop, or the valve shut;
        - 1 laminar, 2 transitional, 3 turbulent: valve Reynolds number below 10, below 10 000, above;
        - 4 incipient cavitation: x_F from x_Fz on;
        - 5 choked: pressure drop from its choked value on, so that the valve cavitates fully;
        - 6 flashing: pressure behind the valve below the vapour pressure, so that the vapour stays.

        The highest that holds. What was not given is not looked for: without `viscosity` flow is turbulent,
        without `p_vapour` nothing cavitates.

    Raises
    ------
    ValueError
        As in `liquid_flow`.

    Notes
    -----
    For flow backwards the sides of the valve swap roles. No warning: the codes say it row by row.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.
    .. [2] IEC 60534-8-4, Industrial-process control valves: prediction of noise from hydrodynamic flow.

    Examples
    --------
    >>> p2 = [680e3, 650e3, 400e3, 150e3, 50e3]
    >>> code = liquid_state(165.0, 680e3, p2, 965.4, fl=0.9, fd=0.46, p_vapour=70.1e3)
    >>> [LIQUID_STATES[c] for c in code]
    ['no flow', 'turbulent', 'incipient cavitation', 'choked', 'flashing']
    """
    kv, p1, p2, density = floats(kv, p1, p2, density)
    valve = LiquidValve(fl, viscosity, fd, kv_rated, nominal_size, inlet_pipe, outlet_pipe, strict)
    chokes = with_choking(fl, p_vapour, valve.viscous)
    screen = Screen(valve)
    p1, p2 = screen.pressures(p1, p2)
    if p_vapour is not None:
        p_vapour, p_critical = screen.boiling(p_vapour, p_critical)
    # a factor that only tells where cavitation begins must be known too
    used = [value for value in (valve.fl, valve.fd) if p_vapour is not None and value is not None]
    used += [kv, p1, p2, density, *([] if p_vapour is None else [p_vapour, p_critical])]
    given = valve.known() & (density > 0.0) & (kv >= 0.0)
    for value in used:
        given = given & np.isfinite(value)
    known = {"p_vapour": p_vapour, "p_critical": p_critical} if chokes else {}
    with quiet():
        flow = _flow(kv, p1, p2, density, valve, known)
        rungs = _rungs(kv, p1, p2, density, valve, known, flow, p_vapour, xfz)
    rungs += [((p1 == p2) | (kv == 0.0), 0), (np.isnan(flow), -1), (~given, -2)]
    state = np.full(np.broadcast_shapes(*(np.shape(which) for which, _ in rungs)), 3, dtype=np.int8)
    for which, code in rungs:
        state[np.broadcast_to(which, state.shape)] = code
    return state[()]


def _flow(kv, p1, p2, density, valve, known):
    data = valve.given() | {"strict": valve.strict}
    if not (known or valve.viscous):
        data.pop("fl", None)
    return liquid_flow(kv, p1, p2, density, **data, **known, warn=False)


def _rungs(kv, p1, p2, density, valve, known, flow, p_vapour, xfz):
    """Where each state holds, and its code, the hardest last."""
    upstream, drop, backward = np.maximum(p1, p2), np.abs(p1 - p2), p2 > p1
    fl, fd = valve.fl, valve.fd
    rungs = []
    if valve.viscous:
        reynolds = valve.reynolds(flow, kv, backward)
        rungs += [(reynolds < TURBULENT_REYNOLDS, 2), (reynolds < LAMINAR_REYNOLDS, 1)]
    if p_vapour is not None:
        if xfz is None and fl is not None and fd is not None:
            xfz = incipient_xfz(np.abs(kv), fl, fd, p1=upstream)
        if xfz is not None:
            rungs.append((pressure_ratio_xf(p1, p2, p_vapour, warn=False) >= np.asarray(xfz), 4))
        if known:

            def turbulent(kv, fl):
                return liquid_flow(kv, p1, p2, density, fl=fl, **known, warn=False)

            recovery = valve.recovery_in(turbulent, kv, backward)
            rungs.append((drop >= choked_limit(upstream, recovery, **known), 5))
        rungs.append((np.minimum(p1, p2) < p_vapour, 6))
    return rungs
