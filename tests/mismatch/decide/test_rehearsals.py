# SPDX-License-Identifier: BSD-3-Clause
"""What a valve does by itself is no fault: its own rehearsals in the null law, and in a diagnosis."""

from dataclasses import replace

import numpy as np
import pytest

from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.history.rehearsal import Rehearsal
from sklvalve.mismatch.decide.detect import Evidence, mismatch_p_value
from sklvalve.mismatch.decide.null_reference import AGAINST_HISTORY, OF_EFFECTS, Covariates, survival
from sklvalve.mismatch.decide.rehearsing import p_value_of_rehearsal, rehearsal_of

SOMEWHERE = Covariates(noise=0.0, travel=0.5, no_opening=0.0, no_drop=0.0)
TABLE = AGAINST_HISTORY.throughout


def chance(times, *own, rests=()):
    made = [Rehearsal(once, 1.0, rest) for once, rest in zip(own, rests or [None] * len(own), strict=True)]
    table = AGAINST_HISTORY.with_rehearsals(made).throughout
    return survival(table, times * table.typical(SOMEWHERE), SOMEWHERE)


def test_without_any_the_reference_alone_counts():
    assert chance(TABLE.quantiles[-1]) == pytest.approx(TABLE.above)
    # a thousandth of healthy recordings lies beyond 2.49 times what is typical
    assert chance(2.49) == pytest.approx(1e-3, rel=0.1)


def test_what_the_valve_did_by_itself_is_not_rare():
    assert chance(13.0, 13.0, 1.0) > 0.04
    assert chance(5.0, 13.0, 1.0) > 0.08


def test_what_is_far_beyond_stays_rare():
    assert chance(600.0, 13.0, 1.0) < 1e-3


def test_a_valve_that_is_unlike_the_reference_is_not_held_against_it():
    # half as much again as it did once: rare to the reference, not to a valve that did four times the usual
    assert chance(6.0) < 1e-7
    assert chance(6.0, 4.0) > 0.01
    # a valve that is unlike the others in what is left over is so in what effects make of it
    assert chance(4.8, 1.0, rests=[28.0]) > 0.01


def test_a_stem_that_does_much_by_itself_says_nothing_of_valve_and_meters_nor_they_of_it():
    restless, plain = Rehearsal(1.0, 1.0, 1.0, stem=4.0), Rehearsal(1.0, 1.0, 1.0, stem=1.0)
    drifting = Rehearsal(4.0, 1.0, 1.0, stem=1.0)

    def beyond(look, rehearsal):
        table = AGAINST_HISTORY.with_rehearsals([rehearsal]).tables[look]
        return survival(table, 4.0 * table.typical(SOMEWHERE), SOMEWHERE)

    assert beyond("throughout", restless) == pytest.approx(beyond("throughout", plain), rel=0.5)
    assert beyond("stem", drifting) == pytest.approx(beyond("stem", plain), rel=0.5)
    assert beyond("stem", restless) > 10.0 * beyond("stem", plain)
    # what begins within a recording may be of either
    for made in (restless, drifting):
        assert beyond("within", made) > 10.0 * beyond("within", plain)
    # and what began within a rehearsal, or was left over there, says something of both
    for made in (Rehearsal(1.0, 4.0, 1.0, stem=1.0), Rehearsal(1.0, 1.0, 8.0, stem=1.0)):
        for look in ("throughout", "stem"):
            assert beyond(look, made) > 5.0 * beyond(look, plain)


@pytest.mark.parametrize("look", ["throughout", "within", "residual"])
def test_a_rehearsal_makes_nothing_rarer(look):
    for made in (Rehearsal(28.0, 1.0, 0.1), Rehearsal(0.0, 0.0, 0.0), Rehearsal(1.2, 3.0)):
        table = getattr(AGAINST_HISTORY.with_rehearsals([made]), look)
        for times in (0.5, 1.0, 2.0, 20.0):
            strength = times * table.typical(SOMEWHERE)
            alone = survival(getattr(AGAINST_HISTORY, look), strength, SOMEWHERE)
            assert survival(table, strength, SOMEWHERE) >= alone * (1.0 - 1e-12)


def test_the_rarest_of_many_ordinary_rehearsals_is_no_sign_of_another_kind():
    twenty = [Rehearsal(times, 1.0) for times in np.linspace(0.4, 1.8, 20)]
    assert AGAINST_HISTORY.with_rehearsals(twenty).throughout.weights[0] > 0.9


def test_the_reference_loses_its_weight_without_a_step():
    weights = [
        AGAINST_HISTORY.with_rehearsals([Rehearsal(times, 1.0)]).throughout.weights[0]
        for times in np.linspace(1.0, 20.0, 800)
    ]
    assert weights[0] > 0.95
    assert weights[-1] < 1e-3
    assert np.max(-np.diff(weights)) < 0.1
    assert np.max(np.diff(weights)) < 2e-3


def test_a_quiet_rehearsal_speaks_for_the_reference():
    for quiet in (Rehearsal(0.0, 0.0), Rehearsal(0.0, 0.0, 0.0), Rehearsal(1e-15, 0.0)):
        assert AGAINST_HISTORY.with_rehearsals([quiet]).throughout.weights[0] > 0.95


def test_a_valve_like_the_reference_loses_little():
    assert chance(2.1, 1.0, 1.4) < 1.5 * chance(2.1)


def test_the_chance_falls_without_a_step():
    chances = [chance(times, 13.0, 1.0) for times in (0.0, 0.1, 1.0, 12.9, 13.0, 13.1, 50.0)]
    assert chances == sorted(chances, reverse=True)
    assert chances[0] <= 1.0


@pytest.mark.parametrize("residual", [None, 3.0])
def test_a_rehearsal_is_told_relative_to_what_is_typical(residual):
    strong = {look: 5.0 * AGAINST_HISTORY.tables[look].typical(SOMEWHERE) for look in OF_EFFECTS}
    evidence = Evidence(**strong, residual=residual, covariates=SOMEWHERE, law=AGAINST_HISTORY)
    made = rehearsal_of(evidence)
    assert (made.throughout, made.stem, made.within) == pytest.approx((5.0, 5.0, 5.0))
    assert (made.residual is None) is (residual is None)
    assert p_value_of_rehearsal(made) == pytest.approx(mismatch_p_value(evidence))
    law = AGAINST_HISTORY.with_rehearsals([made])
    assert mismatch_p_value(replace(evidence, law=law)) > mismatch_p_value(evidence)


def recording(*effect, rows=2400, **settings):
    made = make_valve_recording(
        *effect, loop="wide", noise=0.5, n_samples=rows, n_later=0, random_state=3, **settings
    )
    return Recording.from_frame(made.frame, Valve.from_dict(made.valve))


@pytest.mark.slow
def test_a_change_is_told_unless_the_halves_of_the_history_lie_as_far_apart():
    whole = recording("seat_leakage", 0.02, onset=1500.0, rows=3000)
    finder = MissingPhysicsFinder(n_jobs=1)
    history = finder.history_of(whole.slice(0, 1500))
    assert len(history.rehearsals_) == 1
    told = finder.set_params(history=history).fit(whole.slice(1500, 3000)).diagnosis_
    assert told.verdict == "named"
    history.rehearsals_ = [Rehearsal(10.0, 10.0, 20.0)]
    found = finder.fit(whole.slice(1500, 3000)).diagnosis_.to_dict()
    assert found["verdict"] == "no_mismatch"
    assert any("second half of this valve's history" in reason for reason in found["reasons"])


@pytest.mark.slow
def test_a_short_history_has_none():
    assert MissingPhysicsFinder(max_effects=0, n_jobs=1).history_of(recording(rows=1100)).rehearsals_ == []
