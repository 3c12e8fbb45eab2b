# SPDX-License-Identifier: BSD-3-Clause
"""Model files: what was saved predicts the same, and no other file passes for one."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from sklearn.ensemble import RandomForestRegressor
from sklearn.linear_model import LinearRegression
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler

from sklvalve.datasets import make_valve_recording
from sklvalve.lssvm import LSSVMRegressor
from sklvalve.mismatch import MissingPhysicsFinder, load_model, save_model
from sklvalve.recording import InputError, Recording, Valve

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

    def broken(path, content):
        with path.open("wb") as half:
            half.write(content[: len(content) // 2])
        raise OSError("disk full")

    monkeypatch.setattr(Path, "write_bytes", broken)
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


COLUMNS = ["opening", "p1", "p2"]


def _found_with(simulation, recording):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return MissingPhysicsFinder(simulation, max_effects=0, n_jobs=1).fit(recording)


@pytest.fixture(scope="module")
def own():
    """A recording, a later one, and regressors of the user's own that stand for a simulation."""
    made = make_valve_recording("clogging", 0.5, loop="wide", n_samples=900, n_later=300, random_state=3)
    recording, later = (
        Recording.from_frame(frame, Valve.from_dict(made.valve)) for frame in (made.frame, made.later)
    )
    table = recording.to_frame()[COLUMNS]
    regressors = {
        "line": make_pipeline(StandardScaler(), PolynomialFeatures(2), LinearRegression()),
        "LS-SVM": make_pipeline(StandardScaler(), LSSVMRegressor(C=10.0)),
        "forest": RandomForestRegressor(5, random_state=0),
    }
    for regressor in regressors.values():
        regressor.fit(table, recording["flow"])
    regressors["without names"] = LinearRegression().fit(
        recording.to_frame()[["command", "opening", "p1", "p2", "temperature"]].to_numpy(), recording["flow"]
    )
    return recording, later, regressors


@pytest.mark.parametrize("name", ["line", "LS-SVM", "without names"])
def test_a_simulation_of_ones_own_goes_into_the_file(own, name, tmp_path):
    recording, later, regressors = own
    finder = _found_with(regressors[name], recording)
    save_model(tmp_path / "model.skops", finder)
    model = load_model(tmp_path / "model.skops")
    for kind in ("corrected", "nominal"):
        expected = getattr(finder, f"{kind}_simulation_").simulate(later)
        made = model[kind].simulate(later)
        assert set(made) == set(expected)
        for channel, values in made.items():
            np.testing.assert_array_equal(values, expected[channel])


@pytest.mark.parametrize("name", ["forest", "function"])
def test_one_that_the_file_cannot_hold_is_refused_when_it_is_saved(own, name, tmp_path):
    recording, _, regressors = own
    line = regressors["line"]
    simulation = regressors.get(name) or (lambda r: line.predict(r.to_frame()[COLUMNS]))
    finder = _found_with(simulation, recording)
    with pytest.raises(InputError) as caught:
        save_model(tmp_path / "model.skops", finder)
    what = {"forest": "a RandomForestRegressor", "function": "a function"}[name]
    assert str(caught.value) == (
        f"the simulation handed to the finder is {what}, which a model file cannot hold; record what it "
        "predicts as the column simulated_flow, or simulated_opening, and diagnose that, or keep the finder "
        "by joblib.dump"
    )
    assert list(tmp_path.iterdir()) == []


def test_a_finder_of_a_loop_has_no_simulation_to_save(tmp_path):
    finder = MissingPhysicsFinder()
    finder.diagnosis_ = "of a loop"
    with pytest.raises(InputError, match="a loop without pressures, and there is no simulation to save"):
        save_model(tmp_path / "model.skops", finder)
