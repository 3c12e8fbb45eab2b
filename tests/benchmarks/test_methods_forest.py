# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest

from benchmarks.concealed.methods import random_forest
from benchmarks.concealed.methods.forest_features import features
from benchmarks.concealed.methods.forest_records import candidates_for_training, draw_recording
from benchmarks.concealed.methods.nominal import nominal_of
from tests.benchmarks.methods_records import made, without

FORMS = candidates_for_training()


def test_a_drawn_recording_holds_what_a_diagnosis_needs():
    recording = draw_recording(np.random.default_rng(0))
    assert {"command", "opening", "p1", "p2", "temperature", "flow"} == set(recording)
    assert all(np.isfinite(recording[role]).all() for role in recording)
    assert 1200 <= len(recording) < 2400
    assert ((recording["p1"] - recording["p2"]) > 1e4).all()


def test_the_same_seed_draws_the_same_recording():
    one, two = (draw_recording(np.random.default_rng(7), FORMS["backlash"]) for _ in range(2))
    assert all(np.array_equal(one[role], two[role]) for role in one)


def test_what_needs_another_plant_is_not_drawn():
    electric = [e for forms in FORMS.values() for e in forms if getattr(e, "motor", False)]
    assert electric == []
    assert "gas_expansion" not in FORMS


def test_every_recording_has_the_same_features():
    recording = made(rows=1200)
    whole = features(nominal_of(recording))
    for roles in (("opening",), ("p1", "p2"), ("command",), ("temperature",)):
        part = features(nominal_of(without(recording, *roles)))
        assert part.keys() == whole.keys()
    unseen = features(nominal_of(without(recording, "opening")))
    assert np.isnan(unseen["opening log rms"])
    assert np.isfinite(unseen["flow log rms"])


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("forest")
    random_forest.train(place, each=2, healthy=6, trees=60, names=("dead_time", "flow_meter_drift"))
    return place


@pytest.mark.slow
def test_a_forest_answers_and_is_kept(folder):
    recording = made("dead_time", 12.0)
    found = random_forest.diagnose(recording, folder=folder)
    # six healthy recordings can show no less than one in seven
    assert found["mismatch"]["p_value"] >= 1.0 / 7.0
    assert found["verdict"] == "no_mismatch"
    loose = random_forest.diagnose(recording, folder=folder, alpha=1.0)
    assert loose["verdict"] in ("named", "cannot_tell")
    members = loose["effects"][0]["members"]
    assert {m["name"] for m in members} <= {"dead_time", "flow_meter_drift", "sedimentation"}
    assert 0.0 < sum(m["probability"] for m in members) <= 1.0 + 1e-3


@pytest.mark.slow
def test_a_training_set_at_hand_is_used(folder):
    made_so_far = []
    options = {"each": 2, "healthy": 6, "trees": 60, "names": ("dead_time", "flow_meter_drift")}
    forest = random_forest.train(folder, **options, report=lambda *a: made_so_far.append(a))
    assert made_so_far == []
    assert sorted(forest["classifier"].classes_) == ["dead_time", "nothing", "sedimentation/flow_meter_drift"]
    assert 0.0 < forest["least"] <= 1.0


def test_without_a_forest_it_says_what_to_do(tmp_path):
    with pytest.raises(FileNotFoundError, match="make it with python -m"):
        random_forest.diagnose(made(), folder=tmp_path)


def test_names_are_told_until_they_reach_the_least_probability():
    votes = {"nothing": 0.2, "a": 0.4, "b": 0.2, "c": 0.15, "d": 0.05}
    assert list(random_forest._told(votes, 0.5)) == ["a"]
    assert random_forest._told(votes, 0.7) == pytest.approx({"a": 0.5, "b": 0.25})
    assert list(random_forest._told(votes, 0.99)) == ["a", "b"]


def test_names_of_one_class_share_its_probability():
    told = random_forest._by_name({"friction/presliding": 0.6, "erosion": 0.3})
    assert told == pytest.approx({"friction": 0.3, "presliding": 0.3, "erosion": 0.3})
