# SPDX-License-Identifier: BSD-3-Clause
"""The opening from the flow, with factors that stay and factors that change with travel."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from sklvalve.mechanism import (
    CHARACTERISTICS,
    ValidityWarning,
    at_travel,
    gas_flow,
    liquid_flow,
    opening_for_flow,
    opening_for_gas_flow,
    relative_capacity,
)

FL = [[0.1, 0.95], [0.5, 0.85], [1.0, 0.6]]
FD = [[0.1, 0.3], [1.0, 0.46]]
XT = [[0.1, 0.8], [1.0, 0.6]]
TABLE = [[0.0, 0.0], [0.2, 0.03], [0.5, 0.12], [0.8, 0.55], [1.0, 1.0]]
PIPES = {"nominal_size": 0.15, "inlet_pipe": 0.2, "outlet_pipe": 0.25}


def duties(n, seed=23):
    rng = np.random.default_rng(seed)
    p1 = rng.uniform(3e5, 2e6, n)
    return {
        "opening": rng.random(n),
        "p1": p1,
        "p2": p1 * rng.uniform(0.05, 0.98, n),
        "density": rng.uniform(700.0, 1100.0, n),
        "p_vapour": rng.uniform(1e3, 2e5, n),
        "viscosity": 10.0 ** rng.uniform(-7.0, -1.5, n),
    }


def liquid(opening, trim, duty, fl, fd=None, **more):
    kv = trim["kv_rated"] * relative_capacity(
        opening, trim["characteristic"], rangeability=50.0, shutoff=0.02
    )
    if fd is not None:
        more |= {"fd": at_travel(fd, opening), "kv_rated": trim["kv_rated"], "viscosity": duty["viscosity"]}
    more |= {"fl": at_travel(fl, opening), "p_vapour": duty["p_vapour"], "warn": False}
    return liquid_flow(kv, duty["p1"], duty["p2"], duty["density"], **more)


@pytest.mark.parametrize("fl", [0.9, FL], ids=["number", "table"])
@pytest.mark.parametrize("kind", [*CHARACTERISTICS, TABLE])
def test_round_trip_of_liquid(kind, fl):
    n = 100_000 if fl == 0.9 else 10_000
    duty, trim = duties(n), {"kv_rated": 160.0, "characteristic": kind}
    flow = liquid(duty["opening"], trim, duty, fl)
    known = {name: duty[name] for name in ("p1", "p2", "density", "p_vapour")}
    again = opening_for_flow(flow, **known, fl=fl, rangeability=50.0, shutoff=0.02, **trim)
    assert_allclose(liquid(again, trim, duty, fl), flow, rtol=1e-9)
    # where F_L falls faster than the trim opens, two openings pass the same flow
    first = again < duty["opening"] - 1e-9
    assert_allclose(again[~first], duty["opening"][~first], rtol=0.0, atol=1e-9)
    if fl == 0.9 or kind in ("equal_percentage", "parabolic", "hyperbolic"):
        assert not np.any(first)


@pytest.mark.parametrize(("fl", "fd"), [(0.9, 0.46), (FL, FD)], ids=["number", "table"])
@pytest.mark.parametrize("pipes", [{"nominal_size": 0.15}, PIPES], ids=["bare", "reducers"])
@pytest.mark.parametrize("viscous", [False, True])
def test_round_trip_with_viscosity_and_reducers(viscous, pipes, fl, fd):
    duty, trim = duties(5000), {"kv_rated": 160.0, "characteristic": "equal_percentage"}
    more = {**pipes, "fd": fd} if viscous else pipes
    flow = liquid(duty["opening"], trim, duty, fl, **more)
    names = ("p1", "p2", "density", "p_vapour", *(["viscosity"] if viscous else []))
    known = {name: duty[name] for name in names} | more
    again = opening_for_flow(flow, **known, fl=fl, rangeability=50.0, shutoff=0.02, **trim)
    assert_allclose(liquid(again, trim, duty, fl, **more), flow, rtol=1e-9)


@pytest.mark.parametrize("xt", [0.7, XT], ids=["number", "table"])
@pytest.mark.parametrize(
    "more",
    [{}, PIPES, {"nominal_size": 0.1, "dynamic_viscosity": 1e-5, "fl": 0.9, "fd": 0.4}],
    ids=["bare", "reducers", "viscous"],
)
def test_round_trip_of_gas(xt, more):
    duty = duties(5000)
    state = (duty["p1"], duty["p2"], np.linspace(280.0, 450.0, 5000), 0.044)

    def gas(opening):
        rated = {"kv_rated": 100.0} if "fl" in more else {}
        kv = 100.0 * relative_capacity(opening, "linear")
        return gas_flow(kv, *state, gamma=1.3, xt=at_travel(xt, opening), basis="normal", **more, **rated)

    flow = gas(duty["opening"])
    valve = {"kv_rated": 100.0, "characteristic": "linear", "gamma": 1.3, "xt": xt}
    again = opening_for_gas_flow(flow, *state, basis="normal", **valve, **more)
    assert_allclose(gas(again), flow, rtol=1e-9)
    assert_allclose(again, duty["opening"], rtol=0.0, atol=1e-8)


def test_largest_flow_before_the_end_of_the_travel():
    # F_L falls from 0.9 to 0.3 over the last tenth, the choked flow goes with F_L times capacity
    fl = [[0.0, 0.9], [0.9, 0.9], [1.0, 0.3]]
    valve = {"kv_rated": 100.0, "characteristic": "linear", "fl": fl, "p_vapour": 2e3}
    travel = np.linspace(0.0, 1.0, 200_001)
    kv = 100.0 * travel
    flows = liquid_flow(kv, 8e5, 1e5, 998.0, fl=at_travel(fl, travel), p_vapour=2e3)
    top = np.argmax(flows)
    assert 0.9 <= travel[top] < 1.0
    assert flows[-1] < 0.5 * flows[top]
    wanted = flows[top] * np.array([0.5, 0.999999, 1.0 + 1e-6])
    with pytest.warns(ValidityWarning, match="1 of 3 rows ask for more than the valve passes at any opening"):
        opening = opening_for_flow(wanted, 8e5, 1e5, 998.0, **valve)
    assert np.isnan(opening[2])
    assert np.all(opening[:2] < travel[top])
    found = liquid_flow(100.0 * opening[:2], 8e5, 1e5, 998.0, fl=at_travel(fl, opening[:2]), p_vapour=2e3)
    assert_allclose(found, wanted[:2], rtol=1e-12)


@pytest.mark.parametrize("fl", [0.9, FL], ids=["number", "table"])
class TestEnds:
    def test_open_and_shut(self, fl):
        valve = {"kv_rated": 40.0, "characteristic": "linear", "fl": fl, "p_vapour": 2e3}
        full = liquid_flow(40.0, 4e5, 3e5, 998.0, fl=at_travel(fl, 1.0), p_vapour=2e3)
        assert_array_equal(opening_for_flow([0.0, full], 4e5, 3e5, 998.0, **valve), [0.0, 1.0])
        beyond = full * np.array([1.0 - 1e-12, 1.0 + 1e-12])
        assert_allclose(opening_for_flow(beyond, 4e5, 3e5, 998.0, **valve), 1.0, rtol=1e-9)

    def test_backwards(self, fl):
        valve = {"kv_rated": 40.0, "characteristic": "linear", "fl": fl, "p_vapour": 2e3}
        forwards = opening_for_flow(5e-3, 4e5, 3e5, 998.0, **valve)
        assert_allclose(opening_for_flow(-5e-3, 3e5, 4e5, 998.0, **valve), forwards, rtol=1e-14)

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"p2": 4e5}, "have no pressure drop"),
            ({"flow": -5e-3}, "have the flow against the pressure drop"),
            ({"flow": 1.0}, "ask for more than the valve passes at any opening"),
            ({"flow": 1e-5}, "ask for less than the shut valve lets by"),
            ({"density": -1.0}, "have pressures or properties with which these equations give no flow"),
            (
                {"p1": 1.5e3, "p2": 1e3},
                "have pressures or properties with which these equations give no flow",
            ),
        ],
    )
    def test_rows_without_an_answer(self, fl, change, message):
        duty = {"flow": 5e-3, "p1": 4e5, "p2": 3e5, "density": 998.0}
        rows = {name: np.array([value, change.get(name, value), np.nan]) for name, value in duty.items()}
        valve = {"kv_rated": 40.0, "characteristic": "linear", "rangeability": 50.0}
        with pytest.warns(ValidityWarning) as caught:
            opening = opening_for_flow(**rows, fl=fl, p_vapour=2e3, **valve)
        assert [
            str(said.message).startswith(f"opening_for_flow: 1 of 3 rows {message}") for said in caught
        ] == [True]
        assert_array_equal(np.isnan(opening), [False, True, True])
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            opening_for_flow(**rows, fl=fl, p_vapour=2e3, warn=False, **valve)

    def test_shapes(self, fl):
        valve = {"kv_rated": 40.0, "characteristic": "linear", "fl": fl, "p_vapour": 2e3}
        assert np.ndim(opening_for_flow(5e-3, 4e5, 3e5, 998.0, **valve)) == 0
        opening = opening_for_flow(np.full((3, 1), 5e-3), 4e5, [3e5, 3.5e5], 998.0, **valve)
        assert opening.shape == (3, 2)
        assert opening_for_flow(np.empty(0), 4e5, 3e5, 998.0, **valve).shape == (0,)


def test_recovery_factor_of_each_row():
    valve = {"kv_rated": 40.0, "characteristic": "linear", "p_vapour": 2e3}
    both = opening_for_flow(5e-3, 4e5, 1e5, 998.0, fl=[0.9, 0.5], **valve)
    each = [opening_for_flow(5e-3, 4e5, 1e5, 998.0, fl=fl, **valve) for fl in (0.9, 0.5)]
    assert_allclose(both, each, rtol=1e-15)


def test_bad_input():
    with pytest.raises(ValueError, match="fl is given but p_vapour is not"):
        opening_for_flow(5e-3, 4e5, 1e5, 998.0, kv_rated=40.0, characteristic="linear", fl=0.9)
    with pytest.raises(ValueError, match="needs a rangeability"):
        opening_for_flow(5e-3, 4e5, 1e5, 998.0, kv_rated=40.0, characteristic="equal_percentage")
    with pytest.raises(ValueError, match="kv_rated must be a positive number"):
        opening_for_flow(5e-3, 4e5, 1e5, 998.0, kv_rated=0.0, characteristic="linear")
