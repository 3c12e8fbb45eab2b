# SPDX-License-Identifier: BSD-3-Clause
"""Proof beyond held-out rows: outside the range fitted, where nothing acts, beside what was ruled out."""

import numpy as np
import pytest

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.result.further_proof import _ranges
from sklvalve.report import to_text
from tests.mismatch.conftest import record

LIMIT = 0.55


@pytest.fixture(scope="module")
def found():
    blocked = record("clogging", 1.0 - LIMIT, random_state=3)
    wanted = ["clogging", "piping_reducers", "seat_leakage", "choked_flow"]
    return blocked, MissingPhysicsFinder(effects=wanted).fit(blocked)


def test_named_physics_predicts_outside_the_range_of_its_fit_and_does_no_harm(found):
    _, finder = found
    assert finder.diagnosis_.effects[0][0] == "clogging"
    fit = finder.diagnosis_.content["fit"]["flow"]
    far = fit["extrapolation"]["rmse"]
    assert far["corrected"] < 0.5 * far["nominal"]
    assert far["corrected"] < 0.5 * far["black_box"]
    assert fit["elsewhere"]["rmse"]["corrected"] <= 1.1 * fit["elsewhere"]["rmse"]["nominal"]
    assert fit["ruled_out"]["name"] == "choked_flow"
    assert fit["ruled_out"]["rmse"] > fit["rmse"]["corrected"]


def test_the_range_is_the_inner_part_of_what_was_visited(found):
    recording, finder = found
    inside, outside = _ranges(recording)
    far = finder.diagnosis_.content["fit"]["flow"]["extrapolation"]
    opening = recording["opening"]
    assert opening[inside].min() >= far["fitted_from"]
    assert opening[inside].max() <= far["to"]
    assert not np.any(inside & outside)
    low, high = np.quantile(opening, [0.005, 0.995])
    assert far["to"] - far["fitted_from"] == pytest.approx(0.7 * (high - low), rel=1e-9)


def test_the_report_tells_it(found):
    told = " ".join(to_text(found[1].diagnosis_.to_dict()).split())
    assert "the flow error outside that range is" in told
    assert "In rows where what was found has less than a quarter of its largest effect, the flow" in told
    assert "With the best explanation that was ruled out" in told
    # of a channel that nothing changed there is nothing to tell
    assert "the opening error outside that range" not in told


def test_where_nothing_was_found_there_is_nothing_more_to_prove(found_healthy):
    fit = found_healthy.diagnosis_.content["fit"]
    assert not {"extrapolation", "elsewhere", "ruled_out"} & set(fit["flow"])
