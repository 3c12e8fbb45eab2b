# SPDX-License-Identifier: BSD-3-Clause
"""The compiled pass that is kept on disk, and edits of the files that it was compiled from."""

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import sklvalve
from sklvalve.mechanism import _rating_kernel

PACKAGE = Path(sklvalve.__file__).parent
FOLDER = Path(_rating_kernel.__file__).parent
CODE = """
from sklvalve.mechanism import rate_liquid, _rating_kernel
flow = rate_liquid(10.0, 6e5, 4e5, 293.15, fl=0.9)
stats = _rating_kernel.rate.stats
print(float(flow), sum(stats.cache_hits.values()), sum(stats.cache_misses.values()))
"""


def rated_in(folder):
    """The flow that a fresh process finds, and how often it read and missed the kept code."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    environment["PYTHONPATH"] = str(folder)
    run = subprocess.run(
        [sys.executable, "-c", CODE], env=environment, cwd=folder, capture_output=True, text=True, check=True
    )
    flow, hits, misses = run.stdout.split()
    return float(flow), int(hits), int(misses)


@pytest.mark.slow
def test_an_edit_of_an_imported_file_is_compiled_anew(tmp_path):
    shutil.copytree(PACKAGE, tmp_path / "sklvalve", ignore=shutil.ignore_patterns("__pycache__"))
    kept = tmp_path / "sklvalve" / "mechanism" / "__pycache__"
    kept.mkdir()
    # spares one compilation where the tests before have done it
    for file in (FOLDER / "__pycache__").glob("_rating_*.nb?"):
        shutil.copy(file, kept)
    before, _, _ = rated_in(tmp_path)
    constants = tmp_path / "sklvalve" / "mechanism" / "_constants.py"
    text = constants.read_text(encoding="utf-8")
    edited = text.replace("FLOW_CONSTANT = 0.1 /", "FLOW_CONSTANT = 0.2 /")
    assert edited != text
    constants.write_text(edited, encoding="utf-8")
    after = pytest.approx(2.0 * before, rel=1e-14)
    assert rated_in(tmp_path) == (after, 0, 1)
    assert rated_in(tmp_path) == (after, 1, 0)


@pytest.mark.parametrize("name", _rating_kernel.SOURCES)
def test_each_source_counts(name, tmp_path):
    for source in _rating_kernel.SOURCES:
        shutil.copy(FOLDER / source, tmp_path)
    before = _rating_kernel._stamp(tmp_path)
    assert before == _rating_kernel._stamp(FOLDER)
    with open(tmp_path / name, "a", encoding="utf-8") as file:
        file.write("\n")
    assert _rating_kernel._stamp(tmp_path) != before


@pytest.mark.parametrize("name", _rating_kernel.SOURCES)
def test_no_source_is_forgotten(name):
    tree = ast.parse((FOLDER / name).read_text(encoding="utf-8"))
    modules = [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    modules += [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    ours = {module.rpartition(".")[2] + ".py" for module in modules if module.startswith("sklvalve")}
    assert ours <= set(_rating_kernel.SOURCES)
