# SPDX-License-Identifier: BSD-3-Clause
"""The page about the paper: every name on it exists, and every equation of the valve has its function."""

import importlib
import inspect
import re
from operator import attrgetter
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "paper.md").read_text(encoding="utf-8")
PLACES = [importlib.import_module(f"sklvalve.{name}") for name in ("mechanism", "hybrid", "lssvm", "metrics")]
ROWS = [line.split("|")[1:-1] for line in PAGE.splitlines() if line.startswith("| ")]
HERE = [(cells[0].strip(), cells[-1]) for cells in ROWS if cells[0].strip() != "equation"]
EQUATIONS = {
    "1": ["orifice_flow"],
    "2": ["estimate_fl", "vena_contracta_pressure"],
    "3": ["clausius_clapeyron"],
    "4": ["clausius_clapeyron"],
    "5": ["critical_pressure_ratio_factor"],
    "6": ["liquid_kv"],
    "7": ["nonturbulent_kv"],
    "16": ["orifice_flow", "ValveMechanismTransformer.forward"],
}


def find(name):
    """The public thing of a dotted name, or None."""
    for place in PLACES:
        try:
            return attrgetter(name)(place)
        except AttributeError:
            continue
    return None


def test_the_page_has_all_equations():
    told = " ".join(row for row, _ in HERE)
    assert all(f"({number})" in told for number in (*EQUATIONS, 8, 9, 10, 14, 15, 17, 18, 19, 20))


@pytest.mark.parametrize("cell", [cell for row, cell in HERE if row != "(17)"])
def test_every_name_exists(cell):
    spans = [code.removeprefix("sklvalve.metrics.") for code in re.findall(r"`([^`]+)`", cell)]
    # "`.invert`" goes on with the class named before it
    classes = [name for code in spans for name in re.findall(r"^[A-Z]\w+", code)]
    names = [f"{classes[0]}{code}" if code[0] == "." else re.match(r"[\w.]+", code).group() for code in spans]
    found = [find(name) for name in names]
    inside = [find(name) for code in spans for name in re.findall(r"\(.*?\b([A-Z]\w+)\(", code)]
    parameters = {p for thing in found + inside if thing for p in inspect.signature(thing).parameters}
    assert any(found)
    for name, thing in zip(names, found, strict=True):
        assert thing is not None or name in parameters, name
    for code in spans:
        assert set(re.findall(r"(\w+)=", code)) <= parameters, code


@pytest.mark.parametrize("equation", EQUATIONS)
def test_every_equation_has_a_function_that_says_what_print_says(equation):
    cells = " ".join(cell for row, cell in HERE if f"({equation})" in row)
    for name in EQUATIONS[equation]:
        doc = inspect.getdoc(find(name))
        first, notes = doc.split("\n\n")[0], doc.split("Notes\n-----")[1]
        assert re.search(rf"paper's equations? ([\d]+ and )?{equation}\b", first + notes), name
        assert "paper" in notes.lower(), name
    assert any(f"`{name}" in cells for name in EQUATIONS[equation])
