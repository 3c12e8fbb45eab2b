# SPDX-License-Identifier: BSD-3-Clause
import copy

import pytest

from sklvalve.report.noise import noise_told
from sklvalve.report.rows import proof_notes
from tests.report import examples


@pytest.fixture
def diagnosis():
    told = copy.deepcopy(examples.no_mismatch())
    told["fit"]["flow"]["model_free"] = {
        "unit": "m3/h",
        "steady": {"value": 0.21, "rows": 1360},
        "repeats": {"value": 0.25, "rows": 88},
        "noise_model_above_steady": False,
        "repeats_above_steady": False,
        "at_repeats": True,
    }
    return told


def test_both_floors_stand_in_one_line_of_the_proof(diagnosis):
    (line,) = noise_told(diagnosis)
    assert "0.21 m3/h quick, where nothing moves (1360 rows)" in line
    assert "0.25 m3/h with wander" in line
    assert "nothing is left to explain" in line
    assert "noise model" not in line
    assert "more than noise" not in line
    assert line in proof_notes(diagnosis)


def test_a_noise_model_above_the_rests_is_told(diagnosis):
    told = diagnosis["fit"]["flow"]["model_free"]
    told |= {"noise_model_above_steady": True, "repeats_above_steady": True, "at_repeats": False}
    (line,) = noise_told(diagnosis)
    assert "may have taken up physics" in line
    assert "differs by more than noise" in line
    assert "nothing is left" not in line


def test_a_recording_that_never_rests_says_nothing(diagnosis):
    told = diagnosis["fit"]["flow"]["model_free"]
    told["steady"] = {"value": None, "rows": 0, "reason": "the opening never rests"}
    told["repeats"] = {"value": None, "rows": 0, "reason": "the opening never rests"}
    assert noise_told(diagnosis) == []
    assert noise_told(examples.no_mismatch()) == []


def test_shares_are_told_in_percent(diagnosis):
    told = diagnosis["fit"].pop("flow")
    told["model_free"] |= {"unit": "1", "steady": {"value": 0.0012, "rows": 400}, "at_repeats": False}
    diagnosis["fit"]["opening"] = told
    (line,) = noise_told(diagnosis)
    assert "Noise of opening, told without a model: 0.12 % quick" in line


def test_what_comes_back_otherwise_has_a_date_where_there_is_one(diagnosis):
    diagnosis["fit"]["flow"]["model_free"]["repeats_above_steady"] = True
    assert "it remembers, or has changed in time" in noise_told(diagnosis)[0]
    change = {"signal": "flow", "time": 812.0, "ci95": [800.0, 820.0], "size": 0.5, "unit": "m3/h"}
    diagnosis["location"] = {"change": change}
    assert "it changed at 812 s [800 to 820 s]: the flow reads 0.5 m3/h higher" in noise_told(diagnosis)[0]
