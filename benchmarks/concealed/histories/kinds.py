# SPDX-License-Identifier: BSD-3-Clause
"""What kind of history a record has: how it is excited, what it holds, what was changed since."""

from dataclasses import dataclass

import numpy as np

from benchmarks.concealed.cases import hidden_by
from benchmarks.concealed.plant import EFFECTS

# shares of histories: excited in another way than the record; not clean; with an allowed change after them
OTHER_EXCITATION, NOT_CLEAN, CHANGED = 0.2, 0.1, 0.1
# where each excitation has its opposite: a wide test says nothing of small moves, and the reverse
_OTHER = {"wide": ("closed", "cascade"), "closed": ("wide",), "cascade": ("wide",)}
# another thing than the record's, in a history that is not clean: about twice what records of the published
# runs could just tell, so that no size has to be looked for
ANOTHER = {
    "seat_leakage": 0.016,
    "leak_behind_trim": 0.027,
    "link_backlash": 0.044,
    "plug_backlash": 0.027,
    "stiction": 0.1,
    "friction": 0.33,
    "actuator_lag": 10.0,
    "positioner_deadband": 0.03,
    "supply_pressure_drop": 0.45,
    "wrong_characteristic": 0.29,
    "meter_zero": 0.05,
    "meter_lag": 6.0,
    "outlet_bias": 54e3,
}


@dataclass(frozen=True)
class Kind:
    """What a history is: its excitation, what it holds, and what was changed since.

    Attributes
    ----------
    excitation : {"wide", "closed", "cascade"}
    holds : {None, "same", "another"}
        The record's own effect, or another one; None of a clean history.
    effects : tuple of str
        By the plant's names.
    change : str or None
        What was changed between history and record, and is no fault.
    """

    excitation: str
    holds: str | None = None
    effects: tuple = ()
    change: str | None = None


def kind_of_history(case, seed):
    """Kind of the history of a case.

    Parameters
    ----------
    case : Case
    seed : int
        Of the record's plant.

    Returns
    -------
    kind : Kind
    """
    rng = np.random.default_rng([seed, 6])
    excitation = case.excitation
    if rng.random() < OTHER_EXCITATION:
        excitation = str(rng.choice(_OTHER[case.excitation]))
    lot = rng.random()
    if lot < NOT_CLEAN:
        own = bool(case.effects) and rng.random() < 0.5
        effects = case.effects if own else (_another(rng, case),)
        return Kind(excitation, "same" if own else "another", effects)
    if lot < NOT_CLEAN + CHANGED:
        return Kind(excitation, change=str(rng.choice(_changes(case, excitation))))
    return Kind(excitation)


def _another(rng, case):
    told = {EFFECTS[name].told for name in case.effects}
    seen = [n for n in ANOTHER if not {"no_opening", "no_p2"} & set(hidden_by(n)) & set(case.nasty)]
    return str(rng.choice([name for name in seen if EFFECTS[name].told not in told]))


def _changes(case, excitation):
    """What may be changed without a fault, and shows in this record or this history."""
    known = ["flow_zero", "pressure_zero", "season", "source_pressure"]
    if "no_opening" not in case.nasty:
        known.append("position_zero")
    if "wide" not in (case.excitation, excitation):
        known.append("tuning")
    return known
