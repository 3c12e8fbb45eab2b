# SPDX-License-Identifier: BSD-3-Clause
"""What killed and rival runs leave in an output folder: nothing, or a set of one run."""

import json
import os
import signal
import stat
import subprocess
import sys

import pytest

from sklvalve.cli import main
from sklvalve.cli.staging import Staging

if os.name != "posix":
    pytest.skip("sends signals and sets a umask as POSIX systems do", allow_module_level=True)

# makes a set of two files, and stops where the test says
_RUN = """
import os, sys, time
from sklvalve.cli import entry, staging
where, mark = sys.argv[1:3]
def run(argv):
    with staging.Staging("out", ("a.txt", "b.txt", "c.txt")) as made:
        for name in ("a.txt", "b.txt", "c.txt"):
            made.path(name).write_text(mark)
        if where == "before":
            print("ready", flush=True)
            time.sleep(30)
        if where == "amid":
            replace, moved = os.replace, []
            def slow(source, target):
                replace(source, target)
                moved.append(target)
                # the plan is the first, then comes a result
                if len(moved) == 2:
                    print("ready", flush=True)
                    time.sleep(float(sys.argv[3]))
            os.replace = slow
        made.commit()
        if where == "after":
            print("ready", flush=True)
            time.sleep(30)
    return 0
entry._run = run
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.exit(entry.main([]))
"""


def begun(folder, where, mark="new", pause="30"):
    """A run that has come to a place."""
    # tests that were started by nohup, or in the background, hand on what they were told to ignore
    heard = (
        "import signal; signal.signal(signal.SIGHUP, signal.SIG_DFL); "
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    )
    work = subprocess.Popen(
        [sys.executable, "-c", heard + _RUN, where, mark, pause],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert work.stdout.readline() == "ready\n"
    return work


def asked_to_end(work, number):
    """What a run says that is asked to end; asked again where Python lost the exception in its clean-up."""
    for _ in range(3):
        work.send_signal(number)
        try:
            return work.communicate(timeout=8)[1]
        except subprocess.TimeoutExpired:
            continue
    raise AssertionError(f"signal {number} was sent three times and the run goes on")


def marks(folder):
    return sorted(path.read_text() for path in (folder / "out").glob("*.txt"))


def finished(folder):
    """One more run, undisturbed, into the same folder."""
    with Staging(folder / "out", ("d.txt",)) as made:
        made.path("d.txt").write_text("last")
        made.commit()


@pytest.mark.parametrize("there", [True, False], ids=["folder there", "no folder yet"])
def test_the_next_run_clears_away_what_a_killed_one_left(tmp_path, there):
    if there:
        (tmp_path / "out").mkdir()
    (tmp_path / ".sklvalve-mine").mkdir()  # a person's own
    for _ in range(3):
        work = begun(tmp_path, "before")
        work.kill()
        work.communicate(timeout=30)
    left = list(tmp_path.rglob(".sklvalve-????????????"))
    assert len(left) == 1  # each run clears the one before it
    finished(tmp_path)
    assert marks(tmp_path) == ["last"]
    assert sorted(path.name for path in tmp_path.rglob("*")) == [".sklvalve-mine", "d.txt", "out"]


def test_the_next_run_finishes_the_moves_of_a_killed_one(tmp_path):
    (tmp_path / "out").mkdir()
    for name in "abc":
        (tmp_path / "out" / f"{name}.txt").write_text("old")
    work = begun(tmp_path, "amid")
    work.kill()
    work.communicate(timeout=30)
    assert marks(tmp_path) == ["new", "old", "old"]  # else the run was killed elsewhere
    finished(tmp_path)
    assert marks(tmp_path) == ["last", "new", "new", "new"]
    assert not list(tmp_path.rglob(".sklvalve-*"))


def test_a_run_that_lives_is_left_alone(tmp_path):
    work = begun(tmp_path, "before")
    try:
        finished(tmp_path)
        assert len(list(tmp_path.glob(".sklvalve-*"))) == 1
    finally:
        work.kill()
        work.communicate(timeout=30)


def test_two_runs_never_mix_their_sets(tmp_path):
    (tmp_path / "out").mkdir()
    slow = begun(tmp_path, "amid", "one", "2")
    with Staging(tmp_path / "out", ("a.txt", "b.txt", "c.txt")) as made:
        for name in ("a.txt", "b.txt", "c.txt"):
            made.path(name).write_text("two")
        made.commit()  # waits for the other's moves
    _, shown = slow.communicate(timeout=30)
    assert slow.returncode == 0, shown
    assert marks(tmp_path) == ["two", "two", "two"]


@pytest.mark.parametrize(
    ("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)]
)
def test_every_request_to_end_leaves_nothing(tmp_path, number, status):
    work = begun(tmp_path, "before")
    shown = asked_to_end(work, number)
    assert (work.returncode, shown) == (status, "interrupted; nothing was written\n")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_what_was_written_is_not_denied(tmp_path, number):
    work = begun(tmp_path, "after")
    shown = asked_to_end(work, number)
    assert work.returncode == 128 + number
    assert shown == "interrupted; complete and written before: out/a.txt, out/b.txt, out/c.txt\n"
    assert marks(tmp_path) == ["new"] * 3


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_moves_are_done_in_full(tmp_path, number):
    work = begun(tmp_path, "amid", "new", "1")
    work.send_signal(number)
    _, shown = work.communicate(timeout=30)
    assert work.returncode == 128 + number
    assert "complete and written before" in shown
    assert marks(tmp_path) == ["new"] * 3
    assert not list(tmp_path.rglob(".sklvalve-*"))


def test_a_hang_up_that_is_ignored_stays_so(tmp_path):
    code = "import signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)\n" + _RUN
    work = subprocess.Popen(
        [sys.executable, "-c", code.replace("time.sleep(30)", "time.sleep(1)"), "before", "new", "1"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        text=True,
    )
    work.stdout.readline()
    work.send_signal(signal.SIGHUP)
    work.communicate(timeout=30)
    assert work.returncode == 0
    assert marks(tmp_path) == ["new"] * 3


@pytest.mark.parametrize(("umask", "mode"), [(0o027, 0o640), (0o002, 0o664)])
def test_modes_follow_the_umask(tmp_path, umask, mode):
    pytest.importorskip("skops", reason="model files need skops")
    from sklvalve.mismatch import save_model

    class Part:
        given_ = None

        def __getattr__(self, name):
            return self

        def to_dict(self):
            return {}

        to_state = to_dict

    before = os.umask(umask)
    try:
        with Staging(tmp_path / "out", ("model.skops", "b.txt")) as made:
            save_model(made.path("model.skops"), Part())
            made.path("b.txt").write_text("b")
            made.commit()
    finally:
        os.umask(before)
    modes = {path.name: stat.S_IMODE(path.stat().st_mode) for path in (tmp_path / "out").iterdir()}
    assert modes == {"model.skops": mode, "b.txt": mode}


def test_signals_are_as_before_afterwards():
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
    main(["--version"])
    assert [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)] == before


@pytest.mark.parametrize("whole", [True, False])
def test_a_plan_that_no_run_made_is_not_obeyed(tmp_path, whole):
    work = begun(tmp_path, "before")
    work.kill()
    work.communicate(timeout=30)
    (left,) = tmp_path.glob(".sklvalve-*")
    (tmp_path / "mine.txt").write_text("mine")
    plan = {"target": str(tmp_path), "names": ["../x"], "dropped": ["mine.txt", "out/../mine.txt"]}
    (left / ".moves.json").write_text(json.dumps(plan)[: None if whole else -3])
    finished(tmp_path)
    assert (tmp_path / "mine.txt").read_text() == "mine"
    assert not list(tmp_path.glob(".sklvalve-*"))
