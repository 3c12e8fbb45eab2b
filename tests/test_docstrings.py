# SPDX-License-Identifier: BSD-3-Clause
"""Every example in a docstring runs, in every module that has one, and the main estimators have one."""

import doctest
from importlib import import_module
from pathlib import Path

import pytest

import sklvalve
from sklvalve import mechanism, recording

plt = pytest.importorskip("matplotlib.pyplot", reason='needs pip install "sklvalve[plot]"')

FOLDER = Path(sklvalve.__file__).parent


def _name(file):
    return ".".join([FOLDER.name, *file.relative_to(FOLDER).with_suffix("").parts])


# a plan of a test with its simulations, and a compilation
LONG = {"sklvalve.mismatch.advice", "sklvalve.mechanism.rating"}
WITH_EXAMPLES = [
    pytest.param(_name(file), marks=[pytest.mark.slow] if _name(file) in LONG else [])
    for file in sorted(FOLDER.rglob("*.py"))
    if ">>> " in file.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("module", WITH_EXAMPLES)
def test_examples_run(module, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = doctest.testmod(import_module(module))
    plt.close("all")
    assert result.attempted > 0
    assert result.failed == 0


def _public():
    """Module and name of what can be called, of the package and of its lower layers."""
    for module in (sklvalve, mechanism, recording):
        yield from ((module, name) for name in module.__all__ if callable(getattr(module, name)))


@pytest.mark.parametrize(
    ("module", "name"), [pytest.param(m, n, id=f"{m.__name__}.{n}") for m, n in _public()]
)
def test_there_is_an_example(module, name):
    assert ">>> " in getattr(module, name).__doc__
