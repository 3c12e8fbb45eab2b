# SPDX-License-Identifier: BSD-3-Clause
"""A history knows the play of a sound valve, and a later recording is held against that."""

import numpy as np
import pytest

from sklvalve.history import ValveHistory
from sklvalve.history.then import simulation_then
from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.simulation import Tolerance
from sklvalve.simulation.calibration import channels_of, sound_play
from sklvalve.simulation.filtered_position import filtered_position
from tests.history.plant import changed, without


def _with_play(recording, learnt, width):
    """The recording with the flow of a plug that has so much more play, and the same noise.

    The plug follows the stem, not the noise of its sensor.
    """
    stem = changed(recording, opening=filtered_position(recording))
    simulation = simulation_then(learnt)
    own = simulation.values_["plug_play"]
    tight, loose = (
        type(simulation)
        .from_parts(
            learnt.valve_,
            learnt.trim_,
            simulation.values_ | {"plug_play": play},
            choking="choked_flow" in learnt.valve_.physics,
        )
        .simulate(stem)["flow"]
        for play in (own, own + width)
    )
    return changed(recording, flow=recording["flow"] + loose - tight)


@pytest.fixture(scope="module")
def loose(before, learnt):
    return ValveHistory().fit(_with_play(before, learnt, 0.004))


def test_play_is_learnt(learnt, loose):
    # twenty minutes tell it from a slower meter to about a third
    assert loose.values_["plug_play"] - learnt.values_["plug_play"] == pytest.approx(0.004, abs=0.002)
    at = loose.prior_.names.index("plug_play")
    # known to what is allowed of a change, where the sheet leaves 0.3 % open
    assert np.sqrt(loose.prior_.covariance[at, at]) < 0.001


def test_a_later_recording_is_calibrated_with_it(after, loose):
    problem = prepared_problem(after, None, None, history=loose)
    names = {p.name: p for p in problem.calibration(("flow",))}
    assert names["plug_play"].joint is not None
    assert {p.name for p in problem.calibration(("opening",))} >= {"link_play"}
    assert problem.tolerance.play == 0.0
    alone = prepared_problem(after, None, None)
    assert "plug_play" not in {p.name for p in alone.calibration(("flow",))}
    assert alone.tolerance == Tolerance()


def test_half_as_much_of_a_known_stem_counts(after, loose):
    known, alone = (prepared_problem(after, None, None, history=h) for h in (loose, None))
    assert known.least("opening") == 0.5 * alone.least("opening")
    assert known.least("flow") == alone.least("flow")


def test_without_a_position_no_play_of_the_linkage_is_asked_for(before):
    assert _names(before) == {"link_play", "plug_play", "plug_overshoot"}
    assert _names(without(before, "opening")) == {"plug_play", "plug_overshoot"}


def _names(recording):
    return {p.name for p in sound_play(recording, Tolerance(), channels_of(recording))}
