# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve diagnose`` on loops known by command and value only: two results, and why not three."""

import csv
import gzip
import json
import os

import numpy as np
import pytest

from sklvalve.cli import main
from sklvalve.mismatch.loop import stick_slip

for _module in ("pandas", "jinja2", "matplotlib", "skops"):
    pytest.importorskip(_module, reason='needs pip install "sklvalve[all]"')

VALVE = """
[valve]
tag = "FIC-1"
[recording]
time = "t"
[recording.command]
column = "op"
unit = "%"
[recording.flow]
column = "pv"
unit = "m3/h"
[recording.setpoint]
column = "sp"
unit = "m3/h"
"""
RESULTS = ["diagnosis.json", "report.html"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "valve.toml").write_text(VALVE, encoding="utf-8")
    return tmp_path


def _diagnosed(capsys, *options):
    status = main(["diagnose", "loop.csv", "--valve", "valve.toml", "--out", "out", *options])
    return status, capsys.readouterr().out


def _write(rows):
    with open("loop.csv", "w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([("t", "op", "pv", "sp"), *rows])


def _sticking():
    rng = np.random.default_rng(0)
    time = 10.0 * np.arange(400)
    swings = 0.02 * np.sin(time / 300.0) + 0.015 * np.sin(time / 127.0)
    command = 0.5 + swings + 0.0005 * rng.standard_normal(400)
    flow = 40.0 * stick_slip(command, stick=0.02, slip=0.0) + 0.05 * rng.standard_normal(400)
    return zip(time, 100.0 * command, flow, np.full(400, 20.0), strict=True)


def test_sticking_loop_gives_a_finding_and_a_page_but_no_model(folder, capsys):
    _write(_sticking())
    os.mkdir("out")
    # of an earlier run, and another valve's
    (folder / "out" / "corrected_model.skops").write_text("old", encoding="utf-8")
    status, shown = _diagnosed(capsys, "--exit-code")
    assert status == 1
    assert sorted(os.listdir("out")) == RESULTS
    assert json.loads((folder / "out" / "diagnosis.json").read_text(encoding="utf-8"))["verdict"] == "named"
    assert "No corrected_model.skops: with only a command and a value recorded" in shown


def test_json_of_a_loop_stands_alone(folder, capsys):
    _write(_sticking())
    status, shown = _diagnosed(capsys, "--json", "--until", "3500")
    assert status == 0
    assert json.loads(shown)["provenance"]["rows"] in (350, 351)


def test_loop_of_a_refinery(data_folder, folder, capsys):
    windows = data_folder / "refinery_loops" / "loops.csv.gz"
    if not windows.is_file():
        pytest.skip("SKLVALVE_DATA holds no refinery_loops")
    with open(windows.with_name("index.csv"), encoding="utf-8", newline="") as file:
        sticking = next(row for row in csv.DictReader(file) if row["tag"] == "2111FIC46005")
    with gzip.open(windows, "rt", encoding="utf-8", newline="") as file:
        rows = {r["t"]: r for r in csv.DictReader(file) if r["id"] == sticking["id"]}
    _write((row["t"], row["op"], row["pv"], row["sp"]) for row in rows.values())
    status, shown = _diagnosed(capsys)
    assert status == 0
    assert sorted(os.listdir("out")) == RESULTS
    assert "stiction" in shown
    assert "FIC-1" in (folder / "out" / "report.html").read_text(encoding="utf-8")
