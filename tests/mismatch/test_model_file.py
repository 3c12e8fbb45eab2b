# SPDX-License-Identifier: BSD-3-Clause
"""Model files: what was saved predicts the same, and no other file passes for one."""

import numpy as np
import pytest

from sklvalve.mismatch import load_model, save_model
from sklvalve.recording import InputError

skops_io = pytest.importorskip("skops.io", reason="model files need skops")


@pytest.fixture(scope="module")
def saved(found_leaking, tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "corrected_model.skops"
    save_model(path, found_leaking)
    return path


def test_what_was_saved_predicts_the_same(saved, found_leaking, leaking):
    model = load_model(saved)
    assert set(model) == {"corrected", "nominal", "diagnosis"}
    assert model["diagnosis"] == found_leaking.diagnosis_.to_dict()
    pairs = (
        (model["corrected"], found_leaking.corrected_simulation_),
        (model["nominal"], found_leaking.nominal_simulation_),
    )
    for back, before in pairs:
        expected = before.simulate(leaking)
        for name, signal in back.simulate(leaking).items():
            np.testing.assert_array_equal(signal, expected[name])
    assert model["corrected"].onsets == found_leaking.corrected_simulation_.onsets


def test_nothing_else_is_left_beside_it(saved):
    assert list(saved.parent.iterdir()) == [saved]


def test_a_failed_save_leaves_the_old_file(saved, found_leaking, monkeypatch):
    before = saved.read_bytes()

    def broken(content, name):
        raise OSError("disk full")

    monkeypatch.setattr(skops_io, "dump", broken)
    with pytest.raises(OSError, match="disk full"):
        save_model(saved, found_leaking)
    assert saved.read_bytes() == before
    assert list(saved.parent.iterdir()) == [saved]


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        load_model(tmp_path / "none.skops")


def test_text_file(tmp_path):
    path = tmp_path / "notes.skops"
    path.write_text("not a model\n")
    with pytest.raises(InputError, match="no model file of sklvalve"):
        load_model(path)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.99])
def test_truncated_file(saved, tmp_path, share):
    whole = saved.read_bytes()
    path = tmp_path / "half.skops"
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(InputError, match="no model file of sklvalve"):
        load_model(path)


@pytest.mark.parametrize("content", [{"format": "other/1"}, {"format": "sklvalve.model/1"}, [1, 2]])
def test_other_contents(tmp_path, content):
    path = tmp_path / "other.skops"
    skops_io.dump(content, path)
    with pytest.raises(InputError, match="no model file of sklvalve"):
        load_model(path)
