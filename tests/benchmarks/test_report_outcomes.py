# SPDX-License-Identifier: BSD-3-Clause
"""Outcomes of records, counted as README has them."""

import json

import pytest

from benchmarks.concealed.report.outcomes import HEAD, classes, main, rows_of


@pytest.fixture
def lines(a_line, a_failure):
    return [
        a_line("", "no_mismatch"),
        a_line("", "cannot_tell"),
        a_line("erosion", "named", "erosion/clogging", size_step=1.0),
        a_line("erosion", "cannot_tell", "clogging", size_step=1.0),
        a_line("erosion", "no_mismatch", size_step=2.0),
        a_line("erosion", "none_of_these", size_step=2.0),
        a_failure("erosion"),
        a_failure(""),
        a_line("erosion+stiction", "named", "erosion", "stiction"),
        a_line("erosion+stiction", "named", "erosion"),
        a_line("erosion+stiction", "no_mismatch"),
        a_line("erosion+stiction", "cannot_tell"),
    ]


def test_every_record_is_counted_once(lines):
    rows = {row[0]: row[1:] for row in rows_of(lines)}
    assert len(HEAD) == 6
    assert rows == {
        "3 healthy": [1, 0, 2, 0, 0],
        "1 with one effect": [0, 0, 0, 0, 1],
        "2 with one effect, size 1": [1, 1, 0, 0, 0],
        "2 with one effect, size 2": [0, 0, 0, 1, 1],
        "4 with two effects": ["1 both, 1 one", 0, 0, 1, 1],
    }


def test_only_classes_of_a_named_verdict_are_names(lines):
    assert [(held, many) for held, _, many in classes(lines)] == [(True, 2), (True, 1), (True, 1), (True, 1)]


def test_the_command(lines, tmp_path, capsys):
    file = tmp_path / "scores.jsonl"
    file.write_text("".join(json.dumps(line | {"record": str(k)}) + "\n" for k, line in enumerate(lines)))
    # records of two draws may have one name
    assert main([str(file), str(file)]) == 0
    printed = capsys.readouterr().out
    assert "| 6 healthy | 2 | 0 | 4 | 0 | 0 |" in printed
    assert "Records with a wrong name: 8 % (1-27)." in printed
    with pytest.raises(SystemExit, match="2"):
        main([str(tmp_path / "none.jsonl")])
