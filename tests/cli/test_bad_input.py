# SPDX-License-Identifier: BSD-3-Clause
"""Bad input of every kind: exit status 2, one line on standard error, nothing written."""

import os
import subprocess
import sys
from types import SimpleNamespace

import pytest
from numpy.linalg import LinAlgError

from sklvalve.cli import main
from tests.cli import stand_in
from tests.cli.refusal import refused

DIAGNOSE = ["diagnose", "recording.csv", "--valve", "valve.toml", "--out", "out"]


def _table(**changes):
    table = stand_in.columns(160)
    for name, change in changes.items():
        table[name] = change(list(table[name]))
    return stand_in.csv_text(table)


def _replaced(values, row, value):
    values[row] = value
    return values


RECORDINGS = {
    "text in numbers": (_table(F=lambda v: _replaced(v, 3, "bad")), "row 4"),
    "doubled time": (_table(t=lambda v: _replaced(v, 5, v[4])), "stands twice"),
    "empty": ("", "empty"),
    "header alone": ("t,CV,X,F,P1\n", "no row"),
    "binary": ("\x00\x01\x02", "binary"),
    "too short": ("t,CV,X,F,P1\n0,1,1,1,500\n1,1,1,1,500\n", "too few"),
}
# read and screened, but not diagnosed
UNDIAGNOSABLE = {
    "no flow": (_table(F=lambda v: [0.0] * len(v)), "'F' (flow) never shows any flow"),
    "giant flow": (_table(F=lambda v: [1e300 * (x + 1.0) for x in v]), "far beyond any plant"),
    "negated flow": (_table(F=lambda v: [-x - 1.0 for x in v]), "is negative in 100 %"),
    "no pressure drop": (_table(P1=lambda v: [100.0] * len(v)), "nowhere above p2"),
    "held command": (_table(CV=lambda v: [50.0] * len(v)), "'CV' (command) holds one value"),
    "few flows": (_table(F=lambda v: [*v[:11], *[float("nan")] * (len(v) - 11)]), "only 11 of 160 rows"),
}
VALVES = {
    "unknown unit": (stand_in.VALVE.replace('"m3/h"', '"m3/hour"'), "m3/hour"),
    "unknown kind": (stand_in.VALVE + '\n[actuator]\nkind = "motor"\n', "[actuator] kind must be one of"),
    "negative stroke time": (
        stand_in.VALVE + "\n[actuator]\nstroke_time = -20.0\n",
        "[actuator] stroke_time must be above 0",
    ),
    "malformed": (stand_in.VALVE + "\n[recording.", "no valid TOML"),
    "unknown role": (stand_in.VALVE.replace("recording.p1", "recording.p9"), "p9"),
    "no rangeability": (
        stand_in.VALVE.replace("tag =", 'characteristic = "equal_percentage"\ntag ='),
        "needs rangeability",
    ),
    "table without ends": (
        stand_in.VALVE.replace("tag =", "characteristic = [[0.1, 0.0], [0.9, 1.0]]\ntag ="),
        "from opening 0 to opening 1",
    ),
    "unknown fluid": (stand_in.VALVE + '[fluid]\nname = "wather"\n', "'wather'"),
    "gas": (stand_in.VALVE + "[fluid]\nmolar_mass = 29.0\n", "a gas flows"),
    "no positioner": (stand_in.VALVE + "[actuator]\npositioner = false\n", "positioner = false"),
    "vapour pressure in Pa": (
        stand_in.VALVE + "[fluid]\nvapour_pressure = 25000\n",
        "vapour_pressure = 25000 kPa is not below the critical pressure of water",
    ),
    "critical pressure in MPa": (
        stand_in.VALVE + "[fluid]\ncritical_pressure = 22.064\n",
        "critical_pressure must be at least 200 and at most",
    ),
    "spring without a range": (
        stand_in.VALVE + "[actuator]\nspring_range = [99.99, 100.0]\n",
        "spring_range must be two numbers at least 5 kPa apart",
    ),
    "giant supply": (stand_in.VALVE + "[actuator]\nsupply_pressure = 1e9\n", "at most 2000 kPa"),
    "giant capacity": (
        stand_in.VALVE.replace("tag =", f"kv_rated = 1{'0' * 400}\ntag ="),
        "valve.toml: [valve] kv_rated must be a finite number",
    ),
    "endless number": (
        stand_in.VALVE.replace("tag =", f"kv_rated = {'9' * 5000}\ntag ="),
        "valve.toml: a number",
    ),
    "endless nesting": (stand_in.VALVE.replace("tag =", f"fl = {'[' * 5000}\ntag ="), "valve.toml: brackets"),
    "one column twice": (
        stand_in.VALVE.replace('column = "X"', 'column = "CV"'),
        "[recording.opening] names column 'CV', which is the command already",
    ),
    "no signals": ('[valve]\ntag = "FV"\n', "names no signal"),
}
ARGUMENTS = {
    "no command": ([], "required"),
    "unknown command": (["diagnoze"], "invalid choice"),
    "no recording named": (["diagnose"], "RECORDING"),
    "seed of words": ([*DIAGNOSE, "--seed", "some"], "whole number"),
    "recording of a wrong kind": (["diagnose", "valve.toml", *DIAGNOSE[2:]], "expected a file named .csv"),
    "until words": ([*DIAGNOSE, "--until", "noon"], "no time of this recording"),
    "until nan": (
        [*DIAGNOSE, "--until", "nan"],
        "'nan' is no time of this recording; give a number of seconds like 100\n",
    ),
    "out without a name": ([*DIAGNOSE[:-1], ""], "expected the name of a folder"),
    "demo without a name": (["demo", "--out", " "], "expected the name of a folder"),
    "model is a folder": (["predict", "recording.csv", "--model", ".", "--out", "p.csv"], "this is a folder"),
    "until before all": ([*DIAGNOSE, "--until", "3"], "give a time between 100.0 and 259.0"),
    "until after all": ([*DIAGNOSE, "--until", "500"], "give a time between 100.0 and 259.0"),
    "out under a file": ([*DIAGNOSE[:-1], "valve.toml/sub/out"], "is a file"),
    "screen without recording": (["screen", "absent.csv", "--valve", "valve.toml"], "no such file"),
    "no model": (["predict", "recording.csv", "--model", "no.skops", "--out", "p.csv"], "no such file"),
    "predictions as Parquet": (["predict", "recording.csv", "--model", "m", "--out", "p.parquet"], ".csv"),
    "demo in a file": (["demo", "--out", "valve.toml"], "is a file"),
}


@pytest.mark.parametrize(("content", "words"), RECORDINGS.values(), ids=RECORDINGS)
@pytest.mark.parametrize("arguments", [DIAGNOSE, ["screen", *DIAGNOSE[1:4]]], ids=["diagnose", "screen"])
def test_recording(folder, capsys, content, words, arguments):
    (folder / "recording.csv").write_text(content)
    refused(arguments, words, capsys)


@pytest.mark.parametrize(("content", "words"), UNDIAGNOSABLE.values(), ids=UNDIAGNOSABLE)
def test_recording_that_can_be_screened_only(folder, capsys, content, words):
    (folder / "recording.csv").write_text(content)
    assert main(["screen", *DIAGNOSE[1:4]]) == 0
    capsys.readouterr()
    refused(DIAGNOSE, words, capsys)


@pytest.mark.parametrize(("content", "words"), VALVES.values(), ids=VALVES)
def test_valve(folder, capsys, content, words):
    (folder / "valve.toml").write_text(content)
    refused(DIAGNOSE, words, capsys)


@pytest.mark.parametrize("arguments", [DIAGNOSE, ["screen", *DIAGNOSE[1:4]]], ids=["diagnose", "screen"])
def test_liquid_that_would_boil_before_the_valve(folder, capsys, arguments):
    (folder / "valve.toml").write_text(stand_in.VALVE + "[fluid]\nvapour_pressure = 2339\n")
    refused(arguments, "vapour_pressure = 2339 kPa, but p1 lies around 500 kPa", capsys)


@pytest.mark.parametrize(("arguments", "words"), ARGUMENTS.values(), ids=ARGUMENTS)
def test_arguments(folder, capsys, arguments, words):
    refused(arguments, words, capsys)


@pytest.mark.slow
@pytest.mark.parametrize(("until", "rows"), [("100", 1), ("218", 119)])
def test_too_few_rows_before_a_time(folder, capsys, until, rows):
    (folder / "recording.csv").write_text(stand_in.csv_text(stand_in.columns(150)))
    stand = "stands" if rows == 1 else "stand"
    words = f"--until {until}: only {rows} of 150 rows of recording.csv {stand} at or before it"
    refused([*DIAGNOSE, "--until", until], words, capsys)
    refused([*DIAGNOSE, "--until", until], "give 219.0 or a later time", capsys)
    assert main([*DIAGNOSE, "--until", "219"]) == 0


@pytest.mark.parametrize("rows", [20, 119])
def test_few_rows_are_told_how_many_a_diagnosis_needs(folder, capsys, rows):
    (folder / "recording.csv").write_text(stand_in.csv_text(stand_in.columns(rows)))
    refused(DIAGNOSE, f"{rows} rows are too few for a diagnosis; give at least 120", capsys)
    assert main(["screen", *DIAGNOSE[1:4]]) == 0


def test_result_that_is_a_folder(folder, capsys):
    os.makedirs("out/report.html")
    refused(DIAGNOSE, "no plain file", capsys)
    assert os.listdir("out") == ["report.html"]


def test_unwritable_folder(folder, capsys, monkeypatch):
    def denied(base):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("sklvalve.cli.staging.make_held", denied)
    refused(DIAGNOSE, "cannot be written (Permission denied)", capsys)


def test_mistake_of_the_reader_for_missing_pandas(folder, capsys, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    refused(DIAGNOSE, 'pip install "sklvalve[io]"', capsys)


@pytest.mark.parametrize("error", [OverflowError(34, "too large"), LinAlgError("no convergence")])
def test_numbers_that_break_down_all_the_same(folder, capsys, monkeypatch, error):
    def breaks(finder, recording, until=None):
        raise error

    monkeypatch.setattr(stand_in.Finder, "fit", breaks)
    refused(DIAGNOSE, "break the computation", capsys)


@pytest.mark.parametrize(
    "error", [ValueError("array of\nsample points"), OSError(5, "Input/output error"), KeyError(3)]
)
def test_error_that_nobody_foresaw(folder, capsys, monkeypatch, error):
    def breaks(path, valve):
        raise error

    monkeypatch.delenv("SKLVALVE_DEBUG", raising=False)
    monkeypatch.setattr("sklvalve.recording.read_recording", breaks)
    monkeypatch.setattr("sys.flags", SimpleNamespace(dev_mode=False))
    refused(["screen", *DIAGNOSE[1:4]], f"an unexpected error ({type(error).__name__}: ", capsys)
    monkeypatch.setenv("SKLVALVE_DEBUG", "1")
    with pytest.raises(type(error)):
        main(["screen", *DIAGNOSE[1:4]])


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full, a device that is always full")
@pytest.mark.parametrize(
    ("arguments", "unbuffered", "words"),
    [
        (["--version"], "", "standard output cannot be written (No space left"),
        (["screen", *DIAGNOSE[1:4]], "", "standard output cannot be written (No space left"),
        (["screen", *DIAGNOSE[1:4]], "1", "the disk is full (No space left on device), or standard output"),
    ],
    ids=["version", "screen", "screen unbuffered"],
)
def test_output_that_cannot_be_written(folder, arguments, unbuffered, words):
    with open("/dev/full", "w") as full:
        run = subprocess.run(
            [sys.executable, "-m", "sklvalve", *arguments],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            env=os.environ | {"PYTHONUNBUFFERED": unbuffered},
        )
    assert run.returncode == 2
    assert run.stderr.startswith(f"sklvalve: {words}")
    assert run.stderr.count("\n") == 1
