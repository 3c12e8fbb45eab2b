# SPDX-License-Identifier: BSD-3-Clause
"""The judge of blind trials: what counts as what, exact intervals, a trial that goes on where it stopped."""

import json
import runpy
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "benchmarks" / "concealed"
TABLES = runpy.run_path(str(FOLDER / "tables.py"))
judge = TABLES["judge"]


def row(true, verdict, *classes, concealed=None, truth_verdict=None, parameters=None, told=None):
    """A line of scores: true names, and what was found as strings like "a/b"."""
    found = [
        {"members": [{"name": n} for n in names.split("/")], "parameters": parameters or {}}
        for names in classes
    ]
    truth = {
        "effects": list(true),
        "verdict": truth_verdict or ("named" if true else "no_mismatch"),
        "concealed": list(concealed or true),
        "loop": "wide",
        "noise": 1.0,
        "onset": 0.0,
        "parameters": told or {},
    }
    found = {"verdict": verdict, "effects": found}
    return {"record": "r", "truth": truth, "found": found, "seconds": 1.0, "load": 1.0, "code": "x"}


@pytest.mark.parametrize(
    ("scored", "outcome"),
    [
        (row([], "no_mismatch"), "right"),
        (row([], "cannot_tell"), "alarm"),
        (row([], "named", "erosion"), "alarm"),
        (row(["erosion"], "named", "seat_leakage/erosion"), "right"),
        (row(["erosion"], "named", "seat_leakage"), "wrong name"),
        (row(["erosion"], "named", "erosion", "stiction"), "wrong name"),
        (row(["erosion"], "cannot_tell", "erosion"), "cannot tell"),
        (row(["erosion"], "cannot_tell", "stiction"), "wrong name"),
        (row(["erosion"], "cannot_tell"), "cannot tell"),
        (row(["erosion"], "none_of_these"), "none of these"),
        (row(["erosion"], "no_mismatch"), "missed"),
        (row([], "none_of_these", truth_verdict="none_of_these"), "right"),
        (row([], "named", "erosion", truth_verdict="none_of_these"), "wrong name"),
        (row([], "no_mismatch", truth_verdict="none_of_these"), "missed"),
        (row(["erosion", "stiction"], "named", "erosion", "stiction/friction"), "both found"),
        (row(["erosion", "stiction"], "named", "erosion"), "one found"),
        (row(["erosion", "stiction"], "named", "erosion", "clogging"), "wrong name"),
        (row(["erosion", "stiction"], "no_mismatch"), "neither"),
        (row(["erosion"], "named", "erosion") | {"failed": "ValueError"}, "failed"),
    ],
)
def test_one_word_for_what_came_of_a_record(scored, outcome):
    assert judge(scored) == outcome


def test_intervals_of_rates_are_exact():
    """Against the published limits of Clopper and Pearson: 0 of 10, 1 of 52, 23 of 36, all of 5."""
    exact = TABLES["exact"]
    assert exact(0, 10) == pytest.approx((0.0, 30.85), abs=0.01)
    assert exact(5, 5) == pytest.approx((47.82, 100.0), abs=0.01)
    assert exact(1, 20) == pytest.approx((0.127, 24.87), abs=0.01)
    low, high = exact(23, 36)
    assert low < 100.0 * 23 / 36 < high


def test_an_interval_is_looked_at_where_it_is_of_the_same_quantity():
    intervals = TABLES["intervals"]
    told = {"backlash": {"parameter": "width", "value": 0.03, "unit": "1"}}
    given = {"width": {"value": 0.033, "unit": "1", "ci95": [0.028, 0.038]}}
    plug = given | {"overshoot": {"value": 0.0, "unit": "1", "ci95": None}}
    right = row(["backlash"], "named", "backlash/friction", parameters=plug, told=told)
    assert list(intervals(right)) == [("backlash", True, pytest.approx(0.1))]
    linkage = row(["backlash"], "named", "backlash", parameters=given, told=told)
    assert list(intervals(linkage)) == []  # play before the sensor, where it was concealed behind it
    linkage["truth"]["concealed"] = ["linkage_backlash"]
    assert [inside for _, inside, _ in intervals(linkage)] == [True]
    second = row(["backlash"], "named", "friction/backlash", parameters=plug, told=told)
    assert list(intervals(second)) == []
    plug["width"]["ci95"] = [0.031, 0.035]
    narrow = row(["backlash"], "named", "backlash", parameters=plug, told=told)
    assert [inside for _, inside, _ in intervals(narrow)] == [False]


def test_tables_count_what_there_is():
    rows = [row([], "no_mismatch"), row([], "named", "erosion"), row(["erosion"], "named", "a/b/erosion")]
    rows += [row(["erosion"], "named", "stiction"), row(["erosion", "stiction"], "named", "erosion")]
    rows += [row([], "cannot_tell", truth_verdict="none_of_these", concealed=["trim_rotation"])]
    text = TABLES["summary"](rows)
    assert "| all | 2 | 1 | 50 % (1-99) |" in text
    assert "| erosion | 2 | 1 | 1 | 0 | 0 | 0 | 0 | 50 % (1-99) | 50 % (1-99) | 3.0 |" in text
    assert "| erosion + stiction | 1 | 0 | 1 | 0 | 0 | 0 |" in text
    assert "| trim_rotation | 1 | 0 | 1 | 0 | 0 | 0 |" in text
    assert "6 records" in text


def test_a_trial_goes_on_where_it_stopped_and_is_shared(tmp_path, monkeypatch, capsys):
    script = runpy.run_path(str(FOLDER / "score.py"))
    for i in range(5):
        (tmp_path / f"record_{i}").mkdir()
        (tmp_path / f"record_{i}" / "truth.json").write_text("{}")
    seen = []

    def quick(place):
        seen.append(place.name)
        errors = {"corrected": [1.0, 1.0], "nominal": [1.0, 1.0]}
        return row([], "no_mismatch") | {"folder": "f", "record": place.name, "errors": errors}

    main = script["main"]
    monkeypatch.setitem(main.__globals__, "score", quick)
    main([str(tmp_path), "--part", "1/2"])
    assert seen == ["record_0", "record_2", "record_4"]
    out = tmp_path / "scores_1_of_2.jsonl"
    lines = out.read_text().splitlines()
    # stopped while it wrote the last line
    out.write_text("\n".join([*lines[:2], lines[2][:40]]))
    main([str(tmp_path), "--part", "1/2"])
    assert seen[3:] == ["record_4"]
    assert [json.loads(line)["record"] for line in out.read_text().splitlines()] == seen[:3]
    main([str(tmp_path), "--part", "2/2"])
    capsys.readouterr()
    main(["--combine", str(out), str(tmp_path / "scores_2_of_2.jsonl")])
    told = capsys.readouterr().out
    assert sum(line.startswith("| record_") for line in told.splitlines()) == 5
    assert "| all | 5 | 0 | 0 % (0-52) |" in told
