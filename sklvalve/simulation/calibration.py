# SPDX-License-Identifier: BSD-3-Clause
"""What a data sheet leaves open, and how a recording closes it.

A mis-calibrated simulation differs from its recording everywhere, and every such difference would pass for
missing physics. So the calibration comes first, its reach is the tolerance of a data sheet and no more, and
it is fitted again together with each effect.
"""

import numpy as np

from sklvalve.mechanism.liquid import FLOW_CONSTANT
from sklvalve.recording import InputError
from sklvalve.simulation.declared import declared_delay, declared_parameters
from sklvalve.simulation.electric import is_electric, motor_parameters
from sklvalve.simulation.given import chain_for, given_flow_parameters, given_opening_parameters
from sklvalve.simulation.given_trim import GivenTrim
from sklvalve.simulation.parameters import Parameter
from sklvalve.simulation.trim import LearntTrim, SheetTrim


def channels_of(recording):
    """Signals that a simulation of this recording can be judged by: opening, flow, or both."""
    found = tuple(
        role
        for role in ("opening", "flow")
        if role in recording and (role == "flow" or {"command", "simulated_opening"} & set(recording))
    )
    if "flow" in found and not {"opening", "command", "simulated_flow"} & set(recording):
        found = ()
    if not found:
        raise InputError(
            f"{recording.source}: a diagnosis needs an opening beside the command, or a flow beside a "
            f"command or an opening; the recording holds {', '.join(recording)}: name these roles in "
            "valve.toml"
        )
    return found


def choose_trim(recording, valve, tolerance):
    """Trim of the sheet within its tolerance, or one to be learnt where it cannot be held against the flow.

    That is where the sheet has none, and where pressures were not recorded: what drives the flow then falls
    as the valve opens, by as much as pump and line have it, and the sheet's curve does not show in the flow.
    """
    if "flow" not in recording:
        return LearntTrim(np.array([0.0, 1.0]), 1.0, knots=(0.0, 1.0))
    if "simulated_flow" in recording:
        chain = chain_for(recording, valve, None, choking="choked_flow" in valve.physics)
        return GivenTrim.of(chain.given_capacity, recording, valve, tolerance)
    if drop_is_unknown(recording) or valve.characteristic in (None, "unknown"):
        opening = recording.get("opening")
        opening = recording["command"] if opening is None else opening
        return LearntTrim(opening, _kv_scale(recording, valve))
    return SheetTrim(valve, tolerance, _kv_scale(recording, valve))


def drop_is_unknown(recording):
    """Whether nothing tells the pressure drop: no pressures, and no simulated flow that knows of them."""
    return not ({"p1", "p2"} <= set(recording) or "simulated_flow" in recording)


def apparent_kv(recording):
    """Capacity that each row shows by the plain turbulent equation [m3/h]; NaN where there is no drop."""
    flow = recording["flow"]
    drop = np.full(len(flow), 1e5)
    if "p1" in recording and "p2" in recording:
        drop = np.abs(recording["p1"] - recording["p2"])
    density = 1000.0
    volume = flow / density if recording.mass_flow else flow
    with np.errstate(divide="ignore", invalid="ignore"):
        kv = volume / (FLOW_CONSTANT * np.sqrt(drop / density))
    return np.where(drop > 1e-3 * np.nanmax(drop), kv, np.nan)


def _kv_scale(recording, valve):
    """Largest capacity that the recording shows [m3/h]."""
    if valve.kv_rated is not None and not drop_is_unknown(recording):
        return valve.kv_rated
    kv = apparent_kv(recording)
    kv = kv[np.isfinite(kv)]
    if not len(kv) or np.quantile(kv, 0.99) <= 0.0:
        raise InputError(
            f"{recording.source}: no row has flow and pressure drop both above zero, so no capacity can be "
            "estimated; check the units and the order of p1 and p2"
        )
    return float(np.quantile(kv, 0.99))


def span_of(values):
    """Span of a signal: what it reaches in the recording, outliers left out."""
    seen = values[np.isfinite(values)]
    return float(np.quantile(np.abs(seen), 0.995)) if len(seen) else 1.0


def spans_of(recording, roles=None):
    """Role -> span of its signal [SI], of all roles unless some are given; of an opening the travel."""
    roles = recording if roles is None else roles
    return {role: 1.0 if role == "opening" else span_of(recording[role]) for role in roles}


def calibration_parameters(chain, tolerance, channels):
    """Parameters that the data sheet leaves open for some channels.

    Parameters
    ----------
    chain : Chain
        The simulation without what is judged.
    tolerance : Tolerance
    channels : sequence of {"opening", "flow"}

    Returns
    -------
    parameters : list of Parameter
    """
    recording, valve, parameters = chain.recording, chain.valve, []
    if "opening" in channels or "opening" not in recording:
        parameters += opening_parameters(recording, valve, tolerance)
    if "flow" in channels:
        choking = chain.choking and chain.margin is not None
        parameters += flow_parameters(recording, valve, tolerance, chain.trim, choking=choking)
    return parameters


def sound_play(recording, tolerance, channels):
    """Parameters of the play that a sound valve has: in the linkage, and between stem and plug.

    A data sheet leaves as much open, and calibration to one recording takes none of it: there play is told
    by its size. Only a history says how much of it was there before.

    Parameters
    ----------
    recording : Recording
    tolerance : Tolerance
    channels : sequence of {"opening", "flow"}
        Those that are to tell it.

    Returns
    -------
    parameters : list of Parameter
    """
    most, found = tolerance.play, []

    def width(name):
        return Parameter(name, "1", 0.0, most, 0.1 * most, spread=0.3 * most)

    if "opening" in channels and "simulated_opening" not in recording:
        found.append(width("link_play"))
    if "flow" in channels and "simulated_flow" not in recording:
        found += [width("plug_play"), Parameter("plug_overshoot", "1", 0.0, 0.3, 0.03, spread=0.05)]
    return found


def opening_parameters(recording, valve, tolerance):
    """Parameters of positioner, actuator and position sensor that stay open."""
    if "simulated_opening" in recording:
        return given_opening_parameters(recording, tolerance)
    if "simulated_flow" in recording and "opening" not in recording:
        return ()
    electric = is_electric(valve, recording)
    found = list(motor_parameters(tolerance, valve)) if electric else _air_parameters(recording, tolerance)
    found += declared_parameters(tolerance, valve, electric=electric)
    # a few scans may lie between a command and its effect
    longest = float(np.nanmax([recording.slice(*span).sample_time for span in recording.spans]))
    scan = min(2.0 * longest, tolerance.response)
    found.append(declared_delay(tolerance, valve, scan))
    if "opening" in recording:
        zero = tolerance.position_zero
        found.append(Parameter("position_zero", "1", -zero, zero, 0.0, spread=0.5 * zero))
    return tuple(found)


def _air_parameters(recording, tolerance):
    found = [
        Parameter("actuator_filter", "s", 0.02, tolerance.response, 0.1, spread=1.5, log=True),
    ]
    # without a recorded position no signal speaks of what goes on inside positioner and actuator
    if "opening" not in recording:
        return found
    return [
        *found,
        Parameter("actuator_gain", "1", 1.0, 60.0, 15.0, spread=1.5, log=True),
        Parameter("actuator_reset", "1/s", 1e-3, 10.0, 0.3, spread=3.0, log=True),
        # at the lowest the chamber fills for a whole stroke in about the response time
        Parameter("actuator_rate", "1/s", 0.9 / tolerance.response, 10.0, 1.0, spread=1.5, log=True),
        # friction and pressure feedback that keep the static error within its tolerance
        Parameter("actuator_coulomb", "1", 1e-3, 2.5 * tolerance.static_error, 0.008, spread=1.0, log=True),
        Parameter("actuator_feedback", "1", 0.0, 0.25, 0.1, spread=0.1),
        # spools fill and vent through ports of their own, and a stroke up seldom takes as long as one down
        Parameter("actuator_vent", "1", 0.6, 1.7, 1.0, spread=0.2, log=True),
        Parameter("actuator_loop", "s", 0.04, 0.4, 0.06, spread=0.7, log=True),
    ]


def flow_parameters(recording, valve, tolerance, trim, *, choking):
    """Parameters of trim, choking, pressures and meter that stay open."""
    if "simulated_flow" in recording:
        found = given_flow_parameters(recording, tolerance, span_of(recording["flow"]))
        choked = _choking(tolerance) if choking else ()
        return (*found, *trim.all_parameters(), *_zero_of_drop(recording, tolerance), *choked)
    zero = tolerance.flow_zero * span_of(recording["flow"])
    found = [
        *trim.all_parameters(),
        Parameter("meter_lag", "s", 0.02, tolerance.response, 0.7, spread=1.5, log=True),
        Parameter("meter_ahead", "1", 0.0, 1.0, 0.5, spread=0.3),
        Parameter("flow_zero", "m3/s", -zero, zero, 0.0, spread=0.5 * zero),
    ]
    if "opening" in recording:
        shift = tolerance.position_zero
        found.append(Parameter("stem_zero", "1", -shift, shift, 0.0, spread=0.25 * shift))
    found += _zero_of_drop(recording, tolerance)
    return (*found, *(_choking(tolerance) if choking else ()))


def _choking(tolerance):
    low, high = 1.0 - tolerance.recovery, 1.0 + tolerance.recovery
    return (
        Parameter("fl_scale", "1", low, high, 1.0, spread=0.5 * tolerance.recovery),
        Parameter("fl_slope", "1", 0.0, 2.0 * tolerance.recovery, 0.05, spread=0.05),
        Parameter("knee", "1", 3.0, 40.0, 12.0, spread=0.7, log=True),
    )


def _zero_of_drop(recording, tolerance):
    if not {"p1", "p2"} <= set(recording):
        return []
    drop = tolerance.pressure_zero * span_of(recording["p1"])
    return [Parameter("dp_zero", "Pa", -drop, drop, 0.0, spread=0.5 * drop)]
