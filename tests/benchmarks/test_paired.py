# SPDX-License-Identifier: BSD-3-Clause
"""Two judgements of the same records: what only one of them has, and how likely chance made it so."""

from pathlib import Path

from benchmarks.concealed.paired import table_of
from benchmarks.concealed.scoring.lines import read_lines

RUN = Path(__file__).parents[2] / "benchmarks/concealed/results/seed_69400423"


def test_a_run_beside_itself_differs_in_nothing():
    lines = read_lines(RUN / "scores_sklvalve.jsonl.gz")
    rows = [row.split(" | ") for row in table_of(lines, lines).splitlines()[2:]]
    assert len(rows) == 8
    assert all(row[1] == row[2] and row[3:5] == ["0", "0"] and row[5].startswith("1.00") for row in rows)


def test_what_only_one_of_two_judgements_has_is_counted_by_side():
    before = read_lines(RUN / "scores_sklvalve.jsonl.gz")
    silent = [
        {**line, "found": {**line["found"], "verdict": "cannot_tell", "effects": []}}
        if "found" in line and line["truth"]["effects"]
        else line
        for line in before
    ]
    row = next(r for r in table_of(before, silent).splitlines() if r.startswith("| one effect, class right"))
    _, _, was, now, lost, won, by_chance, _ = (cell.strip() for cell in row.split("|"))
    assert now.startswith("0 of")
    assert (lost, won) == (was.split()[0], "0")
    assert float(by_chance) < 0.01
