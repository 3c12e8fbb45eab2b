# SPDX-License-Identifier: BSD-3-Clause
"""Tables and curves count what there is, and say "-" where there is nothing."""

import json

import pytest

from benchmarks.concealed.report.__main__ import main
from benchmarks.concealed.report.breakdown import nasty, outcomes, outcomes_by, overview
from benchmarks.concealed.report.comparison import comparison
from benchmarks.concealed.report.curves import power_curve, reliability_curve
from benchmarks.concealed.report.failures import by_name, wrong_records
from benchmarks.concealed.report.headline import FIGURES, Figure, headline
from benchmarks.concealed.report.markdown import section, table
from benchmarks.concealed.report.trial import report, summary
from benchmarks.concealed.scoring.rates import Rate


@pytest.fixture
def lines(a_line, a_failure):
    """Seven records of our own plant, as its trials have them."""
    own = {"loop": "wide", "noise": 1.0, "onset": 0.0}
    outside = {"verdict": "none_of_these", "concealed": ["trim_rotation"]}
    made = [a_line(**own), a_line("", "named", "erosion", **own)]
    made += [a_line("erosion", "named", "a/b/erosion", **own), a_line("erosion", "named", "stiction", **own)]
    made += [
        a_line("erosion+stiction", "named", "erosion", **own),
        a_line("", "cannot_tell", **own | outside),
    ]
    made += [a_failure("clogging", **own)]
    return [line | {"record": f"r{i}", "seconds": 1.0, "code": "x"} for i, line in enumerate(made)]


def test_tables_count_what_there_is(lines):
    text = summary(lines)
    assert "| wide, noise 1 | 2 | 1 | 1 | 0 | 50 % (1-99) |" in text
    assert "| erosion | 2 | 1 | 1 | 0 | 0 | 0 | 0 | 50 % (1-99) | 50 % (1-99) | 3.0 |" in text
    assert "| clogging | 1 | 0 | 0 | 0 | 0 | 0 | 1 |" in text
    assert "| erosion + stiction | 1 | 0 | 1 | 0 | 0 | 0 |" in text
    assert "| trim_rotation | 1 | 0 | 1 | 0 | 0 | 0 |" in text
    assert "| from the start | 3 |" in text
    assert "| ValueError: broke | 1 |" in text
    assert "7 records, 1 s in the median, 1 s at most; code x (7)." in text


def test_a_record_counts_in_each_of_its_ways_of_concealing(a_line):
    lines = [a_line(nasty=["wander", "cycle"]), a_line("", "named", "a", nasty=["wander"]), a_line(nasty=[])]
    text = outcomes_by(lines, "healthy", "nasty by", nasty)
    assert "| cycle | 1 | 1 | 0 |" in text
    assert "| wander | 2 | 1 | 1 |" in text
    assert "| none | 1 | 1 | 0 |" in text
    assert "| all | 3 | 2 | 1 |" in text
    assert outcomes_by([a_line()], "healthy", "nasty by", nasty) == "-"  # no line tells
    assert outcomes_by(lines, "pair", "nasty by", nasty) == "-"


def test_the_rate_of_what_is_distinguishable_stands_beside(a_line):
    lines = [a_line("a", "named", "a", distinguishable=True), a_line("a", distinguishable=False)]
    text = outcomes(lines)
    assert "of distinguishable" in text
    assert "| a | 2 | 1 | 0 | 0 | 0 | 1 | 0 | 50 % (1-99) | 0 % (0-84) | 100 % (2-100) | 1.0 |" in text


def test_methods_are_compared_on_what_each_has(a_line):
    lines = [a_line("a", "named", "a", excitation="wide"), a_line("a", "named", "b", excitation="closed")]
    lines[1]["record"] = "other"
    assert comparison(lines) == ""  # a single method
    text = comparison([*lines, lines[0] | {"method": "second"}])
    assert "| a | 1 of 2, wrong 1 | 1 of 1, wrong 0 |" in text
    assert "| closed | 0 of 1, wrong 1 | - |" in text
    assert "| concealed by |" not in text


def test_the_overview_has_a_row_a_kind(lines):
    rows = overview(lines).splitlines()[2:]
    assert rows == [
        "| nothing | 2 | right 1 | 50 % (1-99) | alarm 1 |",
        "| one effect with a name | 3 | right 1 | 33 % (1-91) | wrong name 1, failed 1 |",
        "| several effects | 1 | both found 0 | 0 % (0-98) | one found 1 |",
        "| an effect of no catalogue | 1 | right 0 | 0 % (0-98) | cannot tell 1 |",
    ]
    assert overview([]) == "-"


def test_failures_by_name(lines):
    text = by_name(lines)
    assert "| erosion | 2 | 1 | 0 | 0 | 0 | 0 | 0 | 0 | stiction (1) |" in text
    assert "| nothing | 2 | 1 | 0 | 0 | 0 | 0 | 0 | 0 | erosion (1) |" in text
    wrong = wrong_records(lines)
    assert [row.split(" | ")[0] for row in wrong.splitlines()[2:]] == ["| r1", "| r3"]
    assert by_name(lines[:1]) == wrong_records(lines[:1]) == "-"


def test_targets_and_what_meets_them():
    rate = Figure("rate", lambda lines: Rate(len(lines), 10), low=0.6)
    assert rate.target == "at least 60 %"
    assert Figure("", len, high=3.0, percent=False).target == "at most 3"
    assert Figure("", len, low=0.9, high=0.98).target == "90 % to 98 %"
    assert Figure("", len).target == ""
    assert rate.cell([0] * 6) == "**60 % (26-88) of 10**"
    assert rate.cell([0] * 5) == "50 % (19-81) of 10"
    assert Figure("none", lambda lines: Rate(0, 0), high=0.1).cell([]) == "-"
    between = Figure("", len, low=0.9, high=0.98)
    assert [between.met(v) for v in (0.89, 0.9, 0.98, 0.99)] == [False, True, True, False]
    assert between.met(float("nan")) is None


def test_the_headline_has_a_column_a_method(lines):
    text = headline([*lines, *(line | {"method": "other"} for line in lines[:1])])
    rows = text.splitlines()
    assert rows[0] == "|  | aimed at | sklvalve | other |"
    assert len(rows) == len(FIGURES) + 2
    assert "| alarms on healthy records | at most 2.5 % | 50 % (1-99) of 2 | **0 % (0-98) of 1** |" in rows


def test_every_figure_bears_lines_that_say_nothing(a_failure):
    for some in ([], [{"truth": {}}], [a_failure("a"), a_failure("a+b"), a_failure()]):
        for figure in FIGURES:
            assert isinstance(figure.cell(some), str)
    assert "| the diagnosis broke |  | 100 % (29-100) of 3 |" in headline(
        [a_failure("a"), a_failure("a+b"), a_failure()]
    )
    assert summary([{"truth": {}}]).endswith("1 records; code ? (1).")


def test_text_in_cells():
    assert table(["a"], [["x|y\nz"]]) == "| a |\n|---|\n| x\\|y z |"
    assert table(["a"], []) == "-"
    assert section("title", "-", "") == ""


def test_the_report_asks_for_a_method_that_there_is(lines):
    assert "## sklvalve" in report(lines)
    with pytest.raises(ValueError, match="expected lines of the method 'other'"):
        report(lines, "other")


def test_curves_are_drawn_without_a_screen(tmp_path, a_line):
    pytest.importorskip("matplotlib")
    lines = [
        a_line("a", "named", "a", told=[{"probability": 0.9}], size_step=step) | {"method": method}
        for step in (1.0, 2.0)
        for method in ("one", "two")
    ]
    for draw in (power_curve, reliability_curve):
        for suffix in ("png", "svg"):
            path = tmp_path / f"{draw.__name__}.{suffix}"
            assert draw(lines, path)
            assert path.stat().st_size > 2000
        assert not draw([a_line("a")], tmp_path / "none.png")
    assert not (tmp_path / "none.png").exists()


def test_the_command_prints_and_writes(tmp_path, capsys, lines):
    pytest.importorskip("matplotlib")
    scores = tmp_path / "scores.jsonl"
    scores.write_text("\n".join(json.dumps(line | {"folder": "set"}) for line in lines))
    out = tmp_path / "out"
    assert main([str(scores), "--folder", "set", "--out", str(out)]) == 0
    told = capsys.readouterr().out
    assert (out / "tables.md").read_text() == told
    assert "7 records" in told
    with pytest.raises(SystemExit):
        main([str(scores), "--folder", "elsewhere"])
    assert "got those of: none" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main([str(tmp_path / "no.jsonl")])
    assert "there is no" in capsys.readouterr().err
