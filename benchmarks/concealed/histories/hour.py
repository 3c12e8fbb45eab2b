# SPDX-License-Identifier: BSD-3-Clause
"""One hour of the plant of a record, before the record."""

from dataclasses import replace

import numpy as np

from benchmarks.concealed.cases import ONLY_IN
from benchmarks.concealed.distances import Scene
from benchmarks.concealed.histories.changes import before
from benchmarks.concealed.histories.kinds import ANOTHER, kind_of_history
from benchmarks.concealed.plant import EFFECTS, Course
from benchmarks.concealed.plant.programs import EXCITATIONS
from benchmarks.concealed.record import recorded

ROWS = 3600


def history_of(case, made, kind=None):
    """The history of a record.

    Parameters
    ----------
    case : Case
    made : benchmarks.concealed.record.Made
        The record, which stays as it is.
    kind : Kind, default=None
        Drawn from the seed of the record's plant unless given.

    Returns
    -------
    table : dict
        Columns of the record, 3,600 rows. Times are seconds from its own beginning, as those of the record
        are: nothing says how many days lie between the two, which are read as files of their own.
    truth : dict
        For the key ``history`` of the record's truth.
    """
    plant = made.plant
    kind = kind_of_history(case, plant.seed) if kind is None else kind
    # dice of their own, so that the hour is the same one whatever was changed after it and whatever it holds
    rng, dice = (np.random.default_rng([plant.seed, k]) for k in (7, 8))
    settings, allowed = before(dice, plant, kind.change)
    nasty = tuple(way for way in case.nasty if _stays(way, kind.excitation))
    hour = plant.another_hour(rng, kind.excitation, ROWS, nasty, **settings)
    strengths = _strengths(dice, kind, made.truth["strengths"])
    # a valve that is stuck throughout would be no history at all
    course = Course("within", 0.5 * ROWS) if "stuck_valve" in strengths else Course()
    schedule = hour.schedule(strengths, course)
    lacking = tuple(way[3:] for way in nasty if way.startswith("no_"))
    scene = Scene(hour, schedule, hour.run(schedule), lacking)
    _, drawn = recorded(rng, hour, scene, replace(case, excitation=kind.excitation, nasty=nasty))
    blank = np.full(ROWS, np.nan)  # of a set-point, where nothing is controlled
    table = {name: drawn.get(name, blank) for name in made.table}
    return table, _truth(kind, nasty, strengths, allowed)


def with_history(case, made):
    """The record with its history, which its truth then tells of under ``history``."""
    table, truth = history_of(case, made)
    return replace(made, history=table, truth=made.truth | {"history": truth})


def _stays(way, excitation):
    """Whether what makes a record hard makes its history hard too: a controller is retuned after it."""
    return way != "retuned" and excitation in ONLY_IN.get(way, EXCITATIONS)


def _strengths(rng, kind, own):
    """Sizes of what a history holds."""
    if kind.holds != "another":
        return {name: own[name] for name in kind.effects}
    sign = {name: float(rng.choice([-1.0, 1.0])) if EFFECTS[name].signed else 1.0 for name in kind.effects}
    return {name: sign[name] * ANOTHER[name] for name in kind.effects}


def _truth(kind, nasty, strengths, allowed):
    told = [EFFECTS[name].told for name in kind.effects if EFFECTS[name].told]
    return {
        "rows": ROWS,
        "excitation": kind.excitation,
        "nasty": list(nasty),
        "clean": kind.holds is None,
        "holds": kind.holds,
        "effects": told,
        "concealed": list(kind.effects),
        "strengths": strengths,
        "allowed_change": allowed,
    }
