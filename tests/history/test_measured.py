# SPDX-License-Identifier: BSD-3-Clause
"""A valve is learnt from what its sensors measured, as it is diagnosed."""

import numpy as np
import pytest

from benchmarks.data_defects import box_car
from sklvalve.history import ValveHistory
from sklvalve.recording import InputError, join_recordings
from sklvalve.recording.dead_bands import band_of
from sklvalve.recording.measured import as_measured
from tests.history.plant import changed, held, named, without

BAND = 0.01


def by_a_historian(recording):
    """The same recording by a historian that writes a value when it has left the last one by a band."""
    bands = {"opening": 0.004, "flow": BAND * np.nanmax(recording["flow"])}
    return changed(recording, **{r: box_car(recording[r], band, hold=True) for r, band in bands.items()})


@pytest.fixture(scope="module")
def kept(before):
    """What such a historian kept of `before`."""
    return by_a_historian(before)


def test_values_held_by_a_historian_are_known_within_its_band(kept):
    measured = as_measured(kept)
    assert measured.bands["flow"][0].size == pytest.approx(BAND * np.nanmax(kept["flow"]), rel=0.3)
    noise = ValveHistory().fit(kept).noise_parts("flow")
    # the noise of a value known within a band, and not that of a stair
    assert noise.size == pytest.approx(measured.bands["flow"][0].size / np.sqrt(12.0), rel=0.01)


def test_a_flow_whose_clock_is_late_is_set_right(before, learnt):
    late = changed(before, flow=np.concatenate([np.full(12, before["flow"][0]), before["flow"][:-12]]))
    values = ValveHistory().fit(late).values_
    for name in ("capacity", "meter_lag"):
        assert values[name] == pytest.approx(learnt.values_[name], rel=0.05)


@pytest.mark.parametrize("role", ["flow", "opening"])
def test_nothing_is_learnt_of_a_recording_in_which_a_signal_stands_still(before, after, learnt, role):
    still = held(named(after, "still"), role)
    history = ValveHistory().fit([before, still])
    assert history.rows == len(before)
    assert history.values_ == learnt.values_
    # but its rows are known again: it is no new recording
    assert [source.name for source in history.recordings_][1:] == ["still.csv"]


def test_recordings_that_all_stand_still_are_refused(before, after):
    still = [held(named(r, f"r{k}"), "flow", 0.01 + 0.001 * k) for k, r in enumerate((before, after))]
    with pytest.raises(InputError, match=r"r1\.csv: where opening and flow do not .* there are 0 rows"):
        ValveHistory().fit(still)


def test_too_few_rows_beside_those_that_stand_still_are_refused(before, after):
    with pytest.raises(InputError, match="there are 130 rows, too few to learn"):
        ValveHistory().fit([before.slice(0, 130), held(after, "flow")])


def test_a_further_recording_that_stands_still_is_refused(before, after):
    history = ValveHistory().fit(before)
    with pytest.raises(InputError, match="there are 0 rows"):
        history.update(held(named(after, "still"), "flow"))
    assert history.rows == len(before)


def test_nothing_is_learnt_of_a_stem_that_may_have_seized(before, after):
    moving, still = without(before, "flow"), without(held(named(after, "still"), "opening"), "flow")
    values = ValveHistory().fit(moving).values_
    assert ValveHistory().fit([moving, still]).values_ == values


@pytest.mark.parametrize("place", [0, 1])
def test_recordings_are_joined_with_the_bands_of_each(before, after, place):
    pieces = [before, after]
    pieces[place] = as_measured(by_a_historian(pieces[place]))
    band = band_of(join_recordings(pieces), "flow")
    of_each = [band[: len(before)], band[len(before) :]]
    assert np.all(of_each[place] == pieces[place].bands["flow"][0].size)
    assert not of_each[1 - place].any()
