# SPDX-License-Identifier: BSD-3-Clause
"""The simulation as an estimator: calibrated within its tolerance, kept, copied, and a hybrid's mechanism."""

from types import SimpleNamespace

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError

from sklvalve.datasets import make_valve_recording
from sklvalve.lssvm import LSSVMRegressor
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.recording import InputError, Recording, Valve
from sklvalve.simulation import Tolerance, ValveSimulation
from sklvalve.simulation.calibration import flow_parameters, opening_parameters
from sklvalve.simulation.simulation import learnt_rest

EFFECTS = {effect.key: effect for effect in CATALOGUE}


def _rms(values):
    return np.sqrt(np.nanmean(values**2))


def test_calibrated_it_meets_the_recording_and_what_follows(simulation, recording, later):
    for rows in (recording, later):
        made = simulation.simulate(rows)
        assert set(made) == {"opening", "flow", "flow_from_command"}
        span = recording["flow"].max()
        assert _rms(made["flow"] - rows["flow"]) < 0.012 * span
        assert _rms((made["opening"] - rows["opening"])[30:]) < 0.012
        np.testing.assert_array_equal(simulation.predict(rows), made["flow"])


def test_it_stays_within_the_tolerance_of_the_sheet(simulation, recording):
    tolerance, valve = Tolerance(), recording.valve
    parameters = [
        *opening_parameters(recording, valve, tolerance),
        *flow_parameters(recording, valve, tolerance, simulation.trim_, choking=True),
    ]
    assert {p.name for p in parameters} == set(simulation.values_)
    for p in parameters:
        slack = 1e-9 * max(abs(p.low), abs(p.high))
        assert p.low - slack <= simulation.values_[p.name] <= p.high + slack


def test_as_a_mechanism_its_parameter_is_a_factor_on_capacity(simulation, recording):
    factor = np.linspace(0.5, 1.5, len(recording))
    flow = simulation.forward(recording, factor)
    np.testing.assert_allclose(flow, factor * simulation.predict(recording), rtol=1e-15)
    back = simulation.invert(recording, flow)
    known = np.isfinite(back)
    assert known.mean() > 0.9
    np.testing.assert_allclose(back[known], factor[known], rtol=1e-12)


def test_clone_is_unfitted_and_fits_the_same(simulation, recording):
    tolerant = ValveSimulation(tolerance=Tolerance(capacity=0.2))
    assert clone(tolerant).get_params() == tolerant.get_params()
    again = clone(simulation)
    with pytest.raises(NotFittedError):
        again.predict(recording)
    assert again.fit(recording) is again
    assert again.values_ == simulation.values_


def test_state_comes_back_bit_equal(simulation, later):
    state = simulation.to_state()
    back = ValveSimulation.from_state(simulation.valve_, state, ())
    before, after = simulation.simulate(later), back.simulate(later)
    for signal in before:
        np.testing.assert_array_equal(after[signal], before[signal])


def test_state_with_a_learnt_trim_an_effect_and_its_onset_comes_back(recording, later):
    signals = {role: recording[role] for role in ("command", "opening", "p1", "p2", "temperature", "flow")}
    frame = Recording.from_frame(
        {"time": recording.time} | signals, Valve.from_dict({"fluid": {"name": "water"}})
    )
    onset = {"seat_leakage": float(recording.time[300])}
    simulation = ValveSimulation(effects=(EFFECTS["seat_leakage"],), onsets=onset).fit(frame)
    assert not simulation.trim_.known
    state = simulation.to_state()
    assert state["effects"] == ["seat_leakage"]
    assert state["onsets"] == onset
    back = ValveSimulation.from_state(simulation.valve_, state, (EFFECTS["seat_leakage"],))
    np.testing.assert_array_equal(back.predict(later), simulation.predict(later))


def test_frame_of_roles_in_si_is_a_recording(simulation, later):
    bare = {role: later[role] for role in later} | {"time": later.time}
    np.testing.assert_array_equal(simulation.predict(bare), simulation.predict(later))


def test_without_flow_or_opening_it_says_what_it_can(simulation, later):
    blind = {role: later[role] for role in ("p1", "p2", "temperature", "command")} | {"time": later.time}
    made = simulation.simulate(blind)
    assert set(made) == {"opening", "flow", "flow_from_command"}
    shut_out = {role: later[role] for role in ("p1", "p2", "temperature")} | {"time": later.time}
    with pytest.raises(InputError, match="a flow needs an opening or a command"):
        simulation.predict(shut_out)


def test_a_bare_array_is_refused():
    with pytest.raises(InputError, match="needs signals by name; got ndarray"):
        ValveSimulation().fit(np.zeros((200, 3)))


def _signals(dp):
    """What a chain hands to a correction that hangs on the pressure drop [bar]."""
    return SimpleNamespace(command=None, temperature=None, dp=dp * 1e5, pressure_ratio=None)


def test_correction_is_the_estimator_whose_numbers_it_keeps():
    x = np.random.default_rng(0).uniform(-1.0, 1.0, 40)
    fitted = LSSVMRegressor(gamma=1.5, C=10.0).fit(x[:, None], np.sin(3.0 * x))
    part = {
        "inputs": ("dp",),
        "centre": np.zeros(1),
        "scale": np.ones(1),
        "support": fitted.X_fit_,
        "coefficients": fitted.dual_coef_,
        "intercept": fitted.intercept_,
        "gamma": fitted.gamma,
        "span": 1.0,
    }
    np.testing.assert_allclose(learnt_rest(part, _signals(x), {}), fitted.predict(x[:, None]), rtol=1e-12)


def test_correction_never_guesses_beyond_what_it_saw():
    support = np.linspace(-1.0, 1.0, 5)[:, None]
    part = {
        "inputs": ("dp",),
        "centre": np.array([2.0]),
        "scale": np.array([0.5]),
        "support": support,
        "coefficients": np.array([1.0, -0.5, 0.2, 0.0, 0.7]),
        "intercept": 0.1,
        "gamma": 0.8,
        "span": 3.0,
    }
    at = np.array([1.5, 2.0, 2.5, -7.0, 9.0, np.nan])
    rest = learnt_rest(part, _signals(at), {})
    z = (at[:3] - 2.0) / 0.5
    kernel = np.exp(-0.8 * (z[:, None] - support.T) ** 2)
    np.testing.assert_allclose(rest[:3], 3.0 * (kernel @ part["coefficients"] + 0.1), rtol=1e-12)
    # the nearest edge holds, and a gap adds nothing
    assert rest[3] == rest[0]
    assert rest[4] == rest[2]
    assert rest[5] == 0.0


def test_a_sheet_without_rated_capacity_takes_its_scale_from_the_recording():
    made = make_valve_recording(loop="wide", n_samples=600, n_later=0, random_state=4)
    sheet = {**made.valve, "valve": {k: v for k, v in made.valve["valve"].items() if k != "kv_rated"}}
    recording = Recording.from_frame(made.frame, Valve.from_dict(sheet))
    simulation = ValveSimulation().fit(recording)
    rated = made.valve["valve"]["kv_rated"]
    assert 0.5 * rated < simulation.values_["capacity"] < 1.5 * rated
    again = ValveSimulation.from_state(simulation.valve_, simulation.to_state(), ())
    np.testing.assert_array_equal(again.predict(recording), simulation.predict(recording))


def test_its_score_is_that_of_the_recorded_flow(simulation, later):
    flow, made = later["flow"].copy(), simulation.predict(later)
    expected = 1.0 - np.sum((flow - made) ** 2) / np.sum((flow - flow.mean()) ** 2)
    assert simulation.score(later) == pytest.approx(expected, rel=1e-12)
    assert expected > 0.9
    assert simulation.score(later, flow) == simulation.score(later)
    flow[:50] = np.nan
    known = np.arange(len(flow)) >= 50
    assert simulation.score(later, flow) == simulation.score(later, later["flow"], sample_weight=known)
    assert simulation.score(later, flow[::-1]) < 0.5


def test_a_score_without_a_flow_is_refused(simulation, later):
    without = {role: values for role, values in later.signals.items() if role != "flow"}
    with pytest.raises(InputError, match="a score needs a recorded flow"):
        simulation.score({"time": later.time} | without)
    with pytest.raises(InputError, match="in at least two rows; there are 0"):
        simulation.score(later, np.full(len(later), np.nan))
    with pytest.raises(InputError, match="one flow for each of 300 rows"):
        simulation.score(later, later["flow"][:9])


def test_one_row_is_too_few_to_calibrate_on(recording):
    with pytest.raises(InputError, match="at least 2 rows, got 1"):
        ValveSimulation().fit(recording.slice(0, 1))


def test_a_refit_asks_for_nothing_that_only_the_fit_before_had(simulation, recording):
    """One that was driven by a simulated flow is calibrated anew on a recording without it."""
    frame = {"time": recording.time} | dict(recording.signals)
    given = ValveSimulation().fit(frame | {"simulated_flow": simulation.predict(recording)})
    assert "given_gain" in given.values_
    assert "given_gain" not in given.fit(frame).values_


def test_signals_in_a_dict_need_no_time(recording):
    """As of a data frame whose index is none, the rows are then seconds."""
    signals = dict(recording.slice(0, 200).signals)
    timed = ValveSimulation().fit({"time": np.arange(200.0)} | signals)
    assert ValveSimulation().fit(signals).values_ == timed.values_
