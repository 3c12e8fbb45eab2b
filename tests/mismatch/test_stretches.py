# SPDX-License-Identifier: BSD-3-Clause
"""Long recordings: what is searched of them, and that what is found holds for all rows."""

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch import CATALOGUE, MissingPhysicsFinder
from sklvalve.mismatch.contents import Judgement, flagged_rows
from sklvalve.mismatch.hypothesis import Member
from sklvalve.mismatch.preparation import prepared_workbench
from sklvalve.mismatch.pulses import Pulses
from sklvalve.mismatch.stem_rest import StemRest
from sklvalve.mismatch.stretches import STRETCH, over_the_whole, stretches_of
from sklvalve.recording import Recording, Valve

ONSET = 2100.0
BY_KEY = {effect.key: effect for effect in CATALOGUE}


@pytest.fixture(scope="module")
def leaky():
    """A seat that leaks from a moment on which lies between two of the stretches searched."""
    made = make_valve_recording(
        "seat_leakage", 0.06, onset=ONSET, loop="wide", n_samples=4200, n_later=0, random_state=5
    )
    return Recording.from_frame(made.frame, Valve.from_dict(made.valve))


def test_short_recordings_are_searched_whole(leaky):
    assert stretches_of(leaky, None) is leaky
    assert stretches_of(leaky, len(leaky)) is leaky
    assert stretches_of(leaky, int(0.9 * len(leaky))) is leaky


def test_stretches_lie_evenly_with_their_own_times_and_settle_unseen(leaky):
    part = stretches_of(leaky, 2 * STRETCH)
    assert len(part) == 2 * STRETCH
    place = np.searchsorted(leaky.time, part.time)
    np.testing.assert_array_equal(leaky.time[place], part.time)
    np.testing.assert_array_equal(np.flatnonzero(np.diff(place) > 1), [STRETCH - 1])
    assert (place[0], place[-1]) == (0, len(leaky) - 1)
    for role in ("opening", "flow"):
        hidden = np.isnan(part[role])
        np.testing.assert_array_equal(np.flatnonzero(hidden), np.arange(STRETCH, STRETCH + 40))
        np.testing.assert_array_equal(part[role][~hidden], leaky[role][place][~hidden])
    np.testing.assert_array_equal(part["command"], leaky["command"][place])


@pytest.mark.slow
def test_what_stretches_show_is_fitted_to_all_rows_and_dated_by_them(leaky):
    stages = []
    finder = MissingPhysicsFinder(
        effects=["clogging", "seat_leakage", "piping_reducers", "flow_meter_gain"],
        search_rows=1200,
        callback=lambda stage, done: stages.append(done),
    ).fit(leaky)
    content = finder.diagnosis_.content
    assert content["verdict"] == "named"
    assert finder.diagnosis_.effects[0][0] == "seat_leakage"
    assert content["provenance"]["rows"] == len(leaky)
    assert content["fit"]["flow"]["held_out_rows"] == len(leaky)
    errors = content["fit"]["flow"]["rmse"]
    assert errors["corrected"] < 0.3 * errors["nominal"]
    # no row between 1,020 and 3,579 s was searched
    low, high = content["location"]["onset_ci95"]
    assert low <= ONSET <= high
    assert abs(content["location"]["onset"] - ONSET) < 300.0
    assert stages == sorted(stages)


def test_rows_that_stretches_show_are_asked_for_in_the_whole(leaky):
    whole = prepared_workbench(leaky)
    bench = prepared_workbench(stretches_of(leaky, 2 * STRETCH), trim=whole.trim)
    nominal = bench.fit(())
    few = np.ones(len(bench.recording), dtype=bool)
    judged = Judgement(
        "cannot_tell",
        0.005,
        [],
        None,
        nominal,
        nominal,
        strays=StemRest(few, 5, 20, 0.02),
        pulses=Pulses(few, 12, 0, True, 0.02, 1e-3),
        suspected=bench.fit((Member(BY_KEY["seat_leakage"]),), start=nominal),
    )
    told = over_the_whole(whole, judged)
    assert len(told.strays.rows) == len(leaky)
    # a sound stem and a flow without pulses have none of them in the whole
    assert told.strays.intervals == []
    assert told.pulses is None
    assert len(flagged_rows(whole, told)) == len(leaky)


def test_too_few_rows_to_search_are_refused():
    with pytest.raises(ValueError, match="search_rows"):
        MissingPhysicsFinder(search_rows=100).fit(None)
