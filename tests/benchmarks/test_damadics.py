# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark of detectors on the DAMADICS actuator: what it makes of decisions, and ours on a few."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.damadics import __main__ as command
from benchmarks.damadics import real_hour
from benchmarks.damadics.detector import ValveDetector
from benchmarks.damadics.naming import EFFECTS, LESS_FLOW, MORE_FLOW, OF_THE_ACTUATOR, faults_of
from benchmarks.damadics.runner import SIGNALS, SOUND, false_alarms, fitted, score, visibility
from benchmarks.damadics.tables import detected, missed, tables, visible
from sklvalve.damadics import FAULTS, SCENARIOS
from sklvalve.metrics import rmse
from sklvalve.mismatch import CATALOGUE

pd = pytest.importorskip("pandas", reason='needs pip install "sklvalve[io]"')
HOUR = Path(os.environ.get("SKLVALVE_DATA", "../shared/data")) / "damadics" / "actuator3_real_one_hour.csv"


class FullMeter:
    """Calls it an open bypass or a seat leak where the meter is full though the valve is nearly shut."""

    def fit(self, X):
        self.highest = X["F"][X["CV"] > 70.0].max()
        self.saw = tuple(X.columns)
        return self

    def predict(self, X):
        high = (X["CV"] > 70.0) & (X["F"] > 1.5 * self.highest)
        return pd.DataFrame({"detection": high, "f6+f18": high, "f19": False}, dtype=float)


@pytest.fixture(scope="module")
def ours():
    return fitted(ValveDetector("nominal", finder=False), 101)


def test_effects_point_at_faults_by_what_these_do():
    names = {effect.name for effect in CATALOGUE}
    assert EFFECTS.keys() == FAULTS.keys()
    assert {name for does in EFFECTS.values() for name in does} <= names
    assert faults_of(["bypass_open", "seat_leakage"]) == {"f6", "f18"}
    # titles mislead: play, a share of the flow, a pressure that is only shown
    assert "f4" in faults_of(["backlash"])
    assert not faults_of(["external_leakage"])
    assert not faults_of(["inlet_pressure_bias"])
    sides = OF_THE_ACTUATOR | MORE_FLOW | LESS_FLOW
    assert sides == FAULTS.keys() - {"f7", "f14", "f17"}


@pytest.mark.slow
def test_any_detector_is_scored():
    detector = fitted(FullMeter(), 101)
    assert detector.saw == SIGNALS
    line = score(detector, "f18_big", 7)
    assert line["indices"]["r_fd"] == 0.0
    assert 0.1 < line["indices"]["r_td"] < 0.5
    assert line["indices"]["dacc"] == 0.5
    assert list(line["pointed"]) == ["f6 f18"]
    assert missed(line) == 0
    # what it points at is never the true fault here
    wrong = score(detector, "f13_big", 7)
    assert wrong["indices"]["r_ti"] == -1.0
    assert missed(wrong) == sum(wrong["pointed"].values()) > 0


class Plain(FullMeter):
    """The same, which returns nothing from fit and decisions alone, as an array or in a frame."""

    def __init__(self, returns):
        self.returns = returns

    def fit(self, X):
        super().fit(X)

    def predict(self, X):
        return self.returns(super().predict(X))


@pytest.mark.slow
@pytest.mark.parametrize(
    "returns",
    [
        lambda made: made["detection"].to_numpy(),
        lambda made: made["detection"],
        lambda made: made[["detection"]],
    ],
)
def test_a_detector_may_tell_no_faults_apart(returns):
    detector = fitted(Plain(returns), 101)
    assert isinstance(detector, Plain)
    line = score(detector, "f18_big", 7)
    assert line["indices"]["r_td"] == score(fitted(FullMeter(), 101), "f18_big", 7)["indices"]["r_td"]
    assert line["indices"]["t_it"] == line["indices"]["dacc"] == -1.0
    assert line["pointed"] == {}
    assert false_alarms(detector, 201) == 0.0
    assert "| f18_big |" in tables("plain", {"f18_big": line})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("returns", "message"),
    [
        (lambda made: None, "or one decision for each of 1500 rows, got the shape ()"),
        (lambda made: made.to_numpy(), "or one decision for each of 1500 rows, got the shape (1500, 3)"),
        (
            lambda made: made[["f19"]],
            "predict must return a frame with a column 'detection', got the columns f19.",
        ),
        (
            lambda made: made.rename(columns={"f19": "f99"}),
            "A diagnosis must hold faults of f1 to f19, got 'f99'.",
        ),
        (lambda made: made.iloc[:10], "detection must have the shape (1500,), got (10,)."),
    ],
)
def test_decisions_that_are_none_get_one_sentence(returns, message):
    detector = fitted(Plain(returns), 101)
    with pytest.raises(ValueError) as told:
        score(detector, "f18_big", 7)
    assert message in str(told.value)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--detector", "nowhere:make"], "expected MODULE:FUNCTION that can be imported"),
        (["--detector", "json:nothing"], "expected MODULE:FUNCTION that can be imported"),
        (["--detector", "json"], "expected MODULE:FUNCTION that can be imported"),
        (["--detector", ":make"], "expected MODULE:FUNCTION that can be imported"),
        (["--detector", "json:__name__"], "expected a function that makes a detector, got 'json'"),
        (["--tables"], "holds no results"),
    ],
)
def test_wrong_words_get_one_sentence(tmp_path, capsys, arguments, words):
    with pytest.raises(SystemExit) as left:
        command.main([str(tmp_path), *arguments])
    assert left.value.code == 2
    assert words in capsys.readouterr().err.splitlines()[-1]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_file_in_place_of_the_folder_or_none_gets_one_sentence(tmp_path, capsys):
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(SystemExit):
        command.main([str(file)])
    assert "is a file; name a folder" in capsys.readouterr().err.splitlines()[-1]
    for module, word in (("real_hour", "nowhere.csv"), ("sheet_alone", "many")):
        asked = [sys.executable, "-m", f"benchmarks.damadics.{module}", word]
        told = subprocess.run(asked, capture_output=True, text=True, check=False)
        assert told.returncode == 1
        assert told.stderr.startswith("Expected ")
        assert told.stderr.count("\n") == 1


def test_what_a_fault_changes_is_told_from_the_noise():
    # facts computed from the benchmark's equations by another program
    assert visibility("f13_medium")["F"] == pytest.approx(0.448, abs=0.002)
    assert visibility("f10_small")["X"] == pytest.approx(0.0100, abs=0.0005)
    assert not visible("f14_big")
    assert not visible("f8_big")
    assert visible("f16_medium")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "latest", "faults"),
    [
        ("f13_big", 10.0, "f3 f6 f13 f18 f19"),
        ("f2_big", 10.0, "f2 f5 f13 f19"),
        ("f16_medium", 120.0, " ".join(sorted(OF_THE_ACTUATOR, key=lambda fault: int(fault[1:])))),
        ("f17_big", 1.0, "f17"),
        ("f7_small", 1.0, "f7"),
    ],
)
def test_ours_watches_the_right_side(ours, name, latest, faults):
    line = score(ours, name, 7)
    assert line["indices"]["r_fd"] == 0.0
    assert 0.0 <= line["indices"]["t_dt"] <= latest
    assert list(line["pointed"])[-1] == faults
    assert missed(line) == 0


def test_ours_is_silent_where_nothing_shows(ours):
    for name in ("f14_big", "f8_small"):
        line = score(ours, name, 7)
        assert not detected(line)
        assert line["pointed"] == {}
    assert false_alarms(ours, 201) == 0.0


@pytest.mark.slow
def test_the_finder_names_and_proves(ours):
    ours.finder = True
    line = score(ours, "f18_small", 7)
    ours.finder = False
    assert list(line["pointed"])[-1] == "f6 f18"
    assert missed(line) == 0
    assert all(told["proven"] for told in line["told"])


@pytest.mark.slow
def test_a_run_goes_on_where_it_was(tmp_path, capsys):
    file, wanted = tmp_path / "any.jsonl", ["f13_big", "f18_big"]
    said = []
    command.measure(FullMeter, file, wanted[1:], report=said.append)
    with file.open("a") as out:
        out.write('{"scenario": "f13_')
    command.measure(FullMeter, file, wanted, report=said.append)
    assert [text.split(": ")[1] for text in said] == [SOUND, "f18_big", "f13_big"]
    assert set(command.lines_of(file)) == {SOUND, *wanted}
    assert command.main([str(tmp_path), "--tables"]) == 0
    text = capsys.readouterr().out
    assert "Detected of those that exceed the noise: 2 of 2." in text
    assert "| f18_big | 0.0000 | 0.495" in text
    assert tables("any", {}).startswith("### any")
    assert len(SCENARIOS) == 44


@pytest.mark.skipif(not HOUR.is_file(), reason="the real hour of actuator 3 is not there")
def test_the_simulator_meets_the_real_hour():
    hour = real_hour.read_hour(HOUR)
    stem, flow = real_hour.free_run(hour)
    late = slice(30, None)
    assert rmse(hour["X"][late], stem[late]) < 1.98
    assert rmse(hour["F"][late], flow[late]) < 2.1
    assert np.isfinite(flow).all()


@pytest.mark.slow
@pytest.mark.skipif(not HOUR.is_file(), reason="the real hour of actuator 3 is not there")
def test_a_black_box_on_the_real_hour_is_as_the_page_has_it():
    position, flow = real_hour.black_boxes(real_hour.read_hour(HOUR))
    assert position == pytest.approx(1.40, abs=0.05)
    assert flow == pytest.approx(1.28, abs=0.05)
