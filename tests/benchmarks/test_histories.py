# SPDX-License-Identifier: BSD-3-Clause
"""Histories of records: the same plant, another hour, nothing concealed; and the records as they were."""

import json
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.concealed import judging, run
from benchmarks.concealed.cases import Case, plan
from benchmarks.concealed.draw import HISTORY, broken_seals, draw, seal
from benchmarks.concealed.histories import ROWS, Kind, history_of, kind_of_history, with_history
from benchmarks.concealed.histories.add import BEFORE, add_histories
from benchmarks.concealed.histories.changes import CHANGES
from benchmarks.concealed.histories.recordings import as_recordings
from benchmarks.concealed.methods import METHODS, WITH_HISTORY, learner, method
from benchmarks.concealed.plant import EFFECTS
from benchmarks.concealed.record import make
from sklvalve.history.rehearsal import Rehearsal

SIZES = {"healthy": 2, "each": 0, "pairs": 0, "outside": 0, "defects": 0}
HEALTHY = Case(0, "healthy", excitation="closed", nasty=("quantised",))
LEAKING = Case(1, "single", ("seat_leakage",), 2.0, "wide", nasty=("no_p2",))
SEED = 11


def drawn(case, **strengths):
    return make(case, SEED, rows=600, strengths=strengths, distances=False)


@pytest.fixture(scope="module")
def healthy():
    return drawn(HEALTHY)


@pytest.fixture(scope="module")
def leaking():
    return drawn(LEAKING, seat_leakage=0.03)


def test_a_history_is_drawn_again_alike_and_leaves_the_record_alone(healthy):
    before = {name: values.copy() for name, values in healthy.table.items()}
    first, told = history_of(HEALTHY, healthy)
    second, again = history_of(HEALTHY, drawn(HEALTHY))
    assert told == again
    assert list(first) == list(healthy.table)
    for name, values in first.items():
        assert len(values) == ROWS
        np.testing.assert_array_equal(values, second[name])
        np.testing.assert_array_equal(healthy.table[name], before[name])
    # another programme and other noise: nothing is taken over row by row
    assert abs(np.corrcoef(first["P1"][:600], before["P1"][:600])[0, 1]) < 0.9


@pytest.mark.parametrize(("case", "strengths"), [(HEALTHY, {}), (LEAKING, {"seat_leakage": 0.03})])
def test_a_clean_history_holds_no_effect(case, strengths):
    made = drawn(case, **strengths)
    table, told = history_of(case, made, Kind("wide"))
    assert told["clean"]
    assert told["strengths"] == {}
    assert told["effects"] == []
    sound, _ = history_of(replace(case, effects=()), made, Kind("wide"))
    np.testing.assert_array_equal(table["F"], sound["F"])


def test_what_a_history_that_is_not_clean_holds_shows_in_it(leaking):
    clean, _ = history_of(LEAKING, leaking, Kind("wide"))
    same, told = history_of(LEAKING, leaking, Kind("wide", "same", ("seat_leakage",)))
    assert told["strengths"] == leaking.truth["strengths"]
    assert told["clean"] is False
    # the same programme, with a leak past the closed seat
    shut = clean["X"] < 0.5
    assert shut.sum() > 20
    leak = 0.03 * leaking.plant.sheet["kv_rated"]
    assert np.median(same["F"][shut] - clean["F"][shut]) > leak
    _, other = history_of(LEAKING, leaking, Kind("wide", "another", ("link_backlash",)))
    assert other["effects"] == ["backlash"]


def test_what_the_record_lacks_the_history_lacks(leaking, healthy):
    for case, made in ((LEAKING, leaking), (HEALTHY, healthy)):
        for excitation in ("wide", "closed", "cascade"):
            table, _ = history_of(case, made, Kind(excitation))
            assert list(table) == list(made.table)
    assert "P2" not in leaking.table
    record, valve, history, truth = as_recordings(with_history(LEAKING, leaking))
    assert set(record) == set(history)
    assert (len(record), len(history)) == (600, ROWS)
    assert valve.tag == LEAKING.name
    assert truth["history"]["rows"] == ROWS


def test_plant_meters_and_controller_are_those_of_the_record(healthy):
    plant = healthy.plant
    hour = plant.another_hour(np.random.default_rng(0), "wide", ROWS, ())
    assert hour.kept == plant.kept
    assert hour.noise["zeros"] == plant.noise["zeros"]
    assert hour.sound == plant.sound
    assert hour.places is plant.places
    np.testing.assert_array_equal(hour.trim, plant.trim)
    np.testing.assert_array_equal(hour.controller[0], plant.controller[0])
    # each zero shows in what is recorded: what is left of the noise is its zero
    for role, zero in plant.noise["zeros"].items():
        assert np.mean(hour.noise[role]) == pytest.approx(zero, abs=120.0 if role != "temperature" else 0.01)


@pytest.mark.parametrize("change", CHANGES)
def test_an_allowed_change_is_small_and_told(healthy, change):
    case, made = HEALTHY, healthy
    plain, _ = history_of(case, made, Kind("closed"))
    table, told = history_of(case, made, Kind("closed", change=change))
    assert told["clean"]
    assert told["allowed_change"]["change"] == change
    by = told["allowed_change"]["by"]
    column = {"season": "T1", "position_zero": "X", "source_pressure": "P1"}.get(change)
    if column is None:
        assert any(not np.array_equal(table[name], plain[name]) for name in ("F", "P1", "P2", "CV"))
        return
    moved = np.mean(plain[column] - table[column])
    scale = {"T1": 1.0, "X": 100.0, "P1": 1e-3}[column]
    if change == "position_zero":
        # a controller goes on as it did, its noise too
        assert moved == pytest.approx(scale * by, abs=0.02)
    else:
        assert moved == pytest.approx(scale * by, rel=0.2)
    low, high = {"season": (10.0, 25.0), "position_zero": (0.002, 0.005), "source_pressure": (4e4, 12e4)}[
        change
    ]
    assert low <= abs(by) <= high


def test_kinds_come_as_often_as_they_should():
    cases = plan(3)
    kinds = [kind_of_history(case, 1000 + k) for k, case in enumerate(cases)]
    assert kinds == [kind_of_history(case, 1000 + k) for k, case in enumerate(cases)]
    other = np.mean([kind.excitation != case.excitation for kind, case in zip(kinds, cases, strict=True)])
    shares = (
        other,
        *(np.mean([bool(x) for x in of]) for of in zip(*[(k.holds, k.change) for k in kinds], strict=True)),
    )
    for share, wanted in zip(shares, (0.2, 0.1, 0.1), strict=True):
        # three standard deviations
        assert share == pytest.approx(wanted, abs=3.0 * np.sqrt(wanted * (1.0 - wanted) / len(cases)))
    assert not any(kind.holds and kind.change for kind in kinds)
    assert {kind.change for kind in kinds} == {None, *CHANGES}
    held = Counter(kind.holds for kind, case in zip(kinds, cases, strict=True) if case.effects)
    assert held["same"] > 10
    assert held["another"] > 10
    for kind, case in zip(kinds, cases, strict=True):
        told = {EFFECTS[name].told for name in case.effects}
        if kind.holds == "same":
            assert kind.effects == case.effects
        if kind.holds == "another":
            assert not told & {EFFECTS[name].told for name in kind.effects}
        if case.kind == "healthy":
            assert kind.holds != "same"


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Of one seed: drawn without histories, with them, and with histories added later."""
    places = [tmp_path_factory.mktemp("drawn") / name for name in ("without", "with", "added")]
    for place in places:
        draw(place, 5, report=lambda text: None, histories=place.name == "with", **SIZES)
        seal(place)
    assert len(add_histories(places[2], report=lambda text: None)) == 2
    return places


def test_records_are_the_same_to_the_digit_with_histories(folders):
    without, with_, added = folders
    for place in without.glob("record_*"):
        names = {file.name for file in place.iterdir()}
        for other in (with_ / place.name, added / place.name):
            assert {file.name for file in other.iterdir()} == names | {HISTORY}
            for name in names - {"truth.json"}:
                assert (other / name).read_bytes() == (place / name).read_bytes()
            truth = json.loads((other / "truth.json").read_text())
            assert truth.pop("history")["rows"] == ROWS
            assert truth == json.loads((place / "truth.json").read_text())
        for name in (HISTORY, "truth.json"):
            assert (with_ / place.name / name).read_bytes() == (added / place.name / name).read_bytes()


def test_histories_that_are_added_are_sealed_and_the_seal_of_before_is_kept(folders):
    *_, added = folders
    assert broken_seals(added) == []
    assert (added / BEFORE).read_text() != (added / "seal.txt").read_text()
    assert add_histories(added) == []
    truth = next(added.glob("record_*/truth.json"))
    before = truth.read_text()
    truth.write_text(before.replace('"clean"', '"clean" '))
    assert broken_seals(added) == [truth.parent.name]
    truth.write_text(before)


def test_a_folder_without_a_plan_is_refused(tmp_path):
    with pytest.raises(ValueError, match="no plan"):
        add_histories(tmp_path)


def test_the_method_is_given_the_history_and_the_others_are_not(folders, monkeypatch):
    given = {}

    class Learnt(list):
        rehearsals_ = (Rehearsal(1.5, 0.5, None, 0.2),)

    def stand_in(recording, *, folder=None, history=None):
        given["history"] = history
        return {"verdict": "no_mismatch", "mismatch": {"p_value": 0.5}, "effects": []}

    monkeypatch.setattr(judging, "method", lambda name: stand_in)
    monkeypatch.setattr(judging, "learner", lambda name: Learnt if name in WITH_HISTORY else None)
    place = next(folders[1].glob("record_*"))
    line = judging.line_of(place, "sklvalve_history")
    assert line["found"]["verdict"] == "no_mismatch"
    assert [len(recording) for recording in given["history"]] == [ROWS]
    assert line["truth"]["history"]["clean"] in (True, False)
    assert line["rehearsals"] == [{"throughout": 1.5, "within": 0.5, "residual": None, "stem": 0.2}]
    # learning is a command of its own, and its time is told apart
    assert min(line[key] for key in ("seconds", "cpu_seconds", "learn_seconds", "learn_cpu_seconds")) >= 0.0
    assert "learn_seconds" not in judging.line_of(place, "sklvalve")
    assert given["history"] is None


def test_what_is_given_is_learnt_after_a_diagnosis_by_itself(monkeypatch):
    from benchmarks.concealed.methods import with_history as module

    monkeypatch.setattr(module.MissingPhysicsFinder, "history_of", lambda finder, recordings: recordings)
    assert learner("sklvalve_history")(["hour"]) == ["hour"]
    assert learner("sklvalve") is None


def test_the_finder_is_given_the_history(monkeypatch):
    from benchmarks.concealed.methods import with_history as module

    assert set(WITH_HISTORY) <= set(METHODS)
    monkeypatch.setattr(module.ours, "diagnose", lambda recording, **settings: settings)
    assert method("sklvalve_history")("record", history=["hour"]) == {"folder": None, "history": ["hour"]}


def test_records_without_a_history_are_not_judged_by_it(folders, monkeypatch, tmp_path):
    monkeypatch.setattr(
        run, "_all_judged", lambda work, jobs: ((item[2], {"record": item[0].name}) for item in work)
    )
    judged = []
    for folder in folders[:2]:
        (file,) = run.judge_all(folder, ["sklvalve_history"], 1, report=lambda *a, **k: None)
        judged.append(len(file.read_text().splitlines()) if file.exists() else 0)
        file.unlink(missing_ok=True)
    assert judged == [0, 2]
