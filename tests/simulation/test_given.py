# SPDX-License-Identifier: BSD-3-Clause
"""The user's own simulation as columns, as a function or as a regressor."""

from dataclasses import replace

import numpy as np
import pytest
from sklearn.linear_model import LinearRegression

from sklvalve import MissingPhysicsFinder, Valve
from sklvalve.mechanism.liquid import FLOW_CONSTANT
from sklvalve.mismatch.data.preparation import candidates
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.inference.problem import Problem
from sklvalve.recording import InputError, Recording
from sklvalve.recording.diagnosable import require_diagnosable
from sklvalve.simulation import Tolerance, ValveSimulation
from sklvalve.simulation.given_columns import with_given

EFFECTS = {e.key: e for e in CATALOGUE}
AS_IT_IS = {"given_gain": 1.0, "meter_lag": 1e-6, "meter_ahead": 1.0, "flow_zero": 0.0}
N = 900


def own_simulation(signals):
    """Flow [m3/s] of water through a linear trim of kv 25."""
    drop = (signals["p1"] - signals["p2"]) / 998.2
    return FLOW_CONSTANT * 25.0 * signals["opening"] * np.sqrt(drop)


def frame(leak_kv=0.0, seed=0):
    rng = np.random.default_rng(seed)
    t = np.arange(float(N))
    opening = 0.45 + 0.3 * np.sin(t / 35.0) + 0.1 * np.sin(t / 11.0)
    p1 = 6e5 + 4e4 * np.sin(t / 60.0) + 2e4 * rng.standard_normal(N).cumsum() / 30.0
    signals = {"time": t, "opening": opening, "p1": p1, "p2": np.full(N, 2e5)}
    leak = FLOW_CONSTANT * leak_kv * np.sqrt((p1 - 2e5) / 998.2)
    noise = 2e-5 * rng.standard_normal(N)
    return signals | {"flow": own_simulation(signals) + leak + noise}


@pytest.fixture(scope="module")
def recording():
    signals = frame()
    return Recording.from_frame(signals | {"simulated_flow": own_simulation(signals)})


@pytest.fixture(scope="module")
def bench(recording):
    return Problem.of(recording, Tolerance(), ())


def _flow(bench, key=None, **own):
    members = () if key is None else (Term(EFFECTS[key]),)
    values = AS_IT_IS | {f"{key}.{name}": value for name, value in own.items()}
    return bench.chain(members).flow(values)


def test_without_effects_it_is_what_the_user_gave(bench, recording):
    np.testing.assert_allclose(_flow(bench), recording["simulated_flow"], rtol=1e-12)


def test_effects_change_the_given_flow_by_their_equations(bench, recording):
    given, root = recording["simulated_flow"], np.sqrt((recording["p1"] - 2e5) / bench.plain.density)
    np.testing.assert_allclose(_flow(bench, "capacity_error", gain=0.2), 1.2 * given, rtol=1e-12)
    leaking = given + FLOW_CONSTANT * 0.7 * root
    np.testing.assert_allclose(_flow(bench, "seat_leakage", leak_kv=0.7), leaking, rtol=1e-9)
    lower = given * np.sqrt((recording["p1"] - 2e5 + 3e4) / (recording["p1"] - 2e5))
    biased = [_flow(bench, "inlet_pressure_bias", bias=b) for b in (3e4, -3e4)]
    assert min(np.max(np.abs(b - lower)) for b in biased) < 1e-9


def test_trim_is_read_off_the_given_flow(bench):
    np.testing.assert_allclose(bench.trim.at([0.3, 0.5, 0.7]), [7.5, 12.5, 17.5], rtol=0.03)


def test_a_trim_within_its_tolerance_is_calibrated_and_one_beyond_it_is_not(recording):
    opening = recording["opening"]
    for bend, lost in ((0.06, 0.1), (0.6, 0.5)):
        own = np.exp(bend * np.sin(2.0 * np.pi * opening)) * recording["simulated_flow"]
        other = replace(recording, signals=recording.signals | {"flow": own})
        bench = Problem.of(other, Tolerance(), ())
        left = bench.residuals(bench.fit(()))["flow"]
        off = np.std(recording["simulated_flow"] - own)
        assert (np.nanstd(left) < lost * off) == (bend < 0.1)


def choking(fl):
    """Signals of a valve that chokes in most rows, and its flow by the smaller of two drops [m3/s]."""
    signals = frame()
    signals["p2"] = 1.2e5 + 8e4 * (1.0 + np.sin(signals["time"] / 23.0))
    driving = np.minimum(signals["p1"] - signals["p2"], fl**2 * (signals["p1"] - 0.955 * 2.3e3))
    flow = FLOW_CONSTANT * 25.0 * signals["opening"] * np.sqrt(driving / 998.2)
    return signals | {"temperature": np.full(N, 293.15), "flow": flow}


@pytest.mark.parametrize(("own_fl", "least", "most"), [(0.82, 0.0, 0.005), (0.4, 0.05, 1.0)])
def test_choking_stays_open_within_the_tolerance_of_the_sheet(own_fl, least, most):
    simulated = choking(0.8)["flow"]
    valve = Valve.from_dict({"valve": {"fl": 0.8}, "simulation": {"physics": ["choked_flow"]}})
    recording = Recording.from_frame(choking(own_fl) | {"simulated_flow": simulated}, valve)
    fitted = ValveSimulation(valve).fit(recording)
    np.testing.assert_allclose(fitted.trim_.at([0.3, 0.5, 0.7]), [7.5, 12.5, 17.5], rtol=0.03)
    off = np.sqrt(np.mean((fitted.simulate(recording)["flow"] / recording["flow"] - 1.0) ** 2))
    assert least < off < most


def test_zero_of_the_pressures_moves_the_given_flow(bench, recording):
    drop = recording["p1"] - 2e5
    ratio = bench.plain.flow(AS_IT_IS | {"dp_zero": 800.0}) / bench.plain.flow(AS_IT_IS)
    np.testing.assert_allclose(ratio, np.sqrt(1.0 + 800.0 / drop), rtol=1e-6)


def test_play_shifts_the_given_flow_along_its_own_trim(bench, recording):
    size = 0.06
    moved = _flow(bench, "position_sensor_bias_loop", bias=size) - recording["simulated_flow"]
    root = np.sqrt((recording["p1"] - 2e5) / bench.plain.density)
    inside = (recording["opening"] > 0.25) & (recording["opening"] < 0.75)
    np.testing.assert_allclose(
        moved[inside], -(FLOW_CONSTANT * 25.0 * size * root)[inside], rtol=0.25, atol=0.0
    )


def test_what_a_given_flow_cannot_show_is_told_with_the_reason(recording):
    signals = {r: recording[r] for r in ("flow", "simulated_flow")} | {"time": recording.time}
    signals["command"] = np.roll(recording["opening"], 5)
    bench = Problem.of(Recording.from_frame(signals), Tolerance(), ())
    found, untestable = candidates(bench, "all", [])
    keys, needs = {e.key for e in found}, {u["name"]: u["needs"] for u in untestable}
    assert {"seat_leakage", "capacity_error", "flow_meter_bias", "dead_time"} <= keys
    assert needs["backlash"] == "a recorded opening that the simulated flow follows"
    assert needs["stiction"] == "the package's own simulation of the actuator"
    assert needs["slew_limit"] == "a recorded opening"


def test_a_leak_beside_the_given_flow_is_found_and_corrected():
    signals = frame(leak_kv=1.0)
    recording = Recording.from_frame(signals | {"simulated_flow": own_simulation(signals)})
    finder = MissingPhysicsFinder(effects=["seat_leakage", "flow_meter_bias", "clogging"]).fit(recording)
    found = finder.diagnosis_.to_dict()
    assert found["verdict"] == "named"
    assert "seat_leakage" in {m["name"] for m in found["effects"][0]["members"]}
    later = frame(leak_kv=1.0, seed=1)
    later = Recording.from_frame(later | {"simulated_flow": own_simulation(later)})
    error = np.std(finder.corrected_simulation_.predict(later) - later["flow"])
    assert error < 0.5 * np.std(later["simulated_flow"] - later["flow"]) + 2.5e-5
    state = finder.corrected_simulation_.to_state()
    again = ValveSimulation.from_state(recording.valve, state, finder.corrected_simulation_.effects)
    np.testing.assert_array_equal(again.predict(later), finder.corrected_simulation_.predict(later))
    with pytest.raises(InputError, match="no simulated_flow"):
        again.predict(Recording.from_frame(frame(seed=1)))


def test_a_function_is_evaluated_to_the_same_column(recording):
    plain = Recording.from_frame(frame())
    given = with_given(plain, own_simulation)
    np.testing.assert_array_equal(given["simulated_flow"], recording["simulated_flow"])
    finder = MissingPhysicsFinder(own_simulation, effects=["seat_leakage"]).fit(plain)
    assert finder.diagnosis_.to_dict()["verdict"] == "no_mismatch"
    later = Recording.from_frame(frame(seed=2))
    np.testing.assert_allclose(finder.corrected_simulation_.predict(later), later["flow"], atol=6e-4)


def test_a_fitted_regressor_is_asked_for_the_roles_that_it_knows():
    pandas = pytest.importorskip("pandas")
    signals = frame()
    X = pandas.DataFrame({r: signals[r] for r in ("p1", "opening")})
    regressor = LinearRegression().fit(X, signals["flow"])
    made = with_given(Recording.from_frame(signals), regressor)["simulated_flow"]
    np.testing.assert_allclose(made, regressor.predict(X))
    bare = {r: signals[r] for r in ("time", "flow", "opening")}
    with pytest.raises(InputError, match="'p1', which is not recorded"):
        with_given(Recording.from_frame(bare), regressor)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (lambda recording: np.zeros(3), "one value for each of the 900 rows"),
        (lambda recording: {"level": np.zeros(N)}, "returned 'level'"),
        (LinearRegression().fit(np.eye(7), np.arange(7.0)), "fitted to 7 columns without names"),
    ],
)
def test_what_is_no_simulation_is_refused_in_a_sentence(given, words):
    with pytest.raises(InputError, match=words):
        with_given(Recording.from_frame(frame()), given)


def test_given_opening_takes_the_place_of_the_actuator():
    t = np.arange(600.0)
    command = 0.5 + 0.3 * np.sign(np.sin(t / 40.0))
    signals = {"time": t, "command": command, "opening": command, "simulated_opening": command}
    bench = Problem.of(Recording.from_frame(signals), Tolerance(), ())
    values = {"actuator_filter": 1e-6, "actuator_delay": 0.0, "position_zero": 0.0}
    np.testing.assert_allclose(bench.plain.opening(values), command, atol=1e-12)
    late = bench.chain([Term(EFFECTS["dead_time"])]).opening(values | {"dead_time.delay": 3.0})
    np.testing.assert_allclose(late[3:], command[:-3], atol=1e-12)


def test_a_simulation_of_what_is_not_recorded_is_refused():
    signals = {r: v for r, v in frame().items() if r != "flow"}
    recording = Recording.from_frame(signals | {"simulated_flow": own_simulation(signals)})
    with pytest.raises(InputError, match="is a simulation of the flow, which is not recorded"):
        require_diagnosable(recording)
