# SPDX-License-Identifier: BSD-3-Clause
import copy

import pytest

from sklvalve.report import to_text
from sklvalve.report.noise import noise_told
from sklvalve.report.rows import details, proof_notes
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


def test_the_floor_beside_the_errors_is_the_one_noise_figure(diagnosis):
    diagnosis |= {"verdict": "named", "effects": [examples.PLAY]}
    text = " ".join(to_text(diagnosis).split())
    assert "noise alone gives 0.2 m3/h" in text
    assert "0.21" not in text
    assert "0.25" not in text


def test_an_error_no_larger_than_the_scatter_leaves_nothing_to_explain(diagnosis):
    (line,) = noise_told(diagnosis)
    assert line == (
        "The flow error is no larger than the scatter at repeated operating points: nothing is left to "
        "explain."
    )
    assert line in details(diagnosis)
    assert line not in proof_notes(diagnosis)


def test_noise_above_that_at_rest_is_reported(diagnosis):
    told = diagnosis["fit"]["flow"]["model_free"]
    told |= {"noise_model_above_steady": True, "repeats_above_steady": True, "at_repeats": False}
    assert noise_told(diagnosis) == [
        "The fitted noise of flow exceeds the noise measured while the valve is at rest: it may have "
        "absorbed missing physics. Repeated operating points of flow differ by more than noise: "
        "hysteresis or drift."
    ]


def test_a_recording_that_says_nothing_of_its_noise_has_no_line(diagnosis):
    told = diagnosis["fit"]["flow"]["model_free"]
    told |= {"at_repeats": False}
    told["steady"] = {"value": None, "rows": 0, "reason": "the opening never rests"}
    assert noise_told(diagnosis) == []
    assert noise_told(examples.no_mismatch()) == []


def test_repeats_that_differ_have_a_date_where_there_is_one(diagnosis):
    diagnosis["fit"]["flow"]["model_free"] |= {"repeats_above_steady": True, "at_repeats": False}
    change = {"signal": "flow", "time": 812.0, "ci95": [800.0, 820.0], "size": 0.5, "unit": "m3/h"}
    diagnosis["location"] = {"change": change}
    (line,) = noise_told(diagnosis)
    assert "it changed at 812 s [800 to 820 s]: the flow reads 0.5 m3/h higher" in line
