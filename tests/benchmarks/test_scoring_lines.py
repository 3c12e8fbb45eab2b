# SPDX-License-Identifier: BSD-3-Clause
"""Reading lines of scores, and what they say whatever they leave out."""

import json

import pytest

from benchmarks.concealed.scoring.lines import (
    by_method,
    concealed,
    distances_of,
    distinguishable_only,
    excitation_of,
    failed,
    kind_of,
    read_lines,
    size_step,
    times_of,
    told_mismatch,
    verdict_of,
)


def written(path, *lines):
    path.write_text("\n".join(json.dumps(line) for line in lines) + "\n", encoding="utf-8")
    return path


def test_lines_that_were_cut_off_count_as_not_written(tmp_path):
    line = {"record": "a", "folder": "f", "truth": {"effects": []}}
    path = written(tmp_path / "s.jsonl", line, line | {"record": "b"})
    path.write_text(path.read_text() + json.dumps(line | {"record": "c"})[:30])
    assert [read["record"] for read in read_lines(path)] == ["a", "b"]
    path.write_text("")
    assert read_lines(path) == read_lines() == []
    path.write_text('3\nnull\n{"record": "no truth"}\n')
    assert read_lines(path) == []


def test_the_later_of_two_lines_of_one_record_counts(tmp_path):
    line = {"record": "a", "folder": "f", "truth": {}}
    first = written(tmp_path / "1.jsonl", line | {"seconds": 1.0}, line | {"method": "other"})
    second = written(tmp_path / "2.jsonl", line | {"seconds": 2.0}, line | {"folder": "g"})
    lines = read_lines(first, second)
    assert len(lines) == 3
    assert [line.get("seconds") for line in lines if line["folder"] == "f"] == [None, 2.0]
    assert {name: len(some) for name, some in by_method(lines).items()} == {"other": 1, "sklvalve": 2}


@pytest.mark.parametrize(
    ("truth", "kind"),
    [
        ({"effects": [], "verdict": "no_mismatch"}, "healthy"),
        ({"effects": ["a"], "verdict": "named"}, "single"),
        ({"effects": ["a", "b"]}, "pair"),
        ({"effects": [], "verdict": "none_of_these"}, "outside"),
        ({"effects": [], "kind": "outside", "verdict": "cannot_tell"}, "outside"),
        ({}, "healthy"),
    ],
)
def test_kinds(truth, kind):
    assert kind_of({"truth": truth}) == kind


def test_what_is_missing_is_none(a_line):
    line = {"truth": {}}
    assert failed(line)
    for ask in (verdict_of, told_mismatch, size_step, times_of, excitation_of):
        assert ask(line) is None
    assert distances_of(line) == (None, None, None)
    assert concealed(line) == "nothing"
    assert distinguishable_only([line, a_line("a", distinguishable=False)]) == []


def test_distances_leave_out_absent_effects(a_line):
    line = a_line("a", distances={"nothing": 30.0, "others": {"b": 8.0, "c": None}})
    assert distances_of(line) == (30.0, 8.0, 8.0)
    assert distances_of(a_line("a", distances={"nothing": 4.0, "others": {}})) == (4.0, None, 4.0)
    assert distances_of(a_line("a", distances=None)) == (None, None, None)


def test_excitation(a_line):
    assert excitation_of(a_line(loop="wide")) == "wide"
    assert excitation_of(a_line(excitation="cascade", loop="closed")) == "cascade"


def test_sizes(a_line):
    assert times_of(a_line("a", times=1.5, size_step=1.0)) == 1.5
    assert times_of(a_line("a", size_step=2.0)) == 2.0
    assert times_of(a_line("a+b", detectable={"a": {"times": 3.0}, "b": {"times": 2.5}})) == 2.5
