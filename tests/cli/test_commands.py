# SPDX-License-Identifier: BSD-3-Clause
import re
import subprocess
import sys
import time

import pytest

import sklvalve
from sklvalve.cli import main
from sklvalve.cli.progress import progress
from tests.cli import stand_in

COMMANDS = ("completion", "demo", "diagnose", "import", "init", "learn", "predict", "screen", "simulate")


def test_help_lists_the_commands_and_loads_no_numbers():
    code = (
        "import sys\nfrom sklvalve.cli import main\nassert main(['--help']) == 0\n"
        "assert not {'numpy', 'scipy', 'sklearn', 'numba', 'pandas'} & set(sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    for command in COMMANDS:
        assert f"    {command} " in run.stdout


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_has_help(command, capsys):
    assert main([command, "--help"]) == 0
    assert capsys.readouterr().out.startswith(f"usage: sklvalve {command}")


def test_module_is_the_command():
    run = subprocess.run(
        [sys.executable, "-m", "sklvalve", "--version"], capture_output=True, text=True, check=False
    )
    assert (run.returncode, run.stdout) == (0, f"sklvalve {sklvalve.__version__}\n")


def test_screen_tells_findings_in_sentences(folder, capsys):
    table = stand_in.columns(400)
    table["X"][100:130] = float("nan")
    (folder / "recording.csv").write_text(stand_in.csv_text(table))
    assert main(["screen", "recording.csv", "--valve", "valve.toml"]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "recording.csv: 400 rows from 100.0 to 499.0, holding command, opening, flow" in shown
    assert "- Opening (gap): 30 of 400 values missing" in shown
    assert "rows 101 to 130." in shown


def test_screen_of_sound_data_says_so(folder, capsys, monkeypatch):
    monkeypatch.setattr("sklvalve.recording.screen_recording", lambda recording: [])
    assert main(["screen", "recording.csv", "--valve", "valve.toml"]) == 0
    assert capsys.readouterr().out.endswith("Nothing is wrong with the data.\n")


def test_progress_is_silent_where_nobody_watches(capsys):
    with progress() as callback:
        assert callback is None
    assert capsys.readouterr().err == ""


def test_progress_is_shown_to_a_person(monkeypatch, capsys):
    pytest.importorskip("rich", reason='needs pip install "sklvalve[cli]"')
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setenv("TERM", "xterm")
    with progress() as callback:
        callback("calibrating", 0.25)
        time.sleep(0.2)
        callback("comparing", 0.5)
        time.sleep(0.2)
        callback("comparing", 0.75)
    shown = capsys.readouterr()
    assert "comparing" in shown.err
    assert re.search(r"left\W[^-]*0:00:0\d", re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown.err))
    assert shown.out == ""
