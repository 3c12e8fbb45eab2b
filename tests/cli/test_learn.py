# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve learn`` and ``sklvalve diagnose --history``: what is written, told and refused."""

import json
import os
import shlex
import shutil
from typing import ClassVar

import pytest

import sklvalve.mismatch
from sklvalve.cli import main
from sklvalve.datasets import make_valve_recording
from sklvalve.datasets.concealed import to_toml
from sklvalve.history import ByItself, ValveHistory
from sklvalve.mismatch import CATALOGUE, load_history
from tests.cli import stand_in
from tests.cli.refusal import refused
from tests.report import examples

for module in ("pandas", "jinja2", "matplotlib", "skops"):
    pytest.importorskip(module, reason='needs pip install "sklvalve[all]"')

LEAK = next(effect for effect in CATALOGUE if effect.key == "seat_leakage")
HISTORY = "fv101.history.skops"
LEARN = ["learn", "before.csv", "--valve", "valve.toml", "--out", HISTORY]
DIAGNOSE = ["diagnose", "after.csv", "--valve", "valve.toml", "--out", "out"]


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    """A folder with the recordings of one valve, its sheet and another one's, and what was learnt."""
    folder = tmp_path_factory.mktemp("plant")
    made = make_valve_recording(None, loop="wide", n_samples=1200, n_later=1200, random_state=3)
    made.frame.to_csv(folder / "before.csv", index=False)
    made.later.to_csv(folder / "after.csv", index=False)
    made.frame[:300].to_csv(folder / "short.csv", index=False)
    sheet = to_toml(made.valve)
    (folder / "valve.toml").write_text(sheet)
    (folder / "other.toml").write_text(sheet.replace("kv_rated = 40.0", "kv_rated = 25.0"))
    roles = {role: made.valve["recording"][role] for role in ("time", "command", "flow")}
    (folder / "loop.toml").write_text(to_toml({"recording": roles}))
    before = os.getcwd()
    os.chdir(folder)
    try:
        assert main(LEARN) == 0
    finally:
        os.chdir(before)
    return folder


@pytest.fixture
def here(plant, tmp_path, monkeypatch):
    """A copy of the folder, the current one; a stand-in diagnoses, and what is learnt is real."""
    shutil.copytree(plant, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SKLVALVE_DEBUG", "1")  # a fault of the package fails a test as what it is
    monkeypatch.setattr(sklvalve.mismatch, "MissingPhysicsFinder", stand_in.Finder)
    monkeypatch.setattr(sklvalve.mismatch, "save_model", stand_in.save_model)
    monkeypatch.setattr(stand_in.Finder, "asked", {})
    monkeypatch.setattr(stand_in.Finder, "found", staticmethod(examples.no_mismatch))
    return tmp_path


def test_what_is_learnt_is_written_and_told(here, capsys):
    os.remove(HISTORY)
    listed = sorted(os.listdir("."))
    assert main(LEARN) == 0
    assert sorted(os.listdir(".")) == sorted([*listed, HISTORY])
    assert load_history(HISTORY).rows == 1200
    shown = capsys.readouterr()
    assert shown.err == ""
    lines = shown.out.splitlines()
    assert lines[0].startswith("Learnt from   before.csv: 1200 rows, 0.0139 days, in 1 window, from 0.0 to")
    words = " ".join(shown.out.split())
    assert "Visited command 7.81 to 96.9 %; opening" in words
    assert "drop 233 to 352 kPa" in words
    assert "Noise flow 0.152 m3/h; opening" in words
    assert "Calibration rated capacity 41" in words
    assert "The recordings are clean: their diagnosis finds nothing missing" in words
    assert lines[-1] == f"Written: {HISTORY}"


def test_what_is_not_clean_is_said_so(here, capsys, monkeypatch):
    monkeypatch.setattr(stand_in.Finder, "found", staticmethod(examples.named))
    assert main(LEARN) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert "By itself The recordings are not clean. Likely fault: the seat leaks" in words
    # the stand-in learns without what it names
    assert "The history cannot hold that, so that a later diagnosis may take what was there" in words


def test_what_is_held_is_said_so(here, capsys, monkeypatch):
    def history_of(finder, recordings):
        finder.fit(recordings[0])
        history = ValveHistory(effects=(LEAK,), onsets={LEAK.key: 100.0}).fit(recordings)
        history.by_itself_ = ByItself("named", "Likely fault: seat leakage.", held=True)
        return history

    monkeypatch.setattr(stand_in.Finder, "history_of", history_of)
    monkeypatch.setattr(stand_in.Finder, "found", staticmethod(examples.named))
    assert main(LEARN) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert "The history holds seat leakage: a later diagnosis tells what has changed since." in words
    assert load_history(HISTORY).by_itself_.held
    assert main([*LEARN, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["held"] == [{"name": "seat_leakage", "onset": 100.0}]
    assert (told["clean"], told["diagnosis"]["verdict"]) == (False, "named")


def test_json_has_the_same(here, capsys):
    assert main([*LEARN, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["schema"] == "sklvalve.learn/1"
    assert (told["written"], told["rows"], told["windows"], told["clean"]) == (HISTORY, 1200, 1, True)
    (source,) = told["recordings"]
    assert (source["name"], source["rows"], len(source["sha256"])) == ("before.csv", 1200, 64)
    assert told["visited"]["flow"]["unit"] == "m3/h"
    assert told["noise"]["opening"]["unit"] == "%"
    assert told["calibration"]["capacity"]["value"] == pytest.approx(41.0, abs=1.0)
    assert told["diagnosis"]["verdict"] == "no_mismatch"
    assert told["held"] == []


def test_a_finder_that_learns_itself_is_asked_to(here, monkeypatch):
    asked = []

    def history_of(finder, recordings):
        asked.append(len(recordings))
        finder.fit(recordings[0])
        return ValveHistory().fit(recordings)

    monkeypatch.setattr(stand_in.Finder, "history_of", history_of)
    assert main(["learn", "before.csv", "after.csv", *LEARN[2:]]) == 0
    assert asked == [2]
    assert load_history(HISTORY).rows == 2400


class _Kept(stand_in.Finder):
    """Keeps the history that it is given."""

    given = None
    diagnosed: ClassVar[list] = []

    def __init__(self, **settings):
        super().__init__(**settings)
        type(self).given = self.history

    def fit(self, recording, until=None):
        self.diagnosed.append(recording.source)
        return super().fit(recording, until)


@pytest.fixture
def kept(here, monkeypatch):
    monkeypatch.setattr(sklvalve.mismatch, "MissingPhysicsFinder", _Kept)
    monkeypatch.setattr(_Kept, "given", None)
    monkeypatch.setattr(_Kept, "diagnosed", [])
    return here


def test_a_history_file_goes_to_the_finder(kept, capsys):
    assert main([*DIAGNOSE, "--history", HISTORY, "--until", "2199", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["schema"] == "sklvalve.diagnosis/1"
    assert isinstance(_Kept.given, ValveHistory)
    assert _Kept.given.rows == 1200
    assert _Kept.asked["until"] == 1000


def test_recordings_are_diagnosed_first(kept):
    assert main([*DIAGNOSE, "--history", "before.csv"]) == 0
    assert _Kept.diagnosed == ["before.csv", "after.csv"]
    assert _Kept.given.rows == 1200


def test_without_the_option_there_is_none(kept):
    assert main(DIAGNOSE) == 0
    assert _Kept.given is None


def test_what_may_change_is_set_of_a_file_and_of_recordings(kept):
    assert main([*DIAGNOSE, "--history", HISTORY, "--allow", "capacity=0.05", "flow_zero=0.002"]) == 0
    of_file = _Kept.given
    assert (of_file.allowance.capacity, of_file.allowance.flow_zero) == (0.05, 0.002)
    assert main([*DIAGNOSE, "--history", "before.csv", "--allow", "capacity=0.05"]) == 0
    assert _Kept.given.allowance.capacity == 0.05
    # it widens what is expected
    at = of_file.prior_.names.index("capacity")
    assert of_file.prior_.covariance[at, at] > 4.0 * load_history(HISTORY).prior_.covariance[at, at]


def test_files_and_recordings_are_joined(kept):
    table = (kept / "after.csv").read_text().splitlines(keepends=True)
    (kept / "first.csv").write_text("".join(table[:601]))
    (kept / "rest.csv").write_text("".join([table[0], *table[601:]]))
    assert main(["diagnose", "rest.csv", *DIAGNOSE[2:], "--history", HISTORY, "first.csv"]) == 0
    assert [source.name for source in _Kept.given.recordings_] == ["before.csv", "first.csv"]
    assert _Kept.given.rows == 1800


def test_two_files_are_merged(kept):
    table = (kept / "after.csv").read_text().splitlines(keepends=True)
    (kept / "first.csv").write_text("".join(table[:701]))
    (kept / "rest.csv").write_text("".join([table[0], *table[701:]]))
    other = "other.history.skops"
    assert main(["learn", "first.csv", *LEARN[2:-1], other]) == 0
    assert main(["diagnose", "rest.csv", *DIAGNOSE[2:], "--history", HISTORY, other]) == 0
    assert (_Kept.given.rows, len(_Kept.given.windows_)) == (1900, 2)


D = "diagnose after.csv --valve valve.toml --out out"
L = "learn before.csv --valve valve.toml --out"
REFUSED = {
    "no argument": (f"{D} --history", "argument --history: expected at least one argument"),
    "nothing that is allowed": (f"{D} --history {HISTORY} --allow size=1", "NAME one of capacity, trim,"),
    "no number": (f"{D} --history {HISTORY} --allow capacity=0", "a number above 0 for capacity; got '0'"),
    "allowed without a history": (f"{D} --allow capacity=0.1", "--allow says what may change since a hist"),
    "no such file": (f"{D} --history no.history.skops", "no.history.skops: no such file; give the .history"),
    "no such recording": (f"{D} --history no.csv", "no.csv: no such file"),
    "a folder": (f"{D} --history .", "this is a folder"),
    "a text": (f"{D} --history valve.toml", "valve.toml: expected a file named .csv"),
    "no history": (f"{D} --history notes.history.skops", "this is no history file of sklvalve"),
    "another version": (f"{D} --history new.history.skops", "written by another version of sklvalve"),
    "a model": (f"{D} --history model.skops", "model.skops: this is a model, and no history of a valve"),
    "one file twice": (f"{D} --history {HISTORY} {HISTORY}", "both histories hold these rows"),
    "one recording twice": (f"{D} --history before.csv before.csv", "before.csv is given twice"),
    "file and its recording": (f"{D} --history {HISTORY} before.csv", "the history holds these rows already"),
    "the recording itself": (f"{D} --history after.csv", "after.csv: the history holds rows of this record"),
    "the recording in the file": (
        f"diagnose before.csv --valve valve.toml --out out --history {HISTORY}",
        "before.csv: the history holds rows of this recording, by before.csv",
    ),
    "too short": (f"{D} --history short.csv", "short.csv: a history of 300 rows is too short"),
    "another sheet": (
        f"diagnose after.csv --valve other.toml --out out --history {HISTORY}",
        "the data sheet gives kv_rated as 25.0, and that of the history as 40.0",
    ),
    "another sheet of recordings added": (
        f"diagnose after.csv --valve other.toml --out out --history {HISTORY} short.csv",
        "short.csv: the data sheet gives kv_rated as 25.0",
    ),
    "a loop": (
        f"diagnose after.csv --valve loop.toml --out out --history {HISTORY}",
        "after.csv: a history is of use to a simulation of the valve only",
    ),
    "a history as model": (
        f"predict after.csv --model {HISTORY} --out p.csv",
        "this is the history of a valve, and no model that predicts",
    ),
    "learn without out": ("learn before.csv", "required: --out"),
    "learn into another name": (f"{L} fv101.skops", "name it NAME.history.skops"),
    "learn into nothing": (f"{L} .history.skops", "name it NAME.history.skops"),
    "learn under a file": (f"{L} valve.toml/a.history.skops", "is a file; name a folder"),
    "learn from what was learnt": (
        f"learn {HISTORY} --out a.history.skops",
        "a valve is learnt from recordings, and this is named as a file of what was learnt",
    ),
    "learn from too little": ("learn short.csv --valve valve.toml --out a.history.skops", "too short to le"),
    "learn from a loop": (
        "learn before.csv --valve loop.toml --out a.history.skops",
        "a command and a value without pressures",
    ),
}


@pytest.mark.parametrize(("command", "words"), REFUSED.values(), ids=REFUSED)
def test_one_sentence_and_nothing_written(here, capsys, command, words):
    import skops.io

    (here / "notes.history.skops").write_text("mine")
    skops.io.dump({"format": "sklvalve.history/8"}, here / "new.history.skops")
    skops.io.dump({"format": "sklvalve.model/1"}, here / "model.skops")
    refused(shlex.split(command), words, capsys)
    assert stand_in.Finder.asked == {}


def test_interruption_leaves_nothing(here, capsys, monkeypatch):
    before = (here / HISTORY).read_bytes()
    listed = sorted(os.listdir("."))

    def interrupted(path, history):
        path.write_text("half")
        raise KeyboardInterrupt

    monkeypatch.setattr(sklvalve.mismatch, "save_history", interrupted)
    assert main(LEARN) == 130
    assert capsys.readouterr().err == "interrupted; nothing was written\n"
    assert sorted(os.listdir(".")) == listed
    assert (here / HISTORY).read_bytes() == before
