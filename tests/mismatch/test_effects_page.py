# SPDX-License-Identifier: BSD-3-Clause
"""docs/effects.md is what the catalogue makes of it today."""

import importlib.util
from pathlib import Path

from sklvalve.mismatch.effects import CATALOGUE

DOCS = Path(__file__).parents[2] / "docs"


def _maker():
    spec = importlib.util.spec_from_file_location("make_effects_table", DOCS / "make_effects_table.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_page_of_the_effects_is_current():
    made = _maker().page()
    written = (DOCS / "effects.md").read_text(encoding="utf-8")
    assert written == made, "run: python docs/make_effects_table.py"


def test_page_shows_every_effect_with_its_parameters():
    page = _maker().page()
    unwrapped = " ".join(page.split())
    for effect in CATALOGUE:
        assert f"### {effect.name}\n" in page
        assert effect.separated_by in unwrapped
        for quantity in effect.parameters:
            assert f"`{quantity.name}`" in page


def test_every_link_of_the_page_has_its_heading():
    page = _maker().page()
    headings, links = [], []
    for line in page.splitlines():
        if line.startswith("### "):
            name = line.removeprefix("### ")
            headings.append(f"{name}-{n}" if (n := headings.count(name)) else name)
        if line.startswith("| ["):
            links.append(line.split("](#")[1].split(")")[0])
    assert len(set(links)) == len(links)
    assert set(links) == set(headings)
