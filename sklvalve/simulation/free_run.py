# SPDX-License-Identifier: BSD-3-Clause
"""Free run of the stem: from the command alone, through signal, positioner and actuator."""

from functools import lru_cache

import numpy as np

from sklvalve.recording import InputError
from sklvalve.simulation.electric import electric_stem
from sklvalve.simulation.faults import FAULTS, columns_of_faults
from sklvalve.simulation.stages import delayed, first_order_lag, limited_rate, play
from sklvalve.simulation.stem import positioner_and_actuator

# a quick positioner and a stem that slides: what stands in where no position speaks of them
_IDEAL = {
    "actuator_gain": 8.0,
    "actuator_reset": 1e-3,
    "actuator_rate": 0.9,
    "actuator_coulomb": 1e-3,
    "actuator_feedback": 0.0,
    "actuator_vent": 1.0,
    "actuator_loop": 0.0,
}
_STAGES = ("signal", "actuator")


def key_of_free_run(chain, values):
    """What a free run hangs on: runs of equal keys are the same."""
    own = [tuple((name, values[name]) for name in _of_actuator(tuple(values)))]
    for e in chain.effects:
        stops = e.stops_stem and not chain.electric
        if stops:
            own.append(("link_play", values.get("link_play")))
        if stops or e.stage in _STAGES:
            own.append((e.key, chain.times(e)))
            own += [(p.name, values[f"{e.key}.{p.name}"]) for p in e.parameters]
    return tuple(own)


@lru_cache(maxsize=1000)
def _of_actuator(names):
    """Those of an actuator, in one order whatever that of the names."""
    return tuple(sorted(name for name in names if name.startswith("actuator_")))


def free_run(chain, values, through):
    """Opening to which the actuator drives the stem, from the command.

    Parameters
    ----------
    chain : Chain
    values : dict
        Values of the simulation's parameters.
    through : callable
        The chain's way to let effects change what a stage makes: ``through(stage, made, values)``.

    Returns
    -------
    stem : ndarray of shape (n,)
        Opening [1].

    Raises
    ------
    InputError
        If the recording has no command.
    """
    if chain.command is None:
        raise InputError("the opening cannot be simulated without a command; record it, or leave it out")
    if chain.electric or "actuator_speed" in values:
        return electric_stem(chain, values, through)
    command = delayed(chain.command, chain.time, values["actuator_delay"])
    if "actuator_stroke" in values:
        command = limited_rate(command, chain.step, values["actuator_stroke"], values["actuator_stroke"])
    command = through("signal", command, values)
    if "actuator_gain" not in values and not any(e.stage == "actuator" for e in chain.effects):
        # where nothing speaks of its air a dead band leaves the stem where it came to rest, as play does
        command = play(command, values["actuator_dead_band"]) if "actuator_dead_band" in values else command
        stem = first_order_lag(command, chain.step, values["actuator_filter"], 1.0)
        return np.clip(stem, 0.0, 1.0)
    return _driven_by_air(chain, command, _IDEAL | values, through)


def _driven_by_air(chain, command, values, through):
    n = len(command)
    drive = {
        "supply": np.full(n, chain.supply),
        "coulomb": np.full(n, values["actuator_coulomb"]),
        "stick": np.zeros(n),
        "dead_band": np.full(n, 0.5 * values.get("actuator_dead_band", 0.0)),
    } | dict.fromkeys(FAULTS, 0.0)
    drive = through("actuator", drive, values)
    drive["stop_high" if chain.air_closes else "stop_low"] = chain.lowest(values)
    start = chain.measured[:1] if chain.measured is not None else command[:1]
    start = start[0] if np.isfinite(start[0]) else 0.5
    if chain.air_closes:
        command, start = 1.0 - command, 1.0 - start
    stem = positioner_and_actuator(
        command,
        chain.step,
        start,
        chain.spring,
        chain.atmosphere,
        drive["supply"],
        drive["coulomb"],
        drive["stick"],
        drive["dead_band"],
        columns_of_faults(drive, n),
        values["actuator_filter"],
        values["actuator_gain"],
        values["actuator_reset"],
        values["actuator_rate"],
        values["actuator_feedback"],
        values["actuator_vent"],
        values["actuator_loop"],
    )
    return 1.0 - stem if chain.air_closes else stem
