# SPDX-License-Identifier: BSD-3-Clause
"""What a simulation leaves over beyond the noise of the history, in blocks of the length that shows it."""

from copy import copy
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve import MissingPhysicsFinder
from sklvalve.mismatch.constants import NO_IMITATION
from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.effects.flow_meter_gain import FlowMeterGain
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.residual.since_history import _in_channel, left_since
from sklvalve.report.sentence import summary_sentence
from tests.history.plant import changed


def _left(recording, history):
    problem, nominal = calibrated(prepared_problem(recording, None, None, history=history))
    return left_since(problem, problem.least_squares(nominal))


@pytest.fixture(scope="module")
def healthy(learnt, after):
    return _left(after, learnt)


def _pulses(rows):
    """Ten rows in every hundred."""
    return (np.arange(rows) % 100 < 10).astype(float)


def _beat(rows):
    """To and fro in 60 rows, with a strength that comes and goes."""
    t = np.arange(rows)
    return np.sin(2.0 * np.pi * t / 60.0) * (1.0 + 0.5 * np.sin(2.0 * np.pi * t / 500.0))


def _wander(rows):
    walk = np.random.default_rng(3).normal(size=rows).cumsum()
    return (walk - walk.mean()) / walk.std()


def test_little_of_a_healthy_valve(healthy):
    assert healthy.effect_size < 2.0
    assert healthy.times < 1.5


@pytest.mark.parametrize(
    ("shape", "size", "blocks"),
    [(_pulses, 0.03, (1, 8)), (_beat, 0.01, (8, 32)), (_wander, 0.015, (8, 256))],
)
def test_what_has_no_equation_stands_out_in_blocks_of_its_own_length(
    learnt, after, healthy, shape, size, blocks
):
    added = size * np.nanmax(after["flow"]) * shape(len(after))
    left = _left(changed(after, flow=after["flow"] + added), learnt)
    assert left.channel == "flow"
    assert left.effect_size > 4.0 > 2.0 * healthy.effect_size
    assert blocks[0] <= left.rows <= blocks[1]
    # about as large as what was added, which no calibration takes up
    beyond = np.sqrt(left.size**2 - left.allowed**2)
    assert 0.3 * size * np.std(shape(len(after))) < beyond < 1.5 * size * np.std(shape(len(after)))


def test_a_signal_that_is_not_asked_says_nothing(learnt, after):
    beaten = changed(after, flow=after["flow"] + 0.02 * np.nanmax(after["flow"]) * _beat(len(after)))
    problem, nominal = calibrated(prepared_problem(beaten, None, None, history=learnt))
    model = problem.least_squares(nominal)
    assert left_since(problem, model).channel == "flow"
    assert left_since(problem, model).effect_size > 4.0
    of_stem = left_since(problem, model, ("opening",))
    assert of_stem.channel == "opening"
    assert of_stem.effect_size < 4.0
    assert left_since(problem, model, ()) is None


def test_a_search_that_learnt_the_noise_from_the_residual_changes_nothing(learnt, after):
    wandered = changed(after, flow=after["flow"] + 0.02 * np.nanmax(after["flow"]) * _wander(len(after)))
    problem, nominal = calibrated(prepared_problem(wandered, None, None, history=learnt))
    own = problem.with_noise_of(nominal)
    assert own.noise["flow"].total > 1.5 * problem.noise["flow"].total
    assert left_since(own, nominal) == left_since(problem, nominal)


@pytest.mark.parametrize("size", [0.1, 0.2])
def test_a_trifle_is_not_strong_however_clear(learnt, after, size):
    # of a tenth of the noise: then a swing shows that is a small share of what counts
    parts = learnt.noise_parts("flow")
    small = {name: 0.01 * getattr(parts, name) for name in ("base", "share", "timing", "fast", "slow")}
    still = copy(learnt)
    still.noise_parts = lambda _: replace(
        parts, size=0.1 * parts.size, inadequacy=0.1 * parts.inadequacy, **small
    )
    problem, nominal = calibrated(prepared_problem(after, None, None, history=learnt))
    noise = 0.1 * parts.size * np.random.default_rng(1).normal(size=len(after))
    added = (
        size
        * problem.least("flow")
        * problem.spans["flow"]
        * np.sqrt(2.0)
        * np.sin(np.arange(len(after)) / 30.0)
    )
    quiet = prepared_problem(
        changed(after, flow=nominal.predictions["flow"] + noise + added), None, None, history=still
    )
    same = quiet.simulate((), nominal.values)
    left = _in_channel(quiet.with_noise_of(same, cautious=True), still, same, None, "flow")
    assert left.times > 2.0
    assert left.effect_size < 15.0 * size


def test_nothing_is_said_of_rows_where_the_history_has_not_been(learnt, after):
    elsewhere = copy(learnt)
    elsewhere.range_ = SimpleNamespace(met=lambda recording, _: np.zeros(len(recording), dtype=bool))
    problem, nominal = calibrated(prepared_problem(after, None, None, history=learnt))
    assert left_since(problem, nominal) is not None
    assert left_since(replace(problem, history=elsewhere), nominal) is None


def test_without_a_history_there_is_nothing_to_compare(after):
    problem, nominal = calibrated(prepared_problem(after, None, None))
    assert left_since(problem, nominal) is None


@pytest.mark.parametrize(("share", "strong"), [(0.25, False), (0.6, True)])
def test_an_effect_may_be_wrong_by_a_share_of_what_it_explains(learnt, after, share, strong):
    # to and fro with the effect itself, which steps follow
    turn = np.sign(np.sin(np.arange(len(after)) / 100.0))
    gained = 0.1 * (1.0 + share * turn)
    recording = changed(after, flow=after["flow"] * (1.0 - gained))
    problem, nominal = calibrated(prepared_problem(recording, None, None, history=learnt))
    model = problem.least_squares(problem.fit((Term(FlowMeterGain()),), start=nominal))
    noted = problem.with_noise_of(model, cautious=True)
    bare = problem.baseline(model, (), model)
    left = _in_channel(noted, learnt, model, bare, "flow")
    assert (left.effect_size > 4.0) is strong
    assert left.allowed > 1.05 * left.noise
    # without its allowance what it leaves over stands out in both
    assert _in_channel(noted, learnt, model, None, "flow").effect_size > 4.0
    alone = _in_channel(problem, learnt, nominal, None, "flow")
    assert alone.allowed == alone.noise


@pytest.mark.slow
def test_a_dozen_equal_pulses_are_told_and_get_no_name(learnt, after):
    # a meter's zero in spells comes near to explaining them, so they are not said to be of no catalogue
    pulses = 0.03 * np.nanmax(after["flow"]) * _pulses(len(after))
    finder = MissingPhysicsFinder(history=learnt, random_state=0, n_jobs=1)
    told = finder.fit(changed(after, flow=after["flow"] + pulses)).diagnosis_.content
    assert told["verdict"] in ("none_of_these", "cannot_tell")
    assert told["mismatch"]["p_value"] < 0.01
    assert not told["effects"]
    assert told["reasons"]


@pytest.mark.slow
def test_pulses_without_an_equation_are_new_and_none_of_the_known_effects(learnt, after):
    # more of them than spells of an effect: a meter's zero that comes and goes explains a dozen
    pulses = 0.03 * np.nanmax(after["flow"]) * (np.arange(len(after)) % 40 < 5)
    finder = MissingPhysicsFinder(history=learnt, random_state=0, n_jobs=1)
    told = finder.fit(changed(after, flow=after["flow"] + pulses)).diagnosis_.content
    assert told["verdict"] == "none_of_these"
    assert told["unknown"]["signal"] == "flow"
    assert told["unknown"]["beyond_noise"]["rows"] <= 16
    # it is the chance of what is left over, of which the whole evidence is a part
    assert told["unknown"]["p_value"] < told["mismatch"]["p_value"] < 0.01
    assert "comes and goes within about" in summary_sentence(told)


@pytest.mark.slow
def test_an_imitation_that_leaves_more_than_the_noise_is_no_name(learnt, after):
    # ports of a cage that turn past: a smaller capacity on the whole, and to and fro by more than an
    # effect's simulation may be wrong
    turn = np.sin(np.arange(len(after)) / 12.0)
    finder = MissingPhysicsFinder(history=learnt, random_state=0, n_jobs=1)
    told = finder.fit(changed(after, flow=after["flow"] * (0.9 - 0.025 * turn))).diagnosis_.content
    rule = next(each for each in told["rules"] if each["name"] == "history_noise")
    assert rule["value"] < 0.01 < rule["limit"] == NO_IMITATION
    assert not rule["passed"]
    assert told["verdict"] != "named"
    assert "capacity error" in told["reasons"][0]


def _offset(command):
    """A command that a characteriser nobody knows of bends."""
    return command + 0.006 * np.sin(2.0 * np.pi * command / 0.3)


def _hysteresis(command):
    """One that lags in its own direction and wanders."""
    walk = np.random.default_rng(1).normal(size=len(command)).cumsum() / 20.0
    return command + np.where(np.gradient(command) > 0.0, 0.01, -0.01) + 0.006 * walk


@pytest.mark.slow
@pytest.mark.parametrize("bent", [_offset, _hysteresis])
def test_a_cause_of_the_flow_keeps_its_name_where_the_opening_is_not_explained(learnt, after, bent):
    shifted = after["flow"] + 0.03 * np.nanmax(after["flow"])
    recording = changed(after, flow=shifted, command=bent(after["command"]))
    told = MissingPhysicsFinder(history=learnt, random_state=0, n_jobs=1).fit(recording).diagnosis_.content
    assert told["verdict"] == "named"
    (effect,) = told["effects"]
    assert "flow_meter_bias" in {member["name"] for member in effect["members"]}
    # and it is said that the opening differs too
    assert told["reasons"][0].startswith("The opening differs from the history too")
    assert all(rule["passed"] for rule in told["rules"] if rule["name"] == "history_noise")
