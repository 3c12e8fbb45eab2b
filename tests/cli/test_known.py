# SPDX-License-Identifier: BSD-3-Clause
"""``--valve`` left out: the valve.toml beside the recording, or what the columns tell; what is said."""

import json
import os

import numpy as np
import pytest

from sklvalve.cli import main
from tests.cli import stand_in
from tests.cli.refusal import refused
from tests.report import examples

TRAVEL = 50.0 + 40.0 * np.sin(np.arange(200.0) / 15.0)


@pytest.fixture
def alone(folder):
    """The folder without its valve.toml."""
    (folder / "valve.toml").unlink()
    return folder


def _recording(folder, **columns):
    (folder / "recording.csv").write_text(stand_in.csv_text({"time": np.arange(200.0)} | columns))


def _named(folder):
    _recording(folder, **{"FIC7.OP": TRAVEL, "FIC7.PV": 0.3 * TRAVEL, "ZT7": TRAVEL})


def test_from_a_recording_alone_to_a_report(alone, capsys):
    _named(alone)
    assert main(["diagnose", "recording.csv"]) == 0
    assert sorted(os.listdir(".")) == ["recording.csv", "results"]
    shown = capsys.readouterr()
    assert shown.err.count("\n") == 1
    assert "note: no --valve was given and no valve.toml found beside the recording" in shown.err
    assert "'FIC7.OP' the command, 'ZT7' the opening, 'FIC7.PV' the flow" in shown.err
    said = " ".join(shown.out.split())
    assert "Data data sheet, left out: no valve.toml was given: kv_rated (" in said
    assert "command, assumed: column 'FIC7.OP' (the ending OP); unit '%' (values from 10 to 90)" in said
    assert "flow, guessed: column 'FIC7.PV' (the value of a flow loop); unit 'm3/h' (no unit" in said
    assert "Next: sklvalve init recording.csv" in said


def test_the_report_and_the_json_say_what_was_assumed(alone, capsys):
    _named(alone)
    assert main(["diagnose", "recording.csv", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    kinds = {item["role"]: item["finding"] for item in found["data"]}
    assert kinds == {
        "data_sheet": "left_out",
        "command": "assumed",
        # of the stand-in's own findings one is about the opening, too, and stands last
        "opening": examples.named()["data"][0]["finding"],
        "flow": "guessed",
    }
    assert json.loads((alone / "results/diagnosis.json").read_text()) == found
    page = (alone / "results/report.html").read_text()
    assert "What was assumed" in page
    assert "Partly a guess: flow." in page
    assert "<td>guessed</td>" in page


def test_a_valve_beside_the_recording_is_used_and_named(folder, capsys):
    (folder / "plant").mkdir()
    for name in ("recording.csv", "valve.toml"):
        (folder / name).rename(folder / "plant" / name)
    assert main(["diagnose", "plant/recording.csv", "--json"]) == 0
    shown = capsys.readouterr()
    assert json.loads(shown.out) == examples.named()
    assert shown.err.startswith("note: plant/valve.toml, found beside the recording, describes the valve")
    assert shown.err.count("\n") == 1


def test_a_draft_is_found_by_the_next_command(alone, capsys):
    os.mkdir("plant")
    _named(alone / "plant")
    assert main(["init", "plant/recording.csv", "--yes"]) == 0
    assert os.path.exists("plant/valve.toml")
    capsys.readouterr()
    assert main(["diagnose", "plant/recording.csv"]) == 0
    assert "note: plant/valve.toml" in capsys.readouterr().err


def test_screen_says_the_same(alone, capsys):
    _named(alone)
    assert main(["screen", "recording.csv"]) == 0
    shown = capsys.readouterr()
    assert "note: no --valve was given" in shown.err
    assert "- Flow (guessed): column 'FIC7.PV'" in shown.out


REFUSED = {
    "nothing told": (
        {"alpha": TRAVEL, "beta": TRAVEL},
        "recording.csv: there is no valve.toml, and the columns' names ('alpha', 'beta') tell neither "
        "command, opening nor flow; run sklvalve init recording.csv, which asks",
    ),
    "command alone": (
        {"FIC7.OP": TRAVEL, "beta": TRAVEL},
        "('FIC7.OP', 'beta') tell only the command; run sklvalve init recording.csv",
    ),
    "two valves": (
        {"FIC71.OP": TRAVEL, "FIC71.PV": TRAVEL, "FIC72.OP": TRAVEL, "FIC72.PV": TRAVEL},
        "of several valves (71, 72) and no valve.toml chooses one; run sklvalve init recording.csv --tag 71",
    ),
    "no flow at all": (
        {"FIC7.OP": TRAVEL, "FIC7.PV": 0.0 * TRAVEL},
        "flow holds one value (0) in all rows; give a time in which it is measured",
    ),
}

# columns are understood; what is refused lies in an argument, in a cell, or in the length
UNRELATED = {
    "file twice": ([], ["recording.csv"], None),
    "until words": ([], ["--until", "noon"], None),
    "far beyond any plant": ([1e300], [], "far beyond any plant"),
}


@pytest.mark.parametrize(("head", "more", "words"), UNRELATED.values(), ids=UNRELATED)
def test_a_draft_is_offered_only_where_it_would_mend_something(alone, capsys, head, more, words):
    flow = 0.3 * TRAVEL
    flow[: len(head)] = head
    _recording(alone, **{"FIC7.OP": TRAVEL, "FIC7.PV": flow, "ZT7": TRAVEL})
    assert main(["diagnose", "recording.csv", *more]) == 2
    refusal = capsys.readouterr().err
    assert (words or more[-1]) in refusal
    assert "drafts one" not in refusal


@pytest.mark.parametrize("filled", [False, True])
def test_a_draft_that_nobody_filled_in_is_told_last(alone, capsys, filled):
    _named(alone)
    assert main(["init", "recording.csv", "--yes"]) == 0
    if filled:
        sheet = (alone / "valve.toml").read_text()
        (alone / "valve.toml").write_text(sheet.replace("# kv_rated", "kv_rated"))
    capsys.readouterr()
    assert main(["diagnose", "recording.csv"]) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.startswith("Next: fill in the data sheet, kv_rated and charac") is not filled


@pytest.mark.parametrize(("columns", "words"), REFUSED.values(), ids=REFUSED)
def test_too_little_is_told_by_names(alone, capsys, columns, words):
    _recording(alone, **columns)
    refused(["diagnose", "recording.csv"], words, capsys)


def test_a_command_with_a_cell_that_is_no_number_is_named(alone, capsys):
    command = TRAVEL.astype(object)
    command[7] = "bad?"
    _recording(alone, **{"FIC7.OP": command, "FIC7.PV": 0.3 * TRAVEL})
    assert main(["diagnose", "recording.csv"]) == 2
    refusal = capsys.readouterr().err
    assert "column 'FIC7.OP' (command), row 8" in refusal
    assert not (alone / "results").exists()


def test_a_command_beyond_its_range_is_named(alone, capsys):
    _recording(alone, **{"FIC7.OP": 4.0 * TRAVEL, "FIC7.PV": 0.3 * TRAVEL})
    assert main(["diagnose", "recording.csv"]) == 2
    refusal = capsys.readouterr().err
    assert "stays between 0 and 100 %" in refusal
    assert not (alone / "results").exists()
