# SPDX-License-Identifier: BSD-3-Clause
"""What others wrote into files reaches no terminal raw, and no spreadsheet as a formula."""

import ast
import json
from pathlib import Path

import pytest

import sklvalve.cli
from sklvalve.cli import main
from sklvalve.cli.as_json import as_json
from sklvalve.cli.terminal import safe, show
from tests.cli import stand_in
from tests.recording.historian.exports import course, iso, moments, wide_text

ESCAPE = "\x1b]0;owned\x07\x85\u202e"


def obeyed(text):
    """Letters of a text that a terminal obeys or hides."""
    return {each for each in text if not each.isprintable() and each != "\n"}


def test_lines_stay_and_what_is_obeyed_is_written_out():
    assert safe("plain: ł °C\nnext") == "plain: ł °C\nnext"
    assert safe(f"a{ESCAPE}\nb\r") == "a\\x1b]0;owned\\x07\\x85\\u202e\nb\\r"
    assert safe("\ud800") == "\\ud800"


def test_json_stays_json():
    content = {"a": f"{ESCAPE}\U000e0001\ue000", "b": "ł\u00a0°"}
    assert not obeyed(as_json(content)) - {"\u00a0"}
    assert json.loads(as_json(content)) == content


def test_nothing_is_printed_but_by_show():
    for path in Path(sklvalve.cli.__file__).parent.glob("*.py"):
        if path.name in ("terminal.py", "completion.py"):  # the script of the latter holds our words alone
            continue
        calls = [node.func for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call)]
        assert not [call for call in calls if isinstance(call, ast.Name) and call.id == "print"], path


@pytest.fixture
def hostile(folder):
    """The stand-in's recording and sheet with a tag and a column that command a terminal."""
    for name in ("recording.csv", "valve.toml"):
        path = folder / name
        text = path.read_text().replace("FV-101", "FV\\u001b[2J-101")
        text = (
            text.replace('"F"', '"F\\u001b[2J"')
            if name == "valve.toml"
            else text.replace("X,F,", "X,F\x1b[2J,")
        )
        path.write_text(text)
    return folder


@pytest.mark.parametrize(
    "words",
    [
        ["screen", "recording.csv", "--valve", "valve.toml"],
        ["screen", "recording.csv", "--valve", "valve.toml", "--json"],
        ["diagnose", "recording.csv", "--valve", "valve.toml", "--out", "out"],
        ["init", "recording.csv", "--out", "draft.toml"],
        ["init", "recording.csv", "--out", "draft.toml", "--json", "--force"],
        ["diagnose", "no\x1b[2J.csv"],
        ["diagnose", "recording.csv", "--bogus\x1b[2J"],
        ["simulate", "--fault", "f\x1b[2J", "--out", "a.csv"],
    ],
    ids=lambda words: " ".join(words[:1]),
)
def test_commands_print_nothing_that_a_terminal_obeys(hostile, capsys, words):
    main(words)
    shown = capsys.readouterr()
    assert shown.out + shown.err
    assert not obeyed(shown.out + shown.err)


def test_import_of_hostile_tags(folder, capsys):
    rows = iso(moments("2024-01-01 00:00:00", 40, 1))
    values = [str(each) for each in course(40)]
    bad = [*values[:5], "Bad\x1b[2J", *values[6:]]
    export = folder / "export.csv"
    export.write_text(
        wide_text(["=cmd()", "@x", f"T{ESCAPE}"], rows, [values, values, bad]), encoding="utf-8"
    )
    assert main(["import", "export.csv", "--out", "clean.csv"]) == 0
    shown = capsys.readouterr()
    assert not obeyed(shown.out + shown.err)
    assert (folder / "clean.csv").read_text(encoding="utf-8").startswith("time,'=cmd(),'@x,")
    # the column is found by the name that it had
    sheet = (
        '[recording.flow]\ncolumn = "=cmd()"\nunit = "m3/h"\n[recording.command]\ncolumn = "@x"\nunit = "%"\n'
    )
    (folder / "other.toml").write_text(sheet)
    assert main(["screen", "clean.csv", "--valve", "other.toml"]) == 0


def test_a_long_value_is_cut_in_a_message(folder, capsys):
    table = stand_in.csv_text(stand_in.columns(160)).replace("100.0,", "z" * 100_000 + ",", 1)
    (folder / "recording.csv").write_text(table)
    assert main(["diagnose", "recording.csv", "--valve", "valve.toml"]) == 2
    shown = capsys.readouterr().err
    assert "zzz..." in shown
    assert len(shown) < 400


def test_progress_takes_no_markup(monkeypatch):
    rich = pytest.importorskip("rich", reason="needs rich")
    assert rich
    import io
    import sys

    class Terminal(io.StringIO):
        def isatty(self):
            return True

    from sklvalve.cli.progress import progress

    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress() as say:
        say("reading [/nothing] \x1b]0;owned\x07", 0.5)
    assert "\x1b]0;" not in terminal.getvalue()
    show("", file=terminal)
