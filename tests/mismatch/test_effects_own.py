# SPDX-License-Identifier: BSD-3-Clause
"""What is an effect's own stands in its file: its words, what hides it, what a drop makes of it."""

import ast
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import sklvalve
from sklvalve import Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.data.gate import effects_switched_off
from sklvalve.mismatch.data.preparation import candidates, prepared_problem
from sklvalve.mismatch.effects import CATALOGUE, EVENTS, LATE, Effect, Quantity, Shown
from sklvalve.mismatch.effects.seat_leakage import SeatLeakage
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.result.effect_entry import _at_another_time, _sentence
from sklvalve.mismatch.result.known_effects import forms_of, quantity_named
from sklvalve.report.kinds import to_be_declared
from sklvalve.report.parameters import parameters
from sklvalve.report.words import class_clause, spoken

FORMS = (*CATALOGUE, *EVENTS, *LATE)
DEFECTS = {"compressed", "held", "quantised", "frozen", "unmeasured", "saturated", "clock_shift"}
ROLES = {"command", "opening", "flow", "p1", "p2", "temperature", "any"}
each_form = pytest.mark.parametrize("effect", FORMS, ids=lambda effect: effect.key)


class Bowed(Effect):
    """A stem that bows as the liquid warms."""

    name = key = "bowed_by_hand"
    block, stage = "valve", "plug"
    parameters = (
        Quantity("bow", "1/K", -0.2, 0.2, (0.01,), shown=Shown("bow", "% of travel/K", 100.0)),
        Quantity("bend", "1", 0.5, 2.0, (1.0,), null=None, silent=True),
        Quantity("slowness", "s", 1.0, 9.0, (2.0,), null=None, declared=lambda value: 2.0 * value),
    )
    needs = ("flow", "temperature")
    hidden_by = {"frozen": ("temperature",), "clock_shift": ("any",)}  # noqa: RUF012
    by_drop = "always"
    declared_as = "warming_time"
    words = "a stem bowed by warming"
    clause = "the stem is bowed by warming"

    def apply(self, value, p, chain):
        """Plug off by what the temperature makes of it."""
        return value + p["bow"] * (chain.temperature - chain.temperature[0])


class Old(Effect):
    """An effect as they were written before effects said more of themselves."""

    name = key = "another_old_thing"
    block, stage = "valve", "capacity"
    parameters = (Quantity("width", "1", 0.0, 1.0, (0.1,)), Quantity("new_thing", "1", 0.0, 1.0, (0.1,)))
    needs = ("flow",)

    def apply(self, value, p, chain):
        """Capacity as it is."""
        return value * (1.0 + p["width"])


class Gasket(SeatLeakage):
    """An effect that has the equation of another one."""

    name = key = "leaking_gasket"


def found(name, role, rows=((5, 40),), **more):
    return {"finding": name, "role": role, "detail": "d", "rows": rows and [list(r) for r in rows], **more}


def prepared(*without):
    made = make_valve_recording(None, loop="wide", n_samples=600, n_later=0, random_state=5)
    roles = {k: v for k, v in made.valve["recording"].items() if k not in without}
    return prepared_problem(
        Recording.from_frame(made.frame, Valve.from_dict(made.valve | {"recording": roles}))
    )


@pytest.fixture(scope="module")
def bench():
    return prepared()


def entry(name, **values):
    items = {key: {"value": value, "unit": unit, "ci95": None} for key, (value, unit) in values.items()}
    members = [{"name": name, "probability": 1.0, "kind": "either"}]
    return {"members": members, "kind": "either", "parameters": items}


# ---- effects that stand in no table


def test_reports_speak_of_an_effect_as_it_says():
    assert spoken("bowed_by_hand") == "a stem bowed by warming"
    assert class_clause([{"name": "bowed_by_hand"}]) == "the stem is bowed by warming"
    bowed = entry("bowed_by_hand", bow=(0.02, "1/K"), bend=(1.0, "1"), slowness=(3.0, "s"))
    assert parameters(bowed, {}) == [("bow", "2 % of travel/K"), ("slowness", "3 s")]
    assert "warming_time = 6" in to_be_declared([bowed])


@pytest.mark.parametrize(
    ("effect", "said"),
    [(Bowed, "The stem is bowed by warming."), (Old, "There is another old thing.")],
)
def test_an_effect_without_a_phrase_is_told_by_its_clause_or_its_name(effect, said, bench):
    assert _sentence(Term(effect()), {}, (), bench.recording) == said


def test_a_class_says_which_of_its_causes_began_at_another_time(bench):
    model = SimpleNamespace(chain=SimpleNamespace(clock=np.array([50.0, 51.0])))
    throughout, old = Term(Bowed()), Term(Old(), 170.0)
    assert _at_another_time(throughout, [(throughout, model), (Term(SeatLeakage()), model)]) == ""
    assert _at_another_time(throughout, [(throughout, model), (old, model)]) == (
        " If it is another old thing, it began 120 s after the first row."
    )
    later = Term(Old(), 240.0)
    said = _at_another_time(throughout, [(throughout, model), (old, model), (later, model)])
    assert said.endswith("it began 120 to 190 s after the first row.")
    mixed = [(old, model), (throughout, model), (Term(SeatLeakage()), model)]
    said = _at_another_time(old, mixed)
    assert said == f" If it is a stem bowed by warming or {SeatLeakage.words}, it acts from the start."


@pytest.mark.parametrize(
    ("data", "needs"),
    [
        (found("frozen", "temperature"), "a recording whose temperature is not frozen"),
        (found("clock_shift", "p1", size=3.0), "one clock for p1 and the others"),
        # what hides every effect hides those of users
        (found("frozen", "flow", None), "a recording whose flow is not frozen"),
        (found("swapped", "p1"), "columns that are not swapped"),
    ],
)
def test_what_an_effect_is_hidden_by_switches_it_off(bench, data, needs):
    assert effects_switched_off([data], [Bowed()]) == {"bowed_by_hand": needs}
    assert candidates(bench, [Bowed()], [data]) == ([], [{"name": "bowed_by_hand", "needs": needs}])


def test_what_it_is_not_hidden_by_leaves_it_testable(bench):
    data = [found("frozen", "p1"), found("saturated", "flow")]
    (tested,), lacking = candidates(bench, [Bowed()], data)
    assert (tested.key, lacking) == ("bowed_by_hand", [])


def test_what_a_drop_makes_is_not_testable_without_pressures():
    tested, lacking = candidates(prepared("p1", "p2"), [Bowed(), Old()], [])
    assert [effect.key for effect in tested] == ["another_old_thing"]
    assert lacking == [{"name": "bowed_by_hand", "needs": "p1 and p2"}]


def test_an_effect_that_says_nothing_of_itself_has_its_name(bench):
    assert spoken("another_old_thing") == "another old thing"
    assert class_clause([{"name": "another_old_thing"}]) == "there is another old thing"
    old = entry("another_old_thing", width=(0.02, "1"), new_thing=(1.0, "1"))
    assert parameters(old, {}) == [("play", "2 % of travel"), ("new thing", "1")]
    assert to_be_declared([old]).endswith("to the simulation. If it is not, look for the fault at the valve.")
    data = [found("frozen", "opening"), found("saturated", "flow"), found("clock_shift", "flow", size=2.0)]
    (tested,), _ = candidates(bench, [Old()], data)
    assert tested.key == "another_old_thing"


def test_an_effect_under_its_own_name_does_not_borrow_words():
    assert spoken("leaking_gasket") == "leaking gasket"
    # what hides an equation hides it under every name
    assert effects_switched_off([found("saturated", "flow")], [Gasket()]).keys() == {"leaking_gasket"}


def test_a_name_that_nobody_knows_is_spoken_as_it_is():
    assert forms_of("nobody_s") == ()
    assert spoken("nobody_s") == "nobody s"


def test_the_class_that_was_written_last_speaks():
    def written(words):
        # kept, or it would be forgotten
        return type("Again", (Effect,), {"name": "written_again", "words": words})

    kept = [written("the first"), written("the second")]
    assert len(kept) == 2
    assert spoken("written_again") == "the second"


# ---- the catalogue


@each_form
def test_defects_and_drop_are_known(effect):
    assert set(effect.hidden_by) <= DEFECTS
    assert all(set(roles) <= ROLES for roles in effect.hidden_by.values())
    assert effect.by_drop in ("", "always", "unseen", "onset")


@each_form
def test_forms_of_a_name_agree(effect):
    first = forms_of(effect.name)[0]
    for told in ("words", "clause", "hidden_by"):
        assert getattr(effect, told) == getattr(first, told)
    for quantity in effect.parameters:
        known = quantity_named(effect.name, quantity.name, quantity.unit)
        assert (known.shown, known.silent) == (quantity.shown, quantity.silent)


def test_what_is_declared_has_a_key():
    for effect in FORMS:
        assert bool(effect.declared_as) == any(q.declared is not None for q in effect.parameters)


# ---- no tables elsewhere

# measured with these effects, or chosen to be drawn; and a plant that shares no code with the catalogue
TABLES = (
    "mismatch/decide/borne_out.py",
    "mismatch/search/events.py",
    "cli/demo.py",
    "datasets/",
)
ROOT = Path(sklvalve.__file__).parent


def _listed(tree, names):
    """Catalogue names that a literal lists, three or more of them."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Dict):
            items = node.keys
        elif isinstance(node, ast.Tuple | ast.List | ast.Set):
            items = node.elts
        else:
            continue
        told = {item.value for item in items if isinstance(item, ast.Constant)} & names
        if len(told) > 2:
            yield sorted(told)


def test_no_module_but_the_effects_and_measured_tables_lists_effects():
    names = {effect.name for effect in FORMS} | {effect.key for effect in FORMS}
    for file in sorted(ROOT.rglob("*.py")):
        where = file.relative_to(ROOT).as_posix()
        if where.startswith(("mismatch/effects/", *TABLES)):
            continue
        assert list(_listed(ast.parse(file.read_text(encoding="utf-8")), names)) == [], where


def test_lists_are_found():
    tree = ast.parse('A = {"stiction": 1, "backlash": 2, "friction": 3}; B = ("clogging", "erosion")')
    assert list(_listed(tree, {effect.name for effect in FORMS})) == [["backlash", "friction", "stiction"]]
