# SPDX-License-Identifier: BSD-3-Clause
"""History files: what was saved serves as the history itself, and no other file passes for one."""

import os
import stat
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sklearn.exceptions import NotFittedError

from sklvalve.history import ValveHistory
from sklvalve.mismatch import MissingPhysicsFinder, load_history, load_model, save_history, save_model
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.recording import InputError
from tests.history.plant import made

skops_io = pytest.importorskip("skops.io", reason="history files need skops")


@pytest.fixture(scope="module")
def learnt():
    return ValveHistory().fit(made()[0])


@pytest.fixture(scope="module")
def saved(learnt, tmp_path_factory):
    path = tmp_path_factory.mktemp("history") / "fv101.history.skops"
    save_history(path, learnt)
    return path


def refusal(path, load=load_history):
    with pytest.raises(InputError) as caught:
        load(path)
    words = str(caught.value)
    assert words.isprintable()
    return words


def test_what_was_saved_is_read_again(saved, learnt):
    history = load_history(saved)
    np.testing.assert_array_equal(history.prior_.mean, learnt.prior_.mean)
    np.testing.assert_array_equal(history.prior_.covariance, learnt.prior_.covariance)
    assert history.values_ == learnt.values_
    assert (history.rows, history.recordings_[0].name) == (1200, "data frame")
    assert history.valve_ == learnt.valve_


def test_a_diagnosis_is_the_same_with_either(saved, learnt):
    found = [
        MissingPhysicsFinder(max_effects=0, n_jobs=1, history=each).fit(made()[1]).diagnosis_.to_dict()
        for each in (learnt, load_history(saved))
    ]
    assert found[0] == found[1]


def test_nothing_else_is_left_beside_it(saved):
    assert list(saved.parent.iterdir()) == [saved]


def test_nothing_of_the_folder_is_in_it(tmp_path):
    history = ValveHistory().fit(replace(made()[0], source="/home/somebody/plant/january.csv"))
    save_history(tmp_path / "a.history.skops", history)
    # skops does not pack its parts
    assert b"january.csv" in (tmp_path / "a.history.skops").read_bytes()
    assert b"somebody" not in (tmp_path / "a.history.skops").read_bytes()
    assert load_history(tmp_path / "a.history.skops").recordings_[0].name == "january.csv"


def test_a_failed_save_leaves_the_old_file(saved, learnt, monkeypatch):
    before = saved.read_bytes()

    def broken(path, content):
        with path.open("wb") as half:
            half.write(content[: len(content) // 2])
        raise OSError("disk full")

    monkeypatch.setattr(Path, "write_bytes", broken)
    with pytest.raises(OSError, match="disk full"):
        save_history(saved, learnt)
    assert saved.read_bytes() == before
    assert list(saved.parent.iterdir()) == [saved]


def test_what_is_no_history_is_not_saved(tmp_path):
    with pytest.raises(InputError, match="expected a fitted ValveHistory, got 3"):
        save_history(tmp_path / "a.history.skops", 3)
    with pytest.raises(NotFittedError):
        save_history(tmp_path / "a.history.skops", ValveHistory())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.99])
def test_truncated_file(saved, tmp_path, share):
    whole = saved.read_bytes()
    path = tmp_path / "half.history.skops"
    path.write_bytes(whole[: int(share * len(whole))])
    assert "this is no history file of sklvalve" in refusal(path)


def test_other_files(tmp_path):
    path = tmp_path / "notes.history.skops"
    assert "no such file; give the .history.skops" in refusal(path)
    assert "this is a folder" in refusal(tmp_path)
    path.write_text("not a history\n")
    assert "this is no history file of sklvalve; give the .history.skops that" in refusal(path)
    for content in ({"format": "other/1"}, {"format": 3}, [1, 2], {}):
        skops_io.dump(content, path)
        assert "this is no history file of sklvalve" in refusal(path)
    skops_io.dump({"format": "sklvalve.history/7"}, path)
    assert "a part of it is damaged: history is missing" in refusal(path)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="a superuser reads everything")
def test_a_file_that_may_not_be_read(saved, tmp_path):
    path = tmp_path / "a.history.skops"
    path.write_bytes(saved.read_bytes())
    path.chmod(stat.S_IWUSR)
    assert "cannot be read (Permission denied)" in refusal(path)


def test_another_version(tmp_path):
    path = tmp_path / "new.history.skops"
    skops_io.dump({"format": "sklvalve.history/8"}, path)
    words = refusal(path)
    assert "written by another version of sklvalve" in words
    assert "learn it again from its recordings" in words


def test_model_and_history_taken_for_each_other(saved, tmp_path):
    path = tmp_path / "corrected_model.skops"
    save_model(path, MissingPhysicsFinder(max_effects=0, n_jobs=1).fit(made()[0]))
    assert "this is a model, and no history of a valve; give the .history.skops" in refusal(path)
    words = refusal(saved, load_model)
    assert "this is the history of a valve, and no model that predicts" in words
    assert "--history" in words


def test_known_effects_are_in_it_by_their_keys(learnt, tmp_path):
    effect = next(e for e in CATALOGUE if e.name == "flow_meter_gain")
    history = ValveHistory(effects=(effect,), onsets={effect.key: 100.0}).fit(made()[0])
    path = tmp_path / "a.history.skops"
    save_history(path, history)
    back = load_history(path)
    assert [e.key for e in back.effects] == [effect.key]
    assert back.onsets == {effect.key: 100.0}
    np.testing.assert_array_equal(back.prior_.mean, history.prior_.mean)


def test_an_effect_that_nobody_knows(saved, tmp_path):
    content = skops_io.loads(saved.read_bytes())
    content["history"]["settings"]["effects"] = ["mine"]
    path = tmp_path / "a.history.skops"
    skops_io.dump(content, path)
    assert refusal(path).endswith("no effect of the catalogue; give it to load_history as one of effects")


@pytest.mark.parametrize(
    ("keys", "value", "words"),
    [
        (("valve",), {"valve": {"kv_rated": -1.0}}, "kv_rated must be above 0"),
        (("valve",), 3, "a part of it is damaged"),
        (("history", "windows", "begins"), [], "damaged: it has no windows"),
        (("history", "calibration", "values", "capacity"), float("nan"), "damaged: capacity is out of range"),
        (("history", "settings", "effects"), [3], "damaged: its effects are no names"),
        (("history", "range"), None, "damaged: range is missing"),
    ],
)
def test_a_lie_is_refused_on_loading(saved, tmp_path, keys, value, words):
    content = skops_io.loads(saved.read_bytes())
    node = content
    for key in keys[:-1]:
        node = node[key]
    node[keys[-1]] = value
    path = tmp_path / "lie.history.skops"
    skops_io.dump(content, path)
    assert words in refusal(path)


def test_without_skops_the_extra_is_named(saved, monkeypatch):
    monkeypatch.setitem(sys.modules, "skops.io", None)
    with pytest.raises(ImportError, match=r'history files need skops: pip install "sklvalve\[skops\]"'):
        load_history(saved)
