# SPDX-License-Identifier: BSD-3-Clause
"""Every parameter name of the mechanism is on the nomenclature page, and nothing else is."""

import inspect
import re
from pathlib import Path

import sklvalve.mechanism as mechanism

PAGE = (Path(__file__).parents[2] / "docs" / "nomenclature.md").read_text(encoding="utf-8")
PARAMETERS, FEATURES = PAGE.split("## Features of the transformer")


def rows(text):
    return [line.split("|")[1:-1] for line in text.splitlines() if line.startswith("| `")]


def names_on(text):
    return [re.fullmatch(r"`(\w+)`", cells[0].strip()).group(1) for cells in rows(text)]


def parameter_names():
    found = set()
    for thing in (getattr(mechanism, name) for name in mechanism.__all__):
        if not callable(thing) or (inspect.isclass(thing) and issubclass(thing, Warning)):
            continue
        functions = [thing]
        if inspect.isclass(thing):
            methods = inspect.getmembers(thing, inspect.isfunction)
            functions += [f for name, f in methods if name[0] != "_" and f.__module__.startswith("sklvalve")]
        for function in functions:
            found |= set(inspect.signature(function).parameters) - {"self"}
    return found


def test_every_parameter_is_there_once_and_nothing_else():
    assert sorted(names_on(PARAMETERS)) == sorted(parameter_names())


def test_every_feature_is_there_once_and_nothing_else():
    assert sorted(names_on(FEATURES)) == sorted(mechanism.ValveMechanismTransformer.available_features())


def test_every_row_is_whole():
    for cells in rows(PAGE):
        assert len(cells) == 4, cells
        assert all(cell.strip() for cell in cells), cells


def test_every_name_is_in_a_docstring_with_its_unit():
    # a unit in brackets closes the description of every physical quantity
    for cells in rows(PARAMETERS):
        name, unit = cells[0].strip(" `"), cells[2].strip().translate(str.maketrans("³²", "32"))
        if unit in {"–", "SI", "K", "°C", "1"}:
            continue
        docs = [getattr(mechanism, thing).__doc__ or "" for thing in mechanism.__all__]
        methods = mechanism.ValveMechanismTransformer
        docs += [methods.forward.__doc__, methods.invert.__doc__]
        told = [doc for doc in docs if re.search(rf"^    [\w, ]*\b{name}\b[\w, ]* : ", doc, flags=re.M)]
        if not told:
            told = [doc for doc in docs if re.search(rf"\b{name}\b", doc)]
        assert any(f"[{unit}]" in doc for doc in told), (name, unit)
