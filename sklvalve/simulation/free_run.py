# SPDX-License-Identifier: BSD-3-Clause
"""Free run of the stem: from the command alone, through signal, positioner and actuator."""

from functools import lru_cache
from operator import eq
from typing import NamedTuple

import numpy as np

from sklvalve.recording import InputError
from sklvalve.simulation.electric import electric_stem
from sklvalve.simulation.faults import FAULTS, columns_of_faults
from sklvalve.simulation.stages import delayed, first_order_lag, limited_rate, play
from sklvalve.simulation.stem import NARROW, WIDE, positioner_and_actuator, stem_with_slopes

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
# in the order in which the scan takes them
_DRIVE = ("supply", "coulomb", "stick", "dead_band")
_COLUMNS = (*_DRIVE, *FAULTS)
_NUMBERS = ("filter", "gain", "reset", "rate", "feedback", "vent", "loop")
# beside those of effects, what the command that arrives hangs on, and what drives the stem
_OF_SIGNAL = ("actuator_delay", "actuator_stroke")
_OF_DRIVE = ("actuator_coulomb", "actuator_dead_band")


def key_of_free_run(chain, values):
    """What a free run hangs on: runs of equal keys are the same."""
    own = [tuple((name, values[name]) for name in _of_actuator(tuple(values)))]
    for e in chain.effects:
        if e.stage in _STAGES:
            own.append((e.key, chain.onsets.get(e.key)))
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
    if _by_motor(chain, values):
        return electric_stem(chain, values, through)
    command = _signal(chain, values, through)
    if not _by_air(chain, values):
        # where nothing speaks of its air a dead band leaves the stem where it came to rest, as play does
        command = play(command, values["actuator_dead_band"]) if "actuator_dead_band" in values else command
        stem = first_order_lag(command, chain.step, values["actuator_filter"], 1.0)
        return np.clip(stem, 0.0, 1.0)
    asked = _Asked.of(chain, values, through)
    stem = positioner_and_actuator(
        asked.command, chain.step, asked.start, chain.spring, chain.atmosphere, *asked.columns(_DRIVE),
        columns_of_faults(asked.drive, len(command)), *asked.numbers,
    )  # fmt: skip
    return 1.0 - stem if chain.air_closes else stem


def slopes_of_free_run(chain, values, several, reach, through):
    """Derivatives of a free run, where compiled code carries them along.

    Parameters
    ----------
    chain, values, through
        As in `free_run`.
    several : list of dict
        Values beside these, one step in one parameter each.
    reach : sequence of float
        Length of each step.

    Returns
    -------
    slopes : ndarray of shape (len(several), n), or None
        Change of the stem [1] for a step of one; None where a run has no derivatives of its own.

    Notes
    -----
    What the effects make of command and drive, row by row, is asked beside `values`; what the scan along time
    makes of that is differentiated as it runs.
    """
    if chain.command is None or _by_motor(chain, values) or not _by_air(chain, values):
        return None
    base = _Asked.of(chain, values, through)
    towards = [
        base.towards(_Asked.of(chain, beside, through, base), r)
        for beside, r in zip(several, reach, strict=True)
    ]
    width = WIDE if len(towards) > NARROW else NARROW
    found = [
        _slopes_of_a_few(chain, base, towards[first : first + width], (0,) * width)
        for first in range(0, len(towards), width)
    ]
    slopes = np.concatenate(found)
    return -slopes if chain.air_closes else slopes


def _slopes_of_a_few(chain, base, towards, like):
    """Slopes by no more parameters than one scan takes."""
    n, rows = len(chain.step), []
    for column in range(1 + len(_COLUMNS)):
        changes = [(i, changed[column]) for i, (changed, _) in enumerate(towards) if column in changed]
        made = np.zeros((n if changes else 1, len(like)))
        for i, change in changes:
            made[:, i] = change
        rows.append(made)
    numbers = np.zeros((len(base.numbers), len(like)))
    for i, (_, moved) in enumerate(towards):
        numbers[:, i] = moved
    faults = columns_of_faults(base.drive, n)
    _, slopes = stem_with_slopes(
        base.command, chain.step, base.start, chain.spring, chain.atmosphere, *base.columns(_DRIVE),
        faults if len(faults) else np.zeros((1, len(FAULTS))), np.array(base.numbers), tuple(rows), numbers,
        like,
    )  # fmt: skip
    return slopes.T[: len(towards)]


def _by_motor(chain, values):
    return chain.electric or "actuator_speed" in values


def _by_air(chain, values):
    return "actuator_gain" in values or any(e.stage == "actuator" for e in chain.effects)


def _signal(chain, values, through):
    """Command as it reaches the positioner [1]."""
    command = delayed(chain.command, chain.time, values["actuator_delay"])
    if "actuator_stroke" in values:
        command = limited_rate(command, chain.step, values["actuator_stroke"], values["actuator_stroke"])
    return through("signal", command, values)


class _Asked(NamedTuple):
    """What the scan of a stem driven by air is asked with, and what each part of it hangs on."""

    command: np.ndarray
    start: float
    drive: dict
    numbers: tuple
    signs: tuple

    @classmethod
    def of(cls, chain, values, through, beside=None):
        """For these values; what they do not change is taken from what was asked `beside` them."""
        values = _IDEAL | values
        signs = _sign(chain, values, "signal", _OF_SIGNAL), _sign(chain, values, "actuator", _OF_DRIVE)
        numbers = tuple(values[f"actuator_{name}"] for name in _NUMBERS)
        same = (False, False) if beside is None else tuple(map(eq, signs, beside.signs))
        if same[0]:
            command, start = beside.command, beside.start
        else:
            command = _signal(chain, values, through)
            start = chain.measured[0] if chain.measured is not None else command[0]
            start = start if np.isfinite(start) else 0.5
            if chain.air_closes:
                command, start = 1.0 - command, 1.0 - start
        drive = beside.drive if same[1] else _drive(chain, values, through)
        return cls(command, start, drive, numbers, signs)

    def columns(self, names):
        """Of the drive, each as long as the recording."""
        return [np.broadcast_to(self.drive[name], len(self.command)) for name in names]

    def towards(self, other, reach):
        """Changes for a step of one where `reach` leads to another: columns by their places, numbers."""
        changed = {}
        if other.command is not self.command:
            # a gap in the command is one beside it as well
            changed[0] = np.nan_to_num((other.command - self.command) / reach)
        for place, name in enumerate(_COLUMNS, 1):
            here, there = self.drive[name], other.drive[name]
            if there is not here and not np.array_equal(here, there):
                changed[place] = (there - here) / reach
        return changed, (np.array(other.numbers) - self.numbers) / reach


def _sign(chain, values, stage, names):
    """What the effects on a stage, and those values named, make of it."""
    own = [values.get(name) for name in names]
    for e in chain.effects:
        if e.stage == stage:
            own += [values[f"{e.key}.{p.name}"] for p in e.parameters]
    return tuple(own)


def _drive(chain, values, through):
    """What drives and brakes the stem, by name: an array for each row, or a number for all."""
    n = len(chain.step)
    sound = {
        "supply": np.full(n, chain.supply),
        "coulomb": np.full(n, values["actuator_coulomb"]),
        "stick": np.zeros(n),
        "dead_band": np.full(n, 0.5 * values.get("actuator_dead_band", 0.0)),
    }
    return through("actuator", sound | dict.fromkeys(FAULTS, 0.0), values)
