# SPDX-License-Identifier: BSD-3-Clause
"""A truth that is not the one that was sealed is seen, in a draw and in its published scores."""

import gzip
import hashlib
import json
import shutil

import pytest

from benchmarks.concealed.check_seal import main
from benchmarks.concealed.draw import text_of
from benchmarks.concealed.report.history import RESULTS

TRUTH = {"concealed": ["backlash"], "size": 0.1, "rows": 2400}


@pytest.fixture
def folder(tmp_path):
    """A draw of one record, sealed by hand as the page says."""
    salt, text = "0123456789abcdef\n", text_of(TRUTH)
    (tmp_path / "record_0000").mkdir()
    (tmp_path / "record_0000" / "truth.json").write_text(text, encoding="utf-8")
    (tmp_path / "salt.txt").write_text(salt, encoding="utf-8")
    digest = hashlib.sha256((salt + text).encode()).hexdigest()
    (tmp_path / "seal.txt").write_text(f"{digest}  record_0000\n", encoding="utf-8")
    return tmp_path


def test_a_sound_draw_passes(folder, capsys):
    assert main([str(folder)]) == 0
    told = capsys.readouterr().out
    assert hashlib.sha256((folder / "seal.txt").read_bytes()).hexdigest() in told
    assert "1 of 1 truths are as sealed" in told


@pytest.mark.parametrize("change", ["changed", "lost", "added"])
def test_another_truth_fails(folder, capsys, change):
    truth = folder / "record_0000" / "truth.json"
    if change == "changed":
        truth.write_text(text_of(TRUTH | {"size": 0.2}), encoding="utf-8")
    else:
        shutil.copytree(truth.parent, folder / "record_0001")
    if change == "lost":
        truth.unlink()
    assert main([str(folder)]) == 1
    assert "not as sealed: record_000" in capsys.readouterr().out


def test_scores_are_checked_too(folder, capsys):
    shutil.rmtree(folder / "record_0000")
    scores = folder / "scores_sklvalve.jsonl.gz"
    for truth, status in ((TRUTH, 0), (TRUTH | {"concealed": []}, 1)):
        scores.write_bytes(gzip.compress(json.dumps({"record": "record_0000", "truth": truth}).encode()))
        assert main([str(folder)]) == status
    assert "0 of 1 truths" in capsys.readouterr().out


def test_a_folder_without_a_seal_is_refused(tmp_path):
    with pytest.raises(SystemExit):
        main([str(tmp_path)])


def test_published_scores_are_as_sealed(tmp_path):
    run = RESULTS / "seed_69400423"
    for name in ("seal.txt", "salt.txt", "scores_sklvalve.jsonl.gz"):
        shutil.copy(run / name, tmp_path / name)
    assert main([str(tmp_path)]) == 0
