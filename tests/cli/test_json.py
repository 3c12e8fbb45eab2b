# SPDX-License-Identifier: BSD-3-Clause
"""``--json``: every command that has a result prints one document, with its schema, and nothing else."""

import json

import pytest

from sklvalve.cli import main
from sklvalve.cli.entry import build_parser
from sklvalve.datasets import make_valve_recording
from sklvalve.datasets.concealed import to_toml
from tests.recording.historian.exports import course, iso, moments, wide_text

DIAGNOSE = ["diagnose", "recording.csv"]
SIMULATE = ["simulate", "--fault", "f7", "--begins", "20", "--duration", "60", "--out", "made/run.csv"]
PREDICT = ["predict", "recording.csv", "--model", "results/corrected_model.skops", "--out", "predictions.csv"]
COMMANDS = {
    "diagnose": (DIAGNOSE, {"verdict": "named"}),
    "screen": (["screen", "recording.csv"], {"rows": 160, "recording": "recording.csv"}),
    "import": (["import", "export.csv", "--out", "clean.csv"], {}),
    "learn": (
        ["learn", "long.csv", "--valve", "plant.toml", "--out", "fv101.history.skops"],
        {"written": "fv101.history.skops", "rows": 700, "windows": 1, "clean": False},
    ),
    "init": (["init", "recording.csv", "--out", "draft.toml"], {"written": "draft.toml", "not_enough": None}),
    "simulate": (
        SIMULATE,
        {
            "written": ["made/run.csv", "made/valve.toml"],
            "rows": 60,
            "fault": {"fault": "f7", "strength": 0.75, "begins": 20.0, "takes": 0.0},
        },
    ),
    "watch": (
        ["watch", "watched/plant.toml", "--data", "watched/rows", "--state", "watched/state"],
        {
            "plant": "Test",
            "valves": [
                {
                    "tag": "FV-1",
                    "state": "no data",
                    "said": [],
                    "since": None,
                    "called": None,
                    "call": None,
                    "looks": [],
                }
            ],
        },
    ),
    "predict": (
        PREDICT,
        {
            "written": "predictions.csv",
            "rows": 160,
            "columns": ["time", "opening", "flow", "flow_from_command"],
            "notes": [],
        },
    ),
}


@pytest.fixture
def files(folder):
    """The folder, with an export beside the recording, and a valve from which something can be learnt."""
    made = make_valve_recording(None, loop="wide", n_samples=700, n_later=0, random_state=3)
    made.frame.to_csv(folder / "long.csv", index=False)
    (folder / "plant.toml").write_text(to_toml(made.valve))
    (folder / "watched" / "rows").mkdir(parents=True)
    watched = 'name = "Test"\n[valve.FV-1]\nsheet = "../plant.toml"\n'
    (folder / "watched" / "plant.toml").write_text(watched)
    values = course(200)
    stamps = iso(moments("2024-06-28 10:00:00", 200, 10))
    (folder / "export.csv").write_text(wide_text(["FIC1.PV [m3/h]", "FIC1.OP [%]"], stamps, [values, values]))
    return folder


@pytest.mark.parametrize("command", COMMANDS)
def test_one_document_alone_on_standard_output(files, capsys, command):
    arguments, expected = COMMANDS[command]
    if command == "predict":
        assert main(DIAGNOSE) == 0
        capsys.readouterr()
    assert main([*arguments, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    schema = "diagnosis" if command == "diagnose" else command
    assert document["schema"] == f"sklvalve.{schema}/1"
    assert {key: document[key] for key in expected} == expected


def test_what_init_and_screen_found_is_in_the_document(files, capsys):
    assert main(["init", "recording.csv", "--out", "draft.toml", "--json"]) == 0
    drafted = json.loads(capsys.readouterr().out)
    assert drafted["roles"]["command"] == {"column": "CV", "why": "the ending CV", "sure": True}
    assert any(item.startswith("[valve] kv_rated") for item in drafted["to_fill_in"])
    (files / "valve.toml").unlink()
    assert main(["screen", "recording.csv", "--json"]) == 0
    findings = json.loads(capsys.readouterr().out)["data"]
    assert {"assumed", "guessed"} <= {each["finding"] for each in findings}


def test_the_demo_tells_finding_truth_and_judgement(folder, capsys, monkeypatch):
    import sklvalve.datasets

    original = sklvalve.datasets.make_valve_recording
    monkeypatch.setattr(
        sklvalve.datasets,
        "make_valve_recording",
        lambda **settings: original(**(settings | {"n_samples": 400, "n_later": 60})),
    )
    assert main(["demo", "--out", "tried", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert list(document) == ["schema", "written", "diagnosis", "truth", "judgement"]
    assert document["truth"] == json.loads((folder / "tried" / "truth.json").read_text())


def test_every_command_with_a_result_takes_it():
    commands = build_parser()._subparsers._group_actions[0].choices
    taking = {name for name, parser in commands.items() if "--json" in parser.format_help()}
    assert taking == set(commands) - {"completion"} == {*COMMANDS, "demo"}
