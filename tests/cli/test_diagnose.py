# SPDX-License-Identifier: BSD-3-Clause
import json
import os
import sys

import pytest

from sklvalve.cli import main
from sklvalve.cli.diagnose import RESULTS
from tests.cli import stand_in
from tests.report import examples

DIAGNOSE = ["diagnose", "recording.csv", "--valve", "valve.toml", "--out", "out"]


def test_three_results_and_the_finding(folder, capsys):
    assert main(DIAGNOSE) == 0
    assert sorted(os.listdir("out")) == sorted(RESULTS)
    assert sorted(os.listdir(".")) == ["out", "recording.csv", "valve.toml"]
    assert json.loads((folder / "out/diagnosis.json").read_text()) == examples.named()
    shown = capsys.readouterr()
    assert shown.out.startswith("Finding       Likely fault: the seat leaks")
    assert "Written: " in shown.out
    assert shown.err == ""
    page = (folder / "out/report.html").read_text()
    assert "FV-101" in page
    assert str(folder) not in page


def test_json_alone_on_standard_output(folder, capsys):
    assert main([*DIAGNOSE, "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == examples.named()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "status"), [(examples.named, 1), (examples.no_mismatch, 0), (examples.changed_before, 1)]
)
def test_exit_code_tells_of_a_mismatch_only_when_asked(folder, monkeypatch, make, status):
    monkeypatch.setattr(stand_in.Finder, "found", staticmethod(make))
    assert main(DIAGNOSE) == 0
    assert main([*DIAGNOSE, "--exit-code"]) == status


def test_until_is_in_the_recordings_own_time(folder):
    (folder / "recording.csv").write_text(stand_in.csv_text(stand_in.columns(160)))
    assert main([*DIAGNOSE, "--until", "229", "--seed", "7"]) == 0
    assert stand_in.Finder.asked == {"rows": 160, "until": 130, "seed": 7}


def test_results_of_an_earlier_run_are_replaced_and_others_kept(folder):
    os.mkdir("out")
    (folder / "out/report.html").write_text("old")
    (folder / "out/notes.txt").write_text("mine")
    assert main(DIAGNOSE) == 0
    assert (folder / "out/report.html").read_text() != "old"
    assert (folder / "out/notes.txt").read_text() == "mine"


def test_work_runs_on_one_blas_thread_and_gives_the_others_back(folder, monkeypatch):
    from threadpoolctl import threadpool_info, threadpool_limits

    def threads():
        return [pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"]

    seen = []

    def watched(path, finder):
        seen.extend(threads())
        stand_in.save_model(path, finder)

    monkeypatch.setattr("sklvalve.mismatch.save_model", watched)
    with threadpool_limits(2, user_api="blas"):  # tests side by side have one each
        before = threads()
        assert set(before) == {2}
        assert main(DIAGNOSE) == 0
        assert seen
        assert set(seen) == {1}
        assert threads() == before


def test_interruption_leaves_nothing(folder, monkeypatch, capsys):
    def interrupted(path, finder):
        path.write_text("half")
        raise KeyboardInterrupt

    monkeypatch.setattr("sklvalve.mismatch.save_model", interrupted)
    assert main(DIAGNOSE) == 130
    assert capsys.readouterr().err == "interrupted; nothing was written\n"
    assert sorted(os.listdir(".")) == ["recording.csv", "valve.toml"]


def test_failure_midway_leaves_what_was_there(folder, monkeypatch):
    assert main(DIAGNOSE) == 0
    before = {name: (folder / "out" / name).read_bytes() for name in RESULTS}

    def broken(path, finder):
        path.write_text("half")
        raise RuntimeError("a fault of the package")

    monkeypatch.setattr("sklvalve.mismatch.save_model", broken)
    with pytest.raises(RuntimeError):
        main([*DIAGNOSE, "--seed", "1"])
    assert {name: (folder / "out" / name).read_bytes() for name in RESULTS} == before
    assert sorted(os.listdir("out")) == sorted(RESULTS)


def test_full_disk_is_told_in_a_sentence(folder, monkeypatch, capsys):
    def full(path, finder):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("sklvalve.mismatch.save_model", full)
    assert main(DIAGNOSE) == 2
    assert capsys.readouterr().err == (
        "sklvalve: --out out: cannot be written (No space left on device); name another folder\n"
    )


@pytest.mark.parametrize("module", ["jinja2", "matplotlib", "skops"])
def test_missing_extra_is_told_before_the_work(folder, monkeypatch, capsys, module):
    monkeypatch.setitem(sys.modules, module, None)
    assert main(DIAGNOSE) == 2
    shown = capsys.readouterr().err
    assert shown.count("\n") == 1
    assert "pip install" in shown
    assert module in shown
    assert stand_in.Finder.asked == {}
    assert not os.path.exists("out")


def test_warnings_are_notes_each_once(folder, monkeypatch, capsys):
    import warnings

    def warned(path, finder):
        stand_in.save_model(path, finder)
        for _ in range(3):
            warnings.warn("41 rows lie outside\nthe validity", UserWarning, stacklevel=1)
        warnings.warn("inner matters of a library", RuntimeWarning, stacklevel=1)

    monkeypatch.setattr("sklvalve.mismatch.save_model", warned)
    assert main(DIAGNOSE) == 0
    assert capsys.readouterr().err == "note: 41 rows lie outside the validity\n"
