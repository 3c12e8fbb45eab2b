# SPDX-License-Identifier: BSD-3-Clause
"""Records of a published run, judged again."""

import pytest

from benchmarks.concealed.again import compared, main, same_record


def _line(record, verdict, effects=()):
    truth = {"kind": "single", "effects": ["stiction"], "verdict": "named", "distinguishable": True}
    return {
        "record": record,
        "truth": truth,
        "found": {"verdict": verdict, "effects": list(effects)},
    }


def test_both_judgements_stand_beside_each_other():
    named = [{"members": [{"name": "stiction", "probability": 0.9}], "class": ["stiction"]}]
    before = [_line("a", "named", named), _line("b", "no_mismatch"), _line("c", "no_mismatch")]
    today = [_line("b", "named", named), _line("a", "no_mismatch")]
    text = compared(before, today)
    assert text.startswith("2 records, 2 of them with the published truth")
    assert "1 won, 1 lost" in text
    assert "| missed | right | 1 |" in text


@pytest.mark.parametrize(("size", "same"), [(0.25, True), (0.25 * (1.0 + 1e-12), True), (0.2501, False)])
def test_a_record_is_the_published_one(size, same):
    published = {"effects": ["stiction"], "strengths": {"stiction": 0.25}, "distances": {"nothing": 3.0}}
    today = {"effects": ["stiction"], "strengths": {"stiction": size}, "distances": {"nothing": 4.0}}
    assert same_record(published, today) is same
    assert not same_record(published, today | {"onset": 3.0})


def test_the_tables_alone_need_no_draw(tmp_path, capsys):
    (tmp_path / "scores_sklvalve.jsonl").write_text("")
    assert main([str(tmp_path), "--seed", "69400423", "--table"]) == 0
    assert capsys.readouterr().out.startswith("0 records")
