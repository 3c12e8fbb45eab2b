# SPDX-License-Identifier: BSD-3-Clause
"""docs/api.rst lists every public name once, and none that does not exist."""

import pkgutil
import re
from collections import Counter
from importlib import import_module
from pathlib import Path

import pytest

import sklvalve

PAGE = Path(__file__).parents[1] / "docs" / "api.rst"
MODULES = [module.name for module in pkgutil.iter_modules(sklvalve.__path__)]
PUBLIC = ["sklvalve", *(f"sklvalve.{name}" for name in MODULES if not name.startswith("_"))]


def _listed(text):
    """Names in the autosummary tables of a page, each with the module that stands above it."""
    module, in_table = "", False
    for line in text.splitlines():
        if found := re.fullmatch(r"\.\. (?:py:)?currentmodule:: (\S+)", line):
            module = found[1]
        if re.match(r"\S", line):
            in_table = line.startswith(".. autosummary::")
        elif in_table and (found := re.fullmatch(r"   (\w+)", line)):
            yield f"{module}.{found[1]}"


def _object(path):
    module, _, name = path.rpartition(".")
    return getattr(import_module(module), name, None)


LISTED = list(_listed(PAGE.read_text(encoding="utf-8")))


def test_the_tables_are_found():
    text = (
        ".. currentmodule:: a.b\n\n.. autosummary::\n   :toctree: there\n\n   one\n   two\n\nText.\n\n   no\n"
    )
    assert list(_listed(text)) == ["a.b.one", "a.b.two"]
    assert len(LISTED) > 100


@pytest.mark.parametrize("module", PUBLIC)
def test_every_public_name_is_listed(module):
    shown = {id(_object(path)) for path in LISTED}
    names = import_module(module).__all__
    assert not [name for name in names if id(_object(f"{module}.{name}")) not in shown]


@pytest.mark.parametrize("path", LISTED)
def test_what_is_listed_is_public(path):
    module, _, name = path.rpartition(".")
    assert name in import_module(module).__all__
    assert _object(path) is not None


def test_nothing_is_listed_twice():
    assert not [path for path, times in Counter(LISTED).items() if times > 1]
    assert len({id(_object(path)) for path in LISTED}) == len(LISTED)
