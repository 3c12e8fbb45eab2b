# SPDX-License-Identifier: BSD-3-Clause
"""Every sealed run is published whole, under the seal it was published with."""

import gzip
import json
import re
import shutil

import pytest

from benchmarks.concealed.report.history import RESULTS, figures, main, promises, provenance, runs_of
from benchmarks.concealed.report.outcomes import rows_of
from benchmarks.concealed.report.with_history import COUNTED
from benchmarks.concealed.report.with_history import rows_of as rates_of
from benchmarks.concealed.scoring.agreement import paired
from benchmarks.concealed.scoring.lines import read_lines

NEWEST = RESULTS.parent / "fresh" / "seed_19782526"
# what the page leaves to the record
IN_THE_RECORD_ALONE = {"defect of the data, said", "the diagnosis broke, or was refused"}


@pytest.fixture
def copied(tmp_path):
    """The first run alone, in a folder of its own."""
    first = (RESULTS / "runs.csv").read_text(encoding="utf-8").splitlines()[:2]
    (tmp_path / "runs.csv").write_text("\n".join(first) + "\n", encoding="utf-8")
    seed = first[1].split(",")[1]
    shutil.copytree(RESULTS / f"seed_{seed}", tmp_path / f"seed_{seed}")
    return tmp_path


def test_every_published_folder_is_listed_under_its_seal():
    runs = runs_of(RESULTS)
    assert {f"seed_{run['seed']}" for run in runs} == {p.name for p in RESULTS.iterdir() if p.is_dir()}


@pytest.mark.slow
def test_the_record_has_the_tables_that_the_scores_make():
    runs = runs_of(RESULTS)
    record = (RESULTS / "README.md").read_text(encoding="utf-8")
    for made in (provenance(runs), figures(runs), promises(runs)):
        assert made in record


@pytest.fixture
def newest():
    """Scores of the newest draw, without histories and with them."""
    return [read_lines(NEWEST / f"scores_{method}.jsonl.gz") for method in ("sklvalve", "sklvalve_history")]


def _page(name):
    return (RESULTS.parents[2] / name).read_text(encoding="utf-8")


def test_the_documentation_has_the_outcomes_of_the_newest_draw(newest):
    page, readme = _page("docs/validation.md"), _page("README.md")
    for without, with_ in zip(*map(rows_of, newest), strict=True):
        cells = [f"{a}; {b}" for a, b in zip(without[1:], with_[1:], strict=True) if a or b]
        line = next(
            line for line in page.splitlines() if line.endswith("|") and all(c in line for c in cells)
        )
        assert line.startswith(f"| {without[0].split()[0]} ")
        if "two" not in without[0] and "defect" not in without[0]:
            assert any(all(c in line for c in cells) for line in readme.splitlines())


def test_the_documentation_has_the_rates_of_the_newest_draw(newest):
    page = _page("docs/validation.md")
    rates = [row for row in rates_of(paired(*newest), COUNTED) if row[0] not in IN_THE_RECORD_ALONE]
    assert len(rates) > 5
    for _, without, with_, *_ in rates:
        assert without in page
        assert re.sub(r" of \d+", "", with_) in page


def test_no_published_score_holds_a_path_of_a_machine():
    for path in RESULTS.rglob("*.jsonl.gz"):
        with gzip.open(path, "rt", encoding="utf-8") as text:
            assert not [line for line in text if "/recording.csv" in line], path


def test_figures_are_those_of_the_run(copied):
    runs = runs_of(copied)
    assert "| one effect | 293 |" in provenance(runs)
    assert "| wrong name, of all records | at most 3 % | 5.4 % (3.8-7.4) of 649 |" in figures(runs)
    assert "| the diagnosis broke |  | 0.0 % (0.0-0.6) of 649 |" in figures(runs)
    assert "true structure" not in figures(runs)  # which no run has


def test_a_truth_changed_after_the_seal_is_told(copied, capsys):
    seal = next(copied.glob("seed_*/seal.txt"))
    seal.write_text(seal.read_text(encoding="utf-8") + "more\n", encoding="utf-8")
    with pytest.raises(SystemExit):
        main([str(copied)])
    assert "expected the seal b1457d91" in capsys.readouterr().err


def test_a_line_cut_off_counts_as_not_written(copied):
    path = next(copied.glob("seed_*/scores_sklvalve.jsonl.gz"))
    with gzip.open(path, "rt", encoding="utf-8") as text:
        line = text.readline()
    with gzip.open(path, "wt", encoding="utf-8") as text:
        text.write(line + line[:100])
    assert [each["record"] for each in runs_of(copied)[0]["lines"]] == [json.loads(line)["record"]]
