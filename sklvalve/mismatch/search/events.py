# SPDX-License-Identifier: BSD-3-Clause
"""Effects named by events in the recording: slips of the stem, or its hunting, which no simulation times."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.constants import IN_CLASS
from sklvalve.mismatch.effects import EVENTS
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.search.rivals import Finding, Rival
from sklvalve.mismatch.signals.hunting import find_hunting
from sklvalve.mismatch.signals.stick_slip import find_slips
from sklvalve.simulation.given import ACTUATOR_STAGES

if TYPE_CHECKING:
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.recording import Recording

#: Recordings of two simulated plants without friction, a bent rod or play in the feedback, on which the rules
#: were made: none of them shows such events.
WITHOUT_EITHER = 1048
#: Chance of evident events without either: one more recording might have been the first.
P_VALUE = 1.0 / (1.0 + WITHOUT_EITHER)

# what recordings with such events held, and how many of so many; what is missing to one held something else
_SHARES = {
    "slips": {"stiction_slips": 22.0 / 38.0, "friction_slips": 15.0 / 38.0},
    "hunting": {
        "stiction_hunting": 21.0 / 35.0,
        "feedback_hunting": 6.0 / 35.0,
        "friction_hunting": 4.0 / 35.0,
        "rod_bend_hunting": 4.0 / 35.0,
    },
}
_BLOCK, _ALIKE = "actuator", "play"
_DRAWN = 400


@dataclass(frozen=True)
class Events:
    """Events of one kind in a recording.

    Attributes
    ----------
    kind : str
        "slips" or "hunting".
    sizes : ndarray of shape (k,)
        How far the stem jumps, or swings [1].
    flagged : ndarray of shape (n,), bool
        Rows of the events and some around them.
    names_wanted : frozenset of str
        Effects that are considered; all unless given.
    """

    kind: str
    sizes: np.ndarray
    flagged: np.ndarray

    names_wanted: frozenset[str] = frozenset(e.name for e in EVENTS)

    @property
    def forms(self) -> list[Effect]:
        """Effects that make such events, of those wanted, the likeliest first."""
        shares = _SHARES[self.kind]
        able = [e for e in EVENTS if e.key in shares and e.name in self.names_wanted]
        return sorted(able, key=lambda e: -shares[e.key])

    @property
    def may_name(self) -> bool:
        """Whether the effects wanted make most of such events: the others would have to take the name."""
        shares = _SHARES[self.kind]
        return (1.0 - P_VALUE) * sum(shares[e.key] for e in self.forms) >= IN_CLASS

    @property
    def names(self) -> set[str]:
        return {e.name for e in self.forms}


def events_of(recording: Recording) -> Events | None:
    """Evident events of a recording, slips before hunting; None where there are none."""
    if "command" not in recording or "opening" not in recording:
        return None
    command, opening = recording["command"], recording["opening"]
    flagged = np.zeros(len(recording), dtype=bool)
    slips = find_slips(command, opening)
    if slips.evident:
        for row in slips.rows:
            flagged[max(row - 2, 0) : row + 4] = True
        return Events("slips", np.abs(slips.sizes), flagged)
    hunting = find_hunting(command, opening)
    if hunting.evident:
        for row in hunting.rows:
            flagged[row : row + hunting.length] = True
        return Events("hunting", hunting.sizes, flagged)
    return None


def evident_events(problem: Problem, effects: Sequence[Effect], alpha: float) -> Events | None:
    """Events of the stem, where they may name an effect.

    Parameters
    ----------
    problem : Problem
    effects : sequence of Effect
        Candidates: without those that make the events these tell nothing.
    alpha : float
        Level of the test; events alone name nothing where it is below their own chance.

    Returns
    -------
    events : Events or None
    """
    events = None if alpha < P_VALUE else events_of(problem.recording)
    if events is None:
        return None
    events = replace(events, names_wanted=frozenset(e.name for e in effects))
    return events if events.may_name else None


def effects_to_search(effects: Sequence[Effect], events: Events | None) -> list[Effect]:
    """Effects still to be searched: beside events, of those that move the stem the ones that look alike.

    Parameters
    ----------
    effects : sequence of Effect
    events : Events or None

    Returns
    -------
    searched : list of Effect
    """
    return [e for e in effects if events is None or not _moves_the_stem(e) or e.alike == _ALIKE]


def with_events(
    model: Model, events: Events, problem: Problem, random_state: int = 0
) -> tuple[Finding, Model]:
    """A fitted hypothesis with what its events tell, and the finding of it: every effect that makes them.

    What the hypothesis simulates stays as it is, because the instants of the events are not simulated.

    Parameters
    ----------
    model : Model
    events : Events
    problem : Problem
    random_state : int
        Of the bootstrap of the median size.

    Returns
    -------
    finding : Finding
        With the median size and its standard deviation.
    model : Model
    """
    rng = np.random.default_rng(random_state)
    drawn = np.median(rng.choice(events.sizes, size=(_DRAWN, len(events.sizes))), axis=1)
    size, spread = float(np.median(events.sizes)), float(np.std(drawn))
    rivals = []
    for effect in events.forms:
        term, key = Term(effect), f"{effect.key}.{effect.parameters[0].name}"
        terms = (term, *model.terms)
        made = replace(
            model,
            terms=terms,
            chain=problem.chain(terms),
            values=model.values | {key: size},
            spreads=model.spreads | {key: spread},
        )
        rivals.append(Rival(term, made, (1.0 - P_VALUE) * _SHARES[events.kind][effect.key], 0.0))
    return Finding(rivals[0].term, rivals, 0.0, {"opening": size}), rivals[0].model


def beside_events(findings: Iterable[Finding]) -> list[Finding]:
    """Findings that events do not explain: those that do not move the stem, and are no play."""
    return [f for f in findings if not (_moves_the_stem(f.term.effect) or f.term.effect.alike == _ALIKE)]


def _moves_the_stem(effect: Effect) -> bool:
    return effect.block == _BLOCK or effect.stage in ACTUATOR_STAGES


def simulated(model: Model) -> Model:
    """A hypothesis without what its events name, which is not simulated."""
    return replace(model, terms=tuple(m for m in model.terms if m.effect not in EVENTS))


def named_by_events(findings: Iterable[Finding]) -> bool:
    """Whether any of some findings is named by its events."""
    return any(f.term.effect in EVENTS for f in findings)
