# SPDX-License-Identifier: BSD-3-Clause
"""Which records a benchmark holds: a plan that a seed draws, a case a record.

Of 640 records about 200 hold nothing, 300 one effect of the catalogue, 60 two, 80 one that no catalogue
holds. Every effect comes at one, two and three times what its own record could just tell, in different
excitations, and nearly every one is concealed in some further way; healthy records are hard in the same ways.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.concealed.plant import EFFECTS, NAMED, OUTSIDE
from benchmarks.concealed.plant.programs import EXCITATIONS

# what makes a record harder, beside the size of the effect, its excitation and the moment it begins
OF_HEALTHY = (
    "loud", "wandering", "correlated", "growing_with_flow", "quantised", "badly_tuned", "wrong_sheet",
    "disturbed", "confounded", "retuned", "rare", "compressed", "no_opening", "no_p2",
)  # fmt: skip
OF_EFFECTS = (
    "compensated", "wandering", "correlated", "growing_with_flow", "rare", "wrong_sheet", "quantised",
    "compressed", "confounded", "disturbed", "retuned", "no_opening", "no_p2",
)  # fmt: skip
ONLY_IN = {"rare": ("wide",), "badly_tuned": ("closed", "cascade"), "retuned": ("closed", "cascade")}
# pairs that hide one another, or that live in different blocks
PAIRS = (
    ("seat_leakage", "piping_reducers"), ("choked_flow", "outlet_bias"), ("stiction", "positioner_deadband"),
    ("choked_flow", "plug_backlash"), ("stiction", "seat_leakage"), ("link_backlash", "clogging"),
    ("dead_time", "erosion"), ("positioner_deadband", "meter_bias"), ("actuator_lag", "plug_backlash"),
    ("supply_pressure_drop", "seat_leakage"), ("slew_limit", "meter_lag"),
    ("friction", "wrong_characteristic"),
)  # fmt: skip
STEPS = (1.0, 2.0, 3.0)
# so that a fluid tells nothing of what is concealed
FLUIDS, OFTEN = ("water", "hot_water", "oil"), (0.8, 0.1, 0.1)


@dataclass(frozen=True)
class Case:
    """What one record is to be: its kind, what it conceals, how large, how excited, and how concealed."""

    number: int
    kind: str
    effects: tuple = ()
    step: float | None = None
    excitation: str = "wide"
    course: str = "start"
    nasty: tuple = ()
    fluid: str = "water"

    @property
    def name(self):
        """Name of the record's folder; it tells nothing."""
        return f"record_{self.number:04d}"


def plan(seed, healthy=200, each=6, pairs=60, outside=80, defects=16):
    """Cases in a drawn order.

    Parameters
    ----------
    seed : int
    healthy, pairs, outside, defects : int
        Numbers of records with nothing in them, with two effects, with one of no catalogue, and with an
        effect in a recording whose columns are exchanged or mislabelled.
    each : int
        Records of every effect of the catalogue.
    """
    rng = np.random.default_rng([seed, 9])
    drawn = [_healthy(rng, i) for i in range(healthy)]
    for name in NAMED:
        drawn += [_single(rng, "single", name, i) for i in range(each)]
    drawn += [_single(rng, "outside", OUTSIDE[i % len(OUTSIDE)], i // len(OUTSIDE)) for i in range(outside)]
    drawn += [_pair(rng, PAIRS[i % len(PAIRS)]) for i in range(pairs)]
    drawn += [_defect(rng, i) for i in range(defects)]
    order = rng.permutation(len(drawn))
    return [Case(i, *drawn[k]) for i, k in enumerate(order)]


def _fluid_of(names):
    return next((EFFECTS[n].fluid for n in names if EFFECTS[n].fluid != "water"), "water")


def _ways(rng, names, excitation, many, course="start"):
    possible = [n for n in names if excitation in ONLY_IN.get(n, EXCITATIONS)]
    if course != "start":
        # a wrong capacity of the sheet can hide only what was there from the start
        possible = [n for n in possible if n != "compensated"]
    return tuple(str(n) for n in rng.choice(possible, min(many, len(possible)), replace=False))


def hidden_by(name):
    """What leaves no trace of an effect in the record."""
    if name == "outlet_bias":
        return ("no_p2",)
    if EFFECTS[name].block == "actuator" or name.startswith(("sensor", "loop")):
        return ("no_opening", "compensated")
    return ()


def _healthy(rng, i):
    excitation = EXCITATIONS[i % len(EXCITATIONS)]
    nasty = _ways(rng, OF_HEALTHY, excitation, 2)
    return "healthy", (), None, excitation, "start", nasty, str(rng.choice(FLUIDS, p=OFTEN))


def _single(rng, kind, name, i):
    effect = EFFECTS[name]
    excitation = str(rng.choice(effect.asks or EXCITATIONS))
    course = _course(rng, effect)
    ways = [n for n in OF_EFFECTS if n not in hidden_by(name)]
    nasty = _ways(rng, ways, excitation, 1, course)
    return kind, (name,), STEPS[i % len(STEPS)], excitation, course, nasty, _fluid_of((name,))


def _course(rng, effect):
    """When an effect acts: mostly from the start, or from a moment on and then always."""
    if effect.grows:
        return str(rng.choice(["start", "within", "mended"], p=[0.4, 0.4, 0.2]))
    if effect.when == "start" or effect.name == "stuck_valve":
        return "start" if effect.when == "start" else "within"
    start = 0.0 if effect.when == "within" else 0.5
    return str(
        rng.choice(["start", "within", "on_and_off"], p=[start, 0.8 * (1.0 - start), 0.2 * (1.0 - start)])
    )


def _pair(rng, names):
    excitation = str(rng.choice(["wide", "wide", "closed"]))
    if any(EFFECTS[name].asks for name in names):
        excitation = "wide"
    nasty = _ways(rng, ("wandering", "growing_with_flow", "wrong_sheet", "disturbed"), excitation, 1)
    return "pair", tuple(names), float(rng.choice([2.0, 3.0])), excitation, "start", nasty, _fluid_of(names)


def _defect(rng, i):
    name = str(rng.choice([n for n in NAMED if EFFECTS[n].fluid == "water" and EFFECTS[n].when != "within"]))
    kind = ("exchanged", "rescaled")[i % 2]
    return "defect", (name,), 2.0, str(rng.choice(EFFECTS[name].asks or EXCITATIONS)), "start", (kind,)
