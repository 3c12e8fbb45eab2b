# SPDX-License-Identifier: BSD-3-Clause
"""What a valve is known to have had in its history is held in a later recording, and no candidate."""

from copy import deepcopy
from dataclasses import replace

import numpy as np

from sklvalve.datasets import make_valve_recording
from sklvalve.history import Allowance, ValveHistory
from sklvalve.mismatch import CATALOGUE
from sklvalve.mismatch.data.preparation import candidates, lasting, prepared_problem
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.recording import Recording, Valve, join_recordings
from sklvalve.simulation import ValveSimulation
from sklvalve.simulation.parameters import ParameterVector
from tests.history.plant import made

LEAK, GAIN, DRIFT = (
    next(effect for effect in CATALOGUE if effect.key == key)
    for key in ("seat_leakage", "flow_meter_gain", "flow_meter_drift")
)


def test_effects_of_a_history_are_held():
    bunch = make_valve_recording("seat_leakage", 0.05, onset=0.0, loop="wide", n_samples=1200, n_later=0)
    whole = Recording.from_frame(bunch.frame, Valve.from_dict(bunch.valve))
    history = ValveHistory(effects=(LEAK,)).fit(whole.slice(0, 800))
    leak = history.values_["seat_leakage.leak_kv"]
    assert leak > 0.0
    problem = prepared_problem(whole.slice(800, 1200), history=history)
    assert [term.effect for term in problem.held] == [LEAK]
    assert problem.held_values == {"seat_leakage.leak_kv": leak}
    assert "seat_leakage" not in {effect.name for effect in candidates(problem, "all", [])[0]}
    # a simulation that has it too holds it no second time
    both = prepared_problem(whole.slice(800, 1200), ValveSimulation(effects=(LEAK,)), history=history)
    assert [term.effect for term in both.held] == [LEAK]


def test_what_is_held_is_free_and_its_allowance_is_small():
    earlier, later = made()
    history = ValveHistory(effects=(LEAK,)).fit(earlier)
    problem = prepared_problem(later, history=history)
    by_name = {p.name: p for p in problem.calibration(("flow",))}
    assert by_name["seat_leakage.leak_kv"].joint is None
    assert by_name["seat_leakage.leak_kv"].spread is None
    assert by_name["capacity"].joint is history.prior_
    # what it was is known nevertheless, and not blurred by what a leak may grow to
    (leak,) = [p for p in history.parameters if p.name == "seat_leakage.leak_kv"]
    (allowed,) = Allowance().covariance([leak], history.spans_, np.zeros((1, 1))).ravel()
    assert np.sqrt(allowed) * ParameterVector([leak]).scale[0] < 0.001 * leak.high
    # no calibration is drawn back to a leak of before
    found = history.expected_of(history.values_ | {"seat_leakage.leak_kv": 3.0})
    assert found["seat_leakage.leak_kv"] == 3.0


def test_an_onset_is_one_of_the_history():
    earlier, later = made()
    history = ValveHistory(effects=(GAIN,), onsets={GAIN.key: 600.0}).fit(earlier)
    (held,) = prepared_problem(later, history=history).held
    assert held.onset is None
    # nor does it hold in rows that are added, whose seconds may have another zero
    anew = replace(later, time=later.time - later.time[0], stamps=later.stamps - later.stamps[0])
    other = deepcopy(history).set_params(onsets={GAIN.key: 1e6})
    windows = [each.update(anew).windows_[-1] for each in (history, other)]
    np.testing.assert_array_equal(*(window.information[0].hessian for window in windows))
    assert windows[0].left == windows[1].left


def test_what_lasts():
    earlier, later = made()
    steady, dated = Term(LEAK), Term(GAIN, 600.0)
    assert lasting([steady, dated], earlier) == [steady, dated]
    assert lasting([Term(DRIFT, 600.0), Term(GAIN, 600.0, (700.0,))], earlier) == []
    assert lasting([steady, dated], join_recordings([earlier, later])) == [steady, dated]
    anew = replace(later, time=later.time - later.time[0], stamps=later.stamps - later.stamps[0])
    assert lasting([steady, dated], join_recordings([earlier, anew])) == [steady]
