# SPDX-License-Identifier: BSD-3-Clause
"""Stiction named by its slips, where no simulation can time them."""

from dataclasses import replace

import numpy as np

from sklvalve.mismatch.effects import EVENTS
from sklvalve.mismatch.hypothesis import Member
from sklvalve.mismatch.rivals import Finding, Rival
from sklvalve.mismatch.stick_slip import find_slips

#: Recordings without stiction that were tried; none of them showed evident slips.
WITHOUT_STICTION = 153
#: Chance of evident slips without stiction: one more recording might have been the first.
P_VALUE = 1.0 / (1.0 + WITHOUT_STICTION)

_BY_SLIPS = next(e for e in EVENTS if e.key == "stiction_slips")
_DRAWN = 400


def evident_slips(workbench, effects, alpha):
    """Slips of a sticking stem, where they may be told.

    Parameters
    ----------
    workbench : Workbench
    effects : sequence of Effect
        Candidates: without stiction among them slips tell nothing.
    alpha : float
        Level of the test; slips alone name nothing where it is below 1/154, for no more recordings without
        stiction than 153 were seen to be without evident slips.

    Returns
    -------
    slips : Slips or None
    """
    recording = workbench.recording
    if alpha < P_VALUE or "command" not in recording or "opening" not in recording:
        return None
    if not any(e.name == _BY_SLIPS.name for e in effects):
        return None
    slips = find_slips(recording["command"], recording["opening"])
    return slips if slips.evident else None


def worth_searching(effects, slips):
    """Effects still to be searched: beside evident slips, of the actuator's those alone that look alike.

    Parameters
    ----------
    effects : sequence of Effect
    slips : Slips or None

    Returns
    -------
    searched : list of Effect
    """
    own = _BY_SLIPS
    return [e for e in effects if slips is None or e.block != own.block or e.alike == own.alike]


def with_slips(model, slips, workbench, random_state=0):
    """A fitted hypothesis with stiction told by its slips, and the finding of it.

    What the hypothesis simulates stays as it is, because the moments of the slips are not simulated.

    Parameters
    ----------
    model : Model
    slips : Slips
    workbench : Workbench
    random_state : int
        Of the bootstrap of the median jump.

    Returns
    -------
    finding : Finding
        With the median jump and its standard deviation.
    model : Model
    """
    sizes = np.abs(slips.sizes)
    rng = np.random.default_rng(random_state)
    drawn = np.median(rng.choice(sizes, size=(_DRAWN, len(sizes))), axis=1)
    member, key = Member(_BY_SLIPS), f"{_BY_SLIPS.key}.jump"
    members = (member, *model.members)
    together = replace(
        model,
        members=members,
        chain=workbench.chain(members),
        values=model.values | {key: float(np.median(sizes))},
        spreads=model.spreads | {key: float(np.std(drawn))},
    )
    rival = Rival(member, together, 1.0 - P_VALUE, 0.0)
    return Finding(member, [rival], 0.0, {"opening": float(np.median(sizes))}), together


def beside_slips(findings):
    """Findings that slips do not explain: those outside the actuator."""
    own = _BY_SLIPS
    return [f for f in findings if f.member.effect.block != own.block and f.member.effect.alike != own.alike]


def rows_of_slips(recording, around=2):
    """Rows in which the stem slips, and some around them."""
    slips = find_slips(recording["command"], recording["opening"])
    hit = np.zeros(len(recording), dtype=bool)
    for row in slips.rows:
        hit[max(row - around, 0) : row + around + 2] = True
    return hit


def simulated(model):
    """A hypothesis without what is told by its events and not simulated."""
    return replace(model, members=tuple(m for m in model.members if m.effect not in EVENTS))


def told_by_slips(findings):
    """Whether stiction told by its slips is among some findings."""
    return any(f.member.effect.key == _BY_SLIPS.key for f in findings)
