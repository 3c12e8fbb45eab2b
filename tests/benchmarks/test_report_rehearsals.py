# SPDX-License-Identifier: BSD-3-Clause
"""Halves of sound histories as healthy recordings of another plant."""

import json

import pytest

from benchmarks.concealed.report.rehearsals import main, p_values_of, rehearsals_report


def _line(a_line, clean, *looks):
    rehearsals = [{"throughout": t, "within": w, "rest": r, "stem": s} for t, w, r, s in looks]
    return a_line(history={"clean": clean}) | {"rehearsals": rehearsals}


def test_halves_of_sound_histories_count_and_of_no_others(a_line):
    usual, strange = (0.5, 0.5, 1.0, 0.5), (8.0, 0.5, 1.0, 0.5)
    lines = [_line(a_line, True, usual), _line(a_line, True, strange, usual), _line(a_line, False, strange)]
    low, *others = p_values_of([*lines, a_line()])
    assert len(others) == 2
    assert low < 0.01 < others[0]


def test_the_report_gives_rates_or_says_why_there_are_none(a_line, tmp_path, capsys):
    assert rehearsals_report([a_line()]) == "No line holds a rehearsal of a sound history."
    file = tmp_path / "scores.jsonl"
    lines = [_line(a_line, True, (k / 3.0, 0.5, None, 0.5)) | {"record": f"r{k}"} for k in range(10)]
    file.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
    assert main([str(file)]) == 0
    shown = capsys.readouterr().out
    assert "| Kolmogorov-Smirnov p | " in shown
    assert shown.endswith(" of 10 |\n")


@pytest.mark.parametrize("times", [0.2, 1.0, 3.0])
def test_a_rehearsal_twice_as_far_is_rarer(a_line, times):
    near, far = (p_values_of([_line(a_line, True, (k * times, 0.5, 1.0, 0.5))])[0] for k in (1.0, 2.0))
    assert far <= near
