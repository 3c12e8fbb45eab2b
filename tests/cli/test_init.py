# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve init``: a draft from columns, by asking on a terminal, and never in place of what is there."""

import io
import os
import shlex
import subprocess
import sys

import numpy as np
import pytest

from sklvalve.cli import main
from sklvalve.recording import read_valve
from tests.cli import stand_in

INIT = ["init", "recording.csv"]


@pytest.fixture
def draft(folder):
    """The folder without its valve.toml."""
    (folder / "valve.toml").unlink()
    return folder


def _recording(folder, **columns):
    table = {"time": np.arange(200.0)} | columns
    (folder / "recording.csv").write_text(stand_in.csv_text(table))


TRAVEL = 50.0 + 40.0 * np.sin(np.arange(200.0) / 15.0)


def test_from_a_recording_to_a_report_in_two_commands(draft, capsys):
    _recording(draft, OP=TRAVEL, PV=0.3 * TRAVEL)
    assert main(INIT) == 0
    shown = capsys.readouterr().out
    assert "command  'OP' (from 10 to 90): the ending OP" in shown
    assert "To fill in, or to check:\n- [valve] kv_rated" in shown
    last = shown.splitlines()[-1]
    assert last == "Next: sklvalve diagnose recording.csv --valve valve.toml --out results"
    assert main(shlex.split(last.removeprefix("Next: sklvalve "))) == 0
    assert os.path.exists("results/report.html")


def test_what_is_there_is_not_replaced_unless_forced(folder, capsys):
    before = (folder / "valve.toml").read_text()
    assert main(INIT) == 2
    shown = capsys.readouterr()
    assert shown.err.startswith("sklvalve: valve.toml: it exists already")
    assert shown.err.count("\n") == 1
    assert (folder / "valve.toml").read_text() == before
    assert main([*INIT, "--out", "other.toml"]) == 0
    assert main([*INIT, "--force"]) == 0
    assert (folder / "valve.toml").read_text() == (folder / "other.toml").read_text() != before


def test_what_is_missing_for_a_diagnosis_is_said(draft, capsys):
    _recording(draft, alpha=TRAVEL, beta=TRAVEL)
    assert main(INIT) == 0
    shown = capsys.readouterr().out
    assert "- [recording.command]: which column is the command to the valve?" in shown
    assert "Not yet enough for a diagnosis: valve.toml: [recording] names no signal" in shown
    assert shown.splitlines()[-1].startswith("Then: sklvalve diagnose recording.csv")


def test_column_of_the_times_as_asked(draft):
    _recording(draft, OP=TRAVEL, PV=0.3 * TRAVEL, clock=10.0 * np.arange(200.0))
    assert main([*INIT, "--time-column", "clock"]) == 0
    assert read_valve("valve.toml").time == "clock"


def test_nothing_heavy_is_loaded(draft):
    """What takes longest to load, statistics and all that diagnoses, is not needed for a draft."""
    _recording(draft, OP=TRAVEL, PV=0.3 * TRAVEL, **{"P1 [bar]": np.full(200, 8.0)})
    heavy = ("scipy.stats", "scipy.signal", "scipy.optimize", "sklearn", "numba", "sklvalve.mismatch")
    code = (
        "import sys; from sklvalve.cli import main; status = main(['init', 'recording.csv', '--yes']);"
        f"print('loaded:', [name for name in {heavy} if name in sys.modules]); sys.exit(status)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "loaded: []"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["init"], "RECORDING"),
        (["init", "absent.csv"], "no such file"),
        (["init", "valve.txt"], "expected a file named .csv"),
        ([*INIT, "--out", "valve.json"], "the draft is TOML; name the file .toml"),
        ([*INIT, "--tag", "FIC9"], "--tag FIC9: no column of recording.csv has it in its name"),
        ([*INIT, "--out", "recording.csv/v.toml"], "is a file"),
        ([*INIT, "--time-column", "clok"], "--time-column clok: recording.csv has no such column"),
        ([*INIT, "--time-column", " "], "expected the name of a column; got ' '"),
    ],
)
def test_bad_arguments(draft, capsys, arguments, words):
    before = sorted(os.listdir("."))
    assert main(arguments) == 2
    shown = capsys.readouterr()
    assert words in shown.err
    assert shown.err.count("\n") == 1
    assert sorted(os.listdir(".")) == before


class Terminal(io.StringIO):
    """Standard input as a terminal."""

    def isatty(self):
        return True


def _answer(monkeypatch, *lines):
    monkeypatch.setattr(sys, "stdin", Terminal("".join(f"{line}\n" for line in lines)))
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)


def test_asks_on_a_terminal_what_is_in_doubt(draft, monkeypatch, capsys):
    columns = {"OP": TRAVEL, "PV": 0.3 * TRAVEL, "PT7": np.full(200, 8.0)}
    _recording(draft, **columns)
    _answer(
        monkeypatch,
        "",  # PV: flow, as proposed
        "p1",  # PT7
        "furlong",  # no unit of a pressure
        "bar",
        "l/min",  # unit of the flow
        "gau",  # PT7
        "FV-7",
        "many",  # no number
        "25",
        "eq",
        "50",
        "brine",
        "1,19e3",  # its density
    )
    assert main(INIT) == 0
    shown = capsys.readouterr().out
    assert "'PV' (from 3 to 27): which signal?" in shown
    assert "expected one of Pa, kPa" in shown
    assert "expected a number above 0; got 'many'" in shown
    valve = read_valve("valve.toml")
    assert {role: signal.column for role, signal in valve.roles.items()} == {
        "command": "OP",
        "p1": "PT7",
        "flow": "PV",
    }
    assert (valve.roles["flow"].unit, valve.roles["p1"].unit) == ("l/min", "bar")
    assert valve.roles["p1"].gauge
    assert "recording.p1] gauge" not in shown
    assert valve.fluid == {"name": "brine", "density": 1190.0}
    assert (valve.tag, valve.kv_rated, valve.characteristic, valve.rangeability) == (
        "FV-7",
        25.0,
        "equal_percentage",
        50.0,
    )


def test_enter_and_the_end_of_input_take_what_is_proposed(draft, monkeypatch, capsys):
    _recording(draft, OP=TRAVEL, PV=0.3 * TRAVEL)
    assert main([*INIT, "--out", "silent.toml"]) == 0
    _answer(monkeypatch, "")
    assert main(INIT) == 0
    assert read_valve("valve.toml") == read_valve("silent.toml")


@pytest.mark.parametrize("answers", [["water"], ["brine", ""]], ids=["water", "of unknown density"])
def test_the_fluid_stays_water(draft, monkeypatch, capsys, answers):
    _recording(draft, OP=TRAVEL, PV=0.3 * TRAVEL)
    # PV, its unit, the sense, the tag, capacity and trim stay as proposed
    _answer(monkeypatch, "", "", "", "", "", *answers)
    assert main(INIT) == 0
    shown = capsys.readouterr().out
    assert "Fluid, a liquid [water]: " in shown
    assert ("Density" in shown) is ("brine" in answers)
    assert read_valve("valve.toml").fluid == {}


def test_a_dash_leaves_a_column_out(draft, monkeypatch, capsys):
    _recording(draft, **{"OP": TRAVEL, "ZT": TRAVEL, "FV-7": TRAVEL, "PV": TRAVEL})
    _answer(monkeypatch, "", "-")  # OP, which FV-7 might be as well; PV
    assert main(INIT) == 0
    columns = {role: signal.column for role, signal in read_valve("valve.toml").roles.items()}
    assert columns == {"command": "OP", "opening": "ZT"}


@pytest.mark.parametrize("asked", [True, False])
def test_asks_nothing_when_told_so_or_without_a_terminal(draft, monkeypatch, asked):
    def refuse(question):
        raise AssertionError(question)

    if asked:
        _answer(monkeypatch)
    monkeypatch.setattr("builtins.input", refuse)
    assert main([*INIT, "--yes"] if asked else INIT) == 0


def test_interruption_leaves_nothing(draft, monkeypatch, capsys):
    _recording(draft, OP=TRAVEL, PV=0.3 * TRAVEL)
    _answer(monkeypatch)

    def interrupted(question):
        raise KeyboardInterrupt

    monkeypatch.setattr("builtins.input", interrupted)
    assert main(INIT) == 130
    assert capsys.readouterr().err == "interrupted; nothing was written\n"
    assert os.listdir(".") == ["recording.csv"]
