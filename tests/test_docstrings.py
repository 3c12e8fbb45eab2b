# SPDX-License-Identifier: BSD-3-Clause
"""Every example in a docstring runs, in every module that has one, and the main estimators have one."""

import doctest
from importlib import import_module
from pathlib import Path

import pytest

import sklvalve

plt = pytest.importorskip("matplotlib.pyplot", reason='needs pip install "sklvalve[plot]"')

FOLDER = Path(sklvalve.__file__).parent


def _name(file):
    return ".".join([FOLDER.name, *file.relative_to(FOLDER).with_suffix("").parts])


WITH_EXAMPLES = [
    _name(file) for file in sorted(FOLDER.rglob("*.py")) if ">>> " in file.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("module", WITH_EXAMPLES)
def test_examples_run(module, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = doctest.testmod(import_module(module))
    plt.close("all")
    assert result.attempted > 0
    assert result.failed == 0


@pytest.mark.parametrize("name", [name for name in sklvalve.__all__ if callable(getattr(sklvalve, name))])
def test_there_is_an_example(name):
    assert ">>> " in getattr(sklvalve, name).__doc__
