# SPDX-License-Identifier: BSD-3-Clause
"""Labelled real loops by the command line: what holds for any honest tool."""

import os
from pathlib import Path

import pytest

from benchmarks.real.judging import is_property
from benchmarks.real.recordings import cases
from benchmarks.real.running import judge

QUICK = ("isdb_CHEM2", "isdb_CHEM23", "isdb_PAP2", "refinery_loop_01", "refinery_loop_02")


@pytest.fixture(scope="module")
def loops():
    folder = os.environ.get("SKLVALVE_DATA")
    if not folder or not (Path(folder) / "isdb").is_dir():
        pytest.skip("SKLVALVE_DATA names no folder with the loops of isdb")
    return {case.name: case for case in cases(folder) if case.name in QUICK}


@pytest.mark.slow
@pytest.mark.parametrize("name", QUICK)
def test_no_labelled_loop_is_reassured_or_accused_wrongly(name, loops, tmp_path):
    if name not in loops:
        pytest.skip(f"SKLVALVE_DATA holds no {name}")
    row = judge(loops[name], tmp_path, "test")
    assert row["verdict"] not in ("crash", "timeout"), row["reason"]
    if row["label"].get("sound"):
        named = [{**e, "members": [{"name": n} for n in e["members"]]} for e in row.get("names", ())]
        assert all(is_property(effect) for effect in named)
    else:
        assert row["verdict"] != "no_mismatch"
