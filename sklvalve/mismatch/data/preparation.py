# SPDX-License-Identifier: BSD-3-Clause
"""What a finder is given, checked, and laid out on the problem."""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from dataclasses import replace
from numbers import Integral
from typing import Any

from sklvalve.history import ValveHistory
from sklvalve.mismatch.data.gate import effects_switched_off, redraws_the_flow
from sklvalve.mismatch.effects import CATALOGUE, Effect
from sklvalve.mismatch.effects.gas_expansion import GasExpansion
from sklvalve.mismatch.effects.spring_fault import knows_air
from sklvalve.mismatch.inference.hypothesis import Term, begun, is_in
from sklvalve.mismatch.inference.problem import Problem
from sklvalve.recording import InputError, Recording
from sklvalve.recording.diagnosable import require_rows
from sklvalve.simulation import Tolerance, ValveSimulation
from sklvalve.simulation.calibration import drop_is_unknown
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.going_on import going_on

_NAMES = tuple(sorted({e.name for e in CATALOGUE}))


def rows_to_use(whole: Recording, until: int | None) -> int:
    """Number of rows of a recording that serve for finding.

    Raises
    ------
    InputError
        If `until` is no number of rows, or leaves too few.
    """
    if until is not None and (not isinstance(until, Integral) or isinstance(until, bool)):
        raise InputError(
            f"until must be a number of rows, got {until!r}; recording.index_until gives it for a time"
        )
    if until is not None and until < 0:
        raise InputError(f"until must be a number of rows, 0 or more; got {until}")
    used = len(whole) if until is None else min(int(until), len(whole))
    require_rows(whole.slice(0, used), "" if until is None else ", or a later time to use them until")
    return used


def prepared_problem(
    recording: Recording,
    simulation: ValveSimulation | None = None,
    tolerance: Tolerance | None = None,
    trim: Any = None,
    history: ValveHistory | None = None,
) -> Problem:
    """Problem for a recording and, where one is given, the simulation that it is to be held against.

    The simulation's own sheet, tolerance, effects and onsets count; where it was fitted, the values of its
    effects are where the calibration begins. How the signals are recorded is the recording's matter.

    Parameters
    ----------
    recording : Recording
    simulation : ValveSimulation, default=None
    tolerance : Tolerance, default=None
        Goes before that of the simulation.
    trim : Trim, default=None
        The one that the recording calls for unless given.
    history : ValveHistory, default=None
        Fitted, of the same valve: its trim goes before that of the sheet, and the effects that it was learnt
        with are held beside those of the simulation.

    Returns
    -------
    problem : Problem

    Raises
    ------
    InputError
        If the sheet or the simulation names what is no effect, or an effect needs a role that is missing.
    """
    valve = recording.valve
    if simulation is not None:
        tolerance = tolerance or simulation.tolerance
        if simulation.valve is not None:
            valve = replace(simulation.valve, roles=valve.roles, time=valve.time)
    held, values = _held_by([holder for holder in (simulation, history) if holder is not None], recording)
    strange = [name for name in valve.physics if name not in _NAMES]
    if strange:
        raise InputError(
            f"{valve.source}: [simulation] physics names {strange[0]!r}, which is no effect; "
            f"the effects are {', '.join(_NAMES)}"
        )
    tolerance = tolerance or Tolerance()
    if history is not None:
        # the play of this valve is in its history's calibration: what is more is a change
        tolerance = replace(tolerance, play=0.0)
    trim = history.trim_ if history is not None else trim
    return Problem.of(
        recording,
        tolerance,
        valve.physics,
        valve=valve,
        trim=trim,
        held=held,
        held_values=values,
        history=history,
    )


def _held_by(
    holders: Iterable[ValveSimulation | ValveHistory], recording: Recording
) -> tuple[tuple[Term, ...], dict[str, float]]:
    """Effects that are held, and the values of theirs to begin with; the last one's go before the others'."""
    held: tuple[Term, ...] = ()
    values: dict[str, float] = {}
    for holder in holders:
        terms = _held(holder, recording)
        held = (*(m for m in held if not is_in(m.effect, terms)), *terms)
        keys = tuple(f"{m.effect.key}." for m in terms)
        known = getattr(holder, "values_", {})
        values |= {name: value for name, value in known.items() if keys and name.startswith(keys)}
    return held, values


def _held(simulation: ValveSimulation | ValveHistory, recording: Recording) -> tuple[Term, ...]:
    _require_able(simulation, recording)
    onsets = simulation.onsets or {}
    if isinstance(simulation, ValveHistory):
        # a later recording has from its first row on what began in the history
        growing = {effect.key for effect in simulation.effects if effect.grows}
        onsets = {key: times for key, times in onsets.items() if key in growing}
    times = going_on(simulation.effects, onsets, getattr(simulation, "seen_", None), recording)
    return tuple(begun(effect, times.get(effect.key)) for effect in simulation.effects)


def _require_able(simulation: ValveSimulation | ValveHistory, recording: Recording) -> None:
    """Refuse effects that are none, that need what is not recorded, and onsets of others."""
    what = "history" if isinstance(simulation, ValveHistory) else "simulation"
    for effect in simulation.effects:
        if not isinstance(effect, Effect):
            raise InputError(
                f"the effects of a {what} are objects of the catalogue sklvalve.mismatch.CATALOGUE; "
                f"got {effect!r}"
            )
        missing = [role for role in effect.needs if role not in recording]
        if missing:
            raise InputError(
                f"{recording.source}: the {what} given holds {effect.name}, which needs "
                f"{' and '.join(missing)}; record it, or leave the effect out of the {what}"
            )
    keys = {effect.key for effect in simulation.effects}
    strange = sorted(set(simulation.onsets or {}) - keys)
    if strange:
        raise InputError(
            f"the {what} given has an onset for {strange[0]!r}, which is none of its effects "
            f"({', '.join(sorted(keys)) or 'it has none'})"
        )


def lasting(terms: Iterable[Term], recording: Recording) -> list[Term]:
    """Terms found in a history that a later recording may be taken to have as well.

    What grows, or comes and goes, is another size in every recording. Where nobody knows how far apart
    recordings are that were joined, an onset tells nothing of any of them alone.

    Parameters
    ----------
    terms : iterable of Term
    recording : Recording
        In which they were found.

    Returns
    -------
    terms : list of Term
    """
    assumed = any(piece.assumed for piece in recording.pieces)
    steady = [term for term in terms if not term.effect.grows and not term.switches]
    return [term for term in steady if term.onset is None or not assumed]


def _made_by_the_drop(problem: Problem) -> tuple[str, ...]:
    """`by_drop` of effects that a pressure drop which nobody recorded would make just as well."""
    if "flow" not in problem.channels or not drop_is_unknown(problem.recording):
        return ()
    return ("always", "unseen") if problem.coupled else ("always",)


def _knows_drive(chain: Chain) -> bool:
    """Whether what goes on inside an actuator can be simulated without its position."""
    return chain.electric or knows_air(chain)


def _throughout(effect: Effect) -> Effect:
    """The same effect, there from the first row on or not at all."""
    steady = copy(effect)
    steady.may_begin = False
    return steady


def candidates(
    problem: Problem, wanted: str | Iterable[str | Effect], data: list[dict[str, Any]]
) -> tuple[list[Effect], list[dict[str, Any]]]:
    """Effects of the catalogue that a recording can speak for, and what the others would need.

    Parameters
    ----------
    problem : Problem
    wanted : "all", str or sequence of str and Effect
        Names to be considered, and effects of the caller's own.
    data : list of dict
        Findings of `screen_recording`.

    Returns
    -------
    testable : list of Effect
    not_testable : list of dict
        ``name`` and ``needs``; and ``applies``, which is False, of what this fluid or actuator cannot have.

    Raises
    ------
    InputError
        If a name is no effect.
    """
    asked, names = _asked(wanted)
    off = effects_switched_off(data, asked)
    # what the opening shows is not hidden by a flow that was drawn anew
    off_the_stem = effects_switched_off([each for each in data if not redraws_the_flow(each)], asked)
    by_the_drop = _made_by_the_drop(problem)
    testable: list[Effect] = []
    untestable: dict[str, str] = {}
    for effect in asked:
        # what the simulation holds already is calibrated, so it cannot be missing
        if effect.name not in names or is_in(effect, problem.held):
            continue
        touched = problem.channels_touched(effect)
        hidden = off_the_stem if "opening" in touched else off
        obstacle = _obstacle(problem, effect, touched, hidden, by_the_drop)
        if obstacle is not None:
            untestable.setdefault(effect.name, obstacle)
        else:
            # what it does to a flow from a moment on, a drop does that changes then
            steady = by_the_drop and touched == ("flow",) and effect.by_drop == "onset"
            testable.append(_throughout(effect) if steady else effect)
    return testable, _not_testable(problem.plain, testable, untestable)


def hidden_by_data(
    problem: Problem, wanted: str | Iterable[str | Effect], testable: Iterable[Effect]
) -> list[Effect]:
    """Effects that a valve may have, and a recording cannot speak for because of what is wrong with its data.

    None of them is searched for. But what was found may be one of them: they stand in its place all the same.

    Parameters
    ----------
    problem, wanted
        As `candidates` takes them.
    testable : iterable of Effect
        Those that it gives.

    Returns
    -------
    hidden : list of Effect
    """
    seen = {effect.key for effect in testable}
    return [effect for effect in candidates(problem, wanted, [])[0] if effect.key not in seen]


def _asked(wanted: str | Iterable[str | Effect]) -> tuple[tuple[Effect, ...], set[str]]:
    """Effects of the catalogue and the caller's own, and the names of those to be considered."""
    wanted = [wanted] if isinstance(wanted, str) else list(wanted)
    added = tuple(w for w in wanted if isinstance(w, Effect))
    names = {w for w in wanted if not isinstance(w, Effect)}
    if "all" in names:
        names = names - {"all"} | set(_NAMES)
    strange = sorted(map(str, names - set(_NAMES)))
    if strange:
        raise InputError(
            f"effects names {strange[0]!r}, which is no effect; the effects are {', '.join(_NAMES)}"
        )
    return (*CATALOGUE, *(e for e in added if e not in CATALOGUE)), names | {e.name for e in added}


def _obstacle(
    problem: Problem,
    effect: Effect,
    touched: tuple[str, ...],
    hidden: dict[str, str],
    by_the_drop: tuple[str, ...],
) -> str | None:
    """What a recording would need to speak for an effect; None where it does."""
    missing = [role for role in effect.needs if role not in problem.recording]
    if missing:
        return " and ".join(missing)
    if effect.by_drop in by_the_drop:
        return "p1 and p2"
    if effect.name in hidden:
        return hidden[effect.name]
    if problem.plain.lacks(effect):
        return problem.plain.lacks(effect)
    if effect.stage == "actuator" and problem.coupled and not _knows_drive(problem.plain):
        # what goes on inside an actuator of which neither sheet nor signal tells cannot be simulated
        return "a recorded opening, or a data sheet of the actuator"
    return None if effect.possible(problem.plain) and touched else effect.requires


def _not_testable(
    chain: Chain, testable: Iterable[Effect], untestable: dict[str, str]
) -> list[dict[str, Any]]:
    """Effects that cannot be tested in any form, with what they need."""
    tested, never = {e.name for e in testable}, _never(chain)
    lacking = [{"name": n, "needs": w} for n, w in untestable.items() if n not in tested]
    return [
        each | ({"needs": never[each["name"]], "applies": False} if each["name"] in never else {})
        for each in lacking
    ]


def _never(chain: Chain) -> dict[str, str]:
    """Effects that a valve of this fluid and actuator cannot have, and what it would have to have."""
    fluid = "gas" if GasExpansion().possible(chain) else "liquid"
    never = {e.name: f"a {e.fluid}" for e in CATALOGUE if e.fluid not in ("", fluid)}
    if chain.electric:
        of_air = "an actuator driven by air"
        moved = [e for e in CATALOGUE if e.requires != of_air]
        motors = {e.name for e in moved if e.stage != "actuator" or e.motor}
        never |= {name: of_air for name in _NAMES if name not in motors}
    return never
