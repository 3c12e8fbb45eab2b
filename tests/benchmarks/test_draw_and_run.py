# SPDX-License-Identifier: BSD-3-Clause
"""From a seed to records and lines of scores: drawn the same, sealed, judged once, gone on with."""

import json
import shutil
from collections import Counter

import pytest

from benchmarks.concealed import judging, run
from benchmarks.concealed.cases import ONLY_IN, STEPS, plan
from benchmarks.concealed.draw import broken_seals, draw, made_of, seal, write
from benchmarks.concealed.plant import EFFECTS, NAMED

SIZES = {"healthy": 2, "each": 0, "pairs": 0, "outside": 1, "defects": 0}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("drawn") / "set"
    draw(place, 5, report=lambda text: None, **SIZES)
    seal(place)
    return place


def test_the_plan_has_what_was_asked():
    cases = plan(1)
    kinds = Counter(case.kind for case in cases)
    assert kinds == {"healthy": 200, "single": 6 * len(NAMED), "outside": 80, "pair": 60, "defect": 16}
    assert len(cases) >= 600
    of_each = Counter((c.effects[0], c.step) for c in cases if c.kind == "single")
    assert all(of_each[name, step] == 2 for name in NAMED for step in STEPS)
    assert plan(1) == cases
    assert plan(2) != cases
    for case in cases:
        assert all(case.excitation in ONLY_IN.get(n, (case.excitation,)) for n in case.nasty)
        assert all(case.excitation in (EFFECTS[n].asks or (case.excitation,)) for n in case.effects)


@pytest.mark.slow
def test_a_draw_that_was_stopped_goes_on_and_gives_the_same(folder, tmp_path):
    half = tmp_path / "set"
    draw(half, 5, part=(1, 2), report=lambda text: None, **SIZES)
    some = sorted(p.name for p in half.glob("record_*"))
    assert 0 < len(some) < 3
    draw(half, 5, report=lambda text: None, **SIZES)
    for name in sorted(p.name for p in half.glob("record_*")):
        for file in (half / name).iterdir():
            assert file.read_bytes() == (folder / name / file.name).read_bytes()
    assert not list(half.glob(".*"))


def test_a_truth_that_was_changed_is_seen(folder):
    assert broken_seals(folder) == []
    truth = next(folder.glob("record_*/truth.json"))
    before = truth.read_text()
    truth.write_text(before.replace('"rows"', '"rows" '))
    assert broken_seals(folder) == [truth.parent.name]
    truth.write_text(before)


def test_a_record_can_be_read_and_holds_no_hint(folder):
    from sklvalve import read_recording

    for place in folder.glob("record_*"):
        recording = read_recording(place / "recording.csv.gz", place / "valve.toml")
        truth = json.loads((place / "truth.json").read_text())
        assert len(recording) == truth["rows"]
        text = (place / "valve.toml").read_text()
        assert not any(name in text for name in (*truth["concealed"], *truth["nasty"]))


def quiet(recording, *, folder=None):
    return {"verdict": "no_mismatch", "mismatch": {"p_value": 0.5}, "effects": [], "flagged": [1, 0]}


def broken(recording, *, folder=None):
    raise ZeroDivisionError("nothing")


@pytest.mark.parametrize("stand_in", [quiet, broken])
def test_a_line_of_scores(folder, monkeypatch, stand_in):
    monkeypatch.setattr(judging, "method", lambda name: stand_in)
    place = next(folder.glob("record_*"))
    line = json.loads(json.dumps(judging.line_of(place, "sklvalve")))
    assert line["truth"]["name"] == place.name
    if stand_in is broken:
        assert line["failed"] == "ZeroDivisionError: nothing"
        assert "found" not in line
    else:
        assert line["found"]["verdict"] == "no_mismatch"
        assert line["rows"]["told"] == [[0, 1]]
        assert line["errors"] == {}


def test_what_is_refused_names_the_file_and_not_the_machine(folder, tmp_path):
    place = tmp_path / "record"
    shutil.copytree(next(folder.glob("record_*")), place)
    (place / "recording.csv.gz").write_bytes(b"no recording")
    line = judging.line_of(place, "sklvalve")
    assert "recording.csv.gz" in line["failed"]
    assert str(tmp_path) not in line["failed"]


def test_a_record_that_another_process_wrote_meanwhile_stays(tmp_path):
    made = made_of(plan(3, healthy=1, each=0, pairs=0, outside=0, defects=0)[0], 3)
    place = tmp_path / "record_0000"
    write(place, made)
    before = (place / "truth.json").stat().st_mtime_ns
    write(place, made)
    assert (place / "truth.json").stat().st_mtime_ns == before
    assert [p.name for p in tmp_path.iterdir()] == ["record_0000"]


def test_a_line_that_was_cut_off_is_taken_away(tmp_path):
    file = tmp_path / "scores_x.jsonl"
    whole = json.dumps({"record": "a", "truth": {}})
    file.write_text(whole + "\n" + whole[:9])
    assert [line["record"] for line in run.whole_lines(file)] == ["a"]
    assert file.read_text() == whole + "\n"
    assert run.whole_lines(tmp_path / "none.jsonl") == []


def test_lines_that_are_no_scores_are_gone_on_with_too(tmp_path):
    file = tmp_path / "next_test.jsonl"
    file.write_text('{"number": 0}\n{"number": 1}\n{"num')
    assert [line["number"] for line in run.plain_lines(file)] == [0, 1]
    assert file.read_text() == '{"number": 0}\n{"number": 1}\n'
    assert run.plain_lines(tmp_path / "none.jsonl") == []
