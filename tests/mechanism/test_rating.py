# SPDX-License-Identifier: BSD-3-Clause
"""The compiled pass against the functions it fuses, and what it does with odd rows, types and shapes."""

import subprocess
import sys
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra.numpy import mutually_broadcastable_shapes

from sklvalve.mechanism import (
    Fluid,
    ValidityWarning,
    choked_pressure_drop,
    fluid_from,
    liquid_flow,
    rate_liquid,
    water_density,
    water_kinematic_viscosity,
    water_vapour_pressure,
)
from sklvalve.mechanism.viscosity import valve_reynolds_number

TOLERANCE = 1e-12


def duties(n=20_000, seed=0):
    """Random duties of many valves, a fifth of them in reverse; none within 2 % of boiling at the inlet.

    Nearer to boiling the flow magnifies the rounding of the vapour pressure without bound.
    """
    rng = np.random.default_rng(seed)
    size = rng.uniform(0.015, 0.3, n)
    kv = rng.uniform(0.0, 0.04, n) * (1e3 * size) ** 2 * rng.choice([1e-4, 1e-2, 1.0], n)
    temperature = rng.uniform(274.0, 640.0, n)
    p_vapour = water_vapour_pressure(temperature)
    high = 1.02 * p_vapour + 10.0 ** rng.uniform(3.0, 6.5, n)
    low = high - (high - 0.3 * p_vapour) * rng.uniform(0.0, 1.0, n) ** 2
    forward = rng.random(n) < 0.8
    return {
        "kv": kv,
        "p1": np.where(forward, high, low),
        "p2": np.where(forward, low, high),
        "temperature": temperature,
        "fl": rng.uniform(0.3, 1.0, n),
        "fd": rng.uniform(0.05, 1.0, n),
        "kv_rated": kv * rng.uniform(1.0, 20.0, n),
        "nominal_size": size,
        "inlet_pipe": size * rng.uniform(1.0, 2.0, n),
        "outlet_pipe": size * rng.uniform(1.0, 2.0, n),
    }


def composed(case, fluid="water", **more):
    """The elementary functions one after the other."""
    case = dict(case)
    temperature = case.pop("temperature")
    fluid = fluid_from(fluid)
    if "fl" in case:
        case |= {"p_vapour": fluid.vapour_pressure(temperature, warn=False)}
    if "fd" in case:
        case |= {"viscosity": fluid.kinematic_viscosity(temperature, warn=False)}
    return liquid_flow(density=fluid.density(temperature, warn=False), warn=False, **case, **more)


def thick(times):
    """Water, but for a viscosity so many times as great."""

    def viscosity(temperature):
        return times * water_kinematic_viscosity(temperature, warn=False)

    return fluid_from("thick", water_density, viscosity, water_vapour_pressure, 22.064e6)


BARE = ["kv", "p1", "p2", "temperature"]
CHOKING = [*BARE, "fl"]
REDUCED = [*CHOKING, "nominal_size", "inlet_pipe", "outlet_pipe"]
VISCOUS = [*CHOKING, "fd", "kv_rated", "nominal_size"]
ALL = [*VISCOUS, "inlet_pipe", "outlet_pipe"]


@pytest.mark.parametrize(
    "names",
    [BARE, CHOKING, REDUCED, [*CHOKING, "nominal_size", "outlet_pipe"], VISCOUS, ALL, ALL[:6] + ALL[7:]],
)
def test_equals_the_functions_it_fuses(names):
    case = {name: value for name, value in duties().items() if name in names}
    expected = composed(case)
    assert np.isfinite(expected).mean() > 0.99
    np.testing.assert_allclose(rate_liquid(**case, warn=False), expected, rtol=TOLERANCE)


@pytest.mark.parametrize("names", [VISCOUS, ALL])
@pytest.mark.parametrize("strict", [False, True])
@pytest.mark.parametrize("times", [1e2, 1e4, 1e7])
def test_equals_them_in_flow_that_is_not_turbulent(times, strict, names):
    case = {name: value for name, value in duties(seed=1).items() if name in names}
    expected = composed(case, thick(times), strict=strict)
    assert np.isfinite(expected).mean() > 0.9
    turbulent = composed({name: case[name] for name in case if name not in ("fd", "kv_rated")})
    assert np.nanmean(np.abs(expected) < 0.9 * np.abs(turbulent)) > 0.3
    found = rate_liquid(**case, fluid=thick(times), strict=strict, warn=False)
    np.testing.assert_allclose(found, expected, rtol=TOLERANCE)


def test_outputs_are_what_their_names_say():
    case = duties(2_000)
    names = ["flow", "mass_flow", "density", "p_vapour", "viscosity", "dp_choked", "fr"]
    found = rate_liquid(**case, outputs=names, warn=False)
    assert list(found) == names
    temperature, fl = case["temperature"], case["fl"]
    np.testing.assert_allclose(found["density"], water_density(temperature), rtol=TOLERANCE)
    np.testing.assert_allclose(found["p_vapour"], water_vapour_pressure(temperature), rtol=TOLERANCE)
    viscosity = water_kinematic_viscosity(temperature, warn=False)
    np.testing.assert_allclose(found["viscosity"], viscosity, rtol=TOLERANCE)
    np.testing.assert_allclose(found["mass_flow"], found["flow"] * found["density"], rtol=TOLERANCE)
    plain = {name: case[name] for name in CHOKING}
    onset = rate_liquid(**plain, outputs="dp_choked")
    upstream = np.maximum(case["p1"], case["p2"])
    expected = choked_pressure_drop(upstream, found["p_vapour"], 22.064e6, fl)
    np.testing.assert_allclose(onset, expected, rtol=TOLERANCE)
    piped = {name: case[name] for name in REDUCED}
    moving = found["flow"] != 0.0
    ratio = (found["flow"] / rate_liquid(**piped, warn=False))[moving]
    np.testing.assert_allclose(found["fr"][moving], ratio, rtol=TOLERANCE)


def test_reynolds_output_is_that_of_the_flow():
    case = {name: duties(2_000)[name] for name in VISCOUS}
    found = rate_liquid(**case, outputs=("flow", "reynolds", "viscosity"), warn=False)
    size, fl, fd = case["nominal_size"], case["fl"], case["fd"]
    expected = valve_reynolds_number(
        found["flow"], case["kv"], found["viscosity"], fl=fl, fd=fd, inlet_pipe=size
    )
    np.testing.assert_allclose(found["reynolds"], expected, rtol=TOLERANCE)


@settings(max_examples=50, deadline=None)
@given(shapes=mutually_broadcastable_shapes(num_shapes=5, max_dims=4, max_side=5, min_side=0))
def test_shapes_broadcast_as_those_of_numpy(shapes):
    rng = np.random.default_rng(3)
    ranges = {"kv": (1, 100), "p1": (4e5, 8e5), "p2": (1e5, 6e5), "temperature": (280, 400), "fl": (0.4, 1.0)}
    pairs = zip(ranges.items(), shapes.input_shapes, strict=True)
    case = {name: rng.uniform(*ends, shape) for (name, ends), shape in pairs}
    found = rate_liquid(**case)
    assert np.shape(found) == shapes.result_shape
    np.testing.assert_allclose(found, composed(case), rtol=TOLERANCE)


def test_rows_of_any_layout_are_the_same_rows():
    case = {name: duties(1_000)[name] for name in CHOKING}
    expected = rate_liquid(**case)
    matrix = np.column_stack(list(case.values()))
    columns = dict(zip(case, matrix.T, strict=True))
    np.testing.assert_array_equal(rate_liquid(**columns), expected)
    backward = {name: np.ascontiguousarray(value[::-1])[::-1] for name, value in case.items()}
    np.testing.assert_array_equal(rate_liquid(**backward), expected)
    grid = {name: np.asfortranarray(value.reshape(20, 50)) for name, value in case.items()}
    np.testing.assert_array_equal(rate_liquid(**grid), expected.reshape(20, 50))
    locked = {name: np.frombuffer(value.tobytes()) for name, value in case.items()}
    np.testing.assert_array_equal(rate_liquid(**locked), expected)
    np.testing.assert_array_equal(rate_liquid(**{k: v.tolist() for k, v in case.items()}), expected)


def test_single_precision_is_computed_in_double():
    case = {name: duties(500)[name].astype(np.float32) for name in CHOKING}
    found = rate_liquid(**case)
    assert found.dtype == np.float64
    double = {name: value.astype(float) for name, value in case.items()}
    np.testing.assert_array_equal(found, rate_liquid(**double))


def test_one_row_is_a_float_and_none_is_empty():
    assert isinstance(rate_liquid(40.0, 6e5, 2e5, 293.15), float)
    assert rate_liquid(40.0, 6e5, [], 293.15).shape == (0,)
    assert rate_liquid(40.0, 6e5, 2e5) == rate_liquid(40.0, 6e5, 2e5, 293.15)


@pytest.mark.parametrize("n", [1, 255, 256, 257, 100_003])
def test_threads_do_not_change_a_digit(n):
    case = {name: duties(n, seed=n)[name] for name in VISCOUS}
    alone = rate_liquid(**case, n_jobs=1, warn=False)
    np.testing.assert_array_equal(rate_liquid(**case, n_jobs=3, warn=False), alone)
    # each row on its own, wherever in a block it lies
    assert rate_liquid(**{name: value[-1] for name, value in case.items()}, warn=False) == alone[-1]


@pytest.mark.parametrize("name", ALL)
def test_nan_goes_through_and_stays_in_its_row(name):
    case = duties(300, seed=4)
    case["kv"] += 1e-3
    whole = rate_liquid(**case, warn=False)
    case[name] = case[name].copy()
    case[name][7] = np.nan
    found = rate_liquid(**case, warn=False)
    assert np.isnan(found[7])
    np.testing.assert_array_equal(np.delete(found, 7), np.delete(whole, 7))


ODD = {
    "kv": [-1.0, 0.0, 50.0],
    "p1": [-1e5, 0.0, 1e5, 5e5],
    "p2": [0.0, 1e5, 5e5],
    "temperature": [-5.0, 0.0, 5.0, 200.0, 273.15, 372.0, 430.0, 647.096, 648.0],
    "fl": [-0.9, 0.0, 0.9],
    "fd": [-0.3, 0.3],
    "kv_rated": [-60.0, 0.0, 60.0],
    "nominal_size": [-0.05, 0.0, 0.05],
    "inlet_pipe": [0.0, 0.1],
    "outlet_pipe": [-0.05, 0.02, 0.05],
}


POSITIVE = ["fl", "fd", "kv_rated", "nominal_size", "inlet_pipe", "outlet_pipe"]


@pytest.mark.parametrize("names", [BARE, CHOKING, REDUCED, VISCOUS, ALL])
@pytest.mark.parametrize("strict", [False, True])
def test_odd_rows_have_the_answer_of_the_functions(names, strict):
    case = {name: ODD[name] for name in ODD if name in names}
    grid = dict(zip(case, np.meshgrid(*case.values(), indexing="ij"), strict=True))
    with np.errstate(all="ignore"):
        expected = composed(grid, strict=strict)
    if names == VISCOUS:
        # even where, by the letter, the rated kv would only choose the kind of trim
        expected = np.where((grid["kv_rated"] > 0.0) | (expected == 0.0), expected, np.nan)
    assert np.isnan(expected).any()
    np.testing.assert_allclose(rate_liquid(**grid, strict=strict, warn=False), expected, rtol=TOLERANCE)


@pytest.mark.parametrize("name", ["p1", "p2", *POSITIVE])
def test_a_datum_that_cannot_be_is_counted_and_gives_no_flow(name):
    case = {key: value[:600] for key, value in duties(seed=5).items()}
    case["kv"] += 1e-3
    names = ["flow", "mass_flow", "reynolds", "fr"]
    whole = rate_liquid(**case, outputs=names, warn=False)
    case[name] = case[name].copy()
    case[name][[7, 300]] *= -1.0
    if name in POSITIVE:
        case[name][300] = 0.0
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = rate_liquid(**case, outputs=names)
    told = [str(warning.message).split(" (")[0] for warning in caught]
    assert "rate_liquid: 2 of 600 rows hold what cannot be" in told
    assert not any("no flow that satisfies" in text for text in told)
    for output in names:
        assert np.isnan(found[output][[7, 300]]).all()
        np.testing.assert_array_equal(np.delete(found[output], [7, 300]), np.delete(whole[output], [7, 300]))


@pytest.mark.parametrize("name", ["p1", "p2", *POSITIVE])
def test_a_datum_that_cannot_be_is_counted_in_every_block(name):
    case = {key: value[0] for key, value in duties(seed=5).items()}
    case |= {"kv": np.full(700, 0.1), "temperature": 300.0, name: -case[name]}
    with pytest.warns(ValidityWarning, match="700 of 700 rows hold what cannot be"):
        assert np.isnan(rate_liquid(**case)).all()


@pytest.mark.parametrize("kv_rated", [np.nan, -10.0])
def test_no_rated_kv_is_no_reduced_trim(kv_rated):
    small = {"fl": 0.9, "fd": 0.4, "nominal_size": 0.05, "strict": True, "warn": False}
    assert np.isnan(rate_liquid(10.0, 6e5, 4e5, 293.15, kv_rated=kv_rated, **small))
    assert np.isnan(rate_liquid(10.0, np.inf, 4e5, 293.15, kv_rated=kv_rated, **small))


@pytest.mark.parametrize("strict", [False, True])
def test_an_endless_reynolds_number_is_turbulent(strict):
    valve = {"fl": 0.9, "nominal_size": 0.05, "inlet_pipe": 0.05, "strict": strict}
    found = rate_liquid(10.0, 6e5, 4e5, 293.15, fd=np.inf, **valve)
    assert found == rate_liquid(10.0, 6e5, 4e5, 293.15, **valve)


def test_a_datum_that_is_not_used_may_be_anything():
    odd = {"kv_rated": -1.0, "nominal_size": 0.0}
    assert rate_liquid(10.0, 6e5, 4e5, 293.15, fl=0.9, **odd) == rate_liquid(10.0, 6e5, 4e5, 293.15, fl=0.9)


@pytest.mark.parametrize(("p_vapour", "p_critical"), [(-1.0, 22e6), (3e7, 22e6), (-1.0, -1.0), (0.0, 0.0)])
def test_a_vapour_pressure_that_cannot_be_is_counted(p_vapour, p_critical):
    odd = Fluid("odd", {"density": 1e3, "vapour_pressure": p_vapour}, p_critical)
    with pytest.warns(ValidityWarning, match="700 of 700 rows hold what cannot be"):
        assert np.isnan(rate_liquid(np.full(700, 10.0), 6e5, 4e5, fl=0.9, fluid=odd)).all()


def test_a_negative_style_modifier_gives_no_flow():
    with pytest.warns(ValidityWarning, match="1 of 1 rows hold what cannot be"):
        found = rate_liquid(
            10.0, 6e5, 4e5, 293.15, fl=0.9, fd=-0.4, nominal_size=0.05, outputs=["flow", "fr"]
        )
    assert np.isnan(found["flow"])
    assert np.isnan(found["fr"])


def test_an_opening_of_zero_is_no_missing_rated_kv():
    small = {"fl": 0.9, "fd": 0.4, "nominal_size": 0.05}
    flow = rate_liquid([0.0, -1.0, 1.0], 6e5, 4e5, 293.15, warn=False, **small)
    np.testing.assert_allclose(flow, flow[2] * np.array([0.0, -1.0, 1.0]), rtol=TOLERANCE)


@pytest.mark.parametrize("viscous", [False, True])
@pytest.mark.parametrize("strict", [False, True])
def test_an_endless_pressure_gives_an_endless_flow(strict, viscous):
    more = {"fd": 0.4, "nominal_size": 0.05} if viscous else {}
    p1, p2 = np.array([np.inf, 1e5, np.inf]), np.array([1e5, np.inf, np.inf])
    flow = rate_liquid(10.0, p1, p2, 293.15, fl=0.9, strict=strict, **more)
    np.testing.assert_array_equal(flow, [np.inf, -np.inf, np.nan])


def test_one_warning_for_each_kind_of_trouble_with_its_count():
    case = {"kv": [10.0, -1.0, 10.0, 10.0, 10.0], "p1": [5e5, 5e5, 5e5, 5e5, 1e4], "p2": 1e3}
    case["temperature"] = [293.15, 293.15, 700.0, np.nan, 363.15]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = rate_liquid(**case, fl=0.9)
    np.testing.assert_array_equal(np.isnan(found), [False, False, True, True, True])
    told = sorted(str(warning.message).split(";")[0] for warning in caught)
    assert all(warning.category is ValidityWarning for warning in caught)
    assert told == [
        "rate_liquid: 1 of 5 rows have a negative kv",
        "rate_liquid: 1 of 5 rows have a temperature outside 273.15 to 647.096 K (is it in kelvin?)",
        "rate_liquid: 1 of 5 rows have liquid at or below its vapour pressure before the valve",
    ]


def test_counts_are_those_of_all_threads():
    with pytest.warns(ValidityWarning, match="100000 of 100000 rows have a negative kv"):
        rate_liquid(np.full(100_000, -1.0), 5e5, 1e5, 293.15, n_jobs=2)


def test_a_viscous_liquid_without_vapour_pressure_does_not_choke():
    oil = Fluid("oil", {"density": 870.0, "kinematic_viscosity": 1e-4})
    valve = {"fl": 0.9, "fd": 0.46, "nominal_size": 0.1}
    found = rate_liquid(60.0, 6e5, [5e5, 1e5], fluid=oil, **valve)
    expected = liquid_flow(60.0, 6e5, np.array([5e5, 1e5]), 870.0, viscosity=1e-4, **valve)
    np.testing.assert_allclose(found, expected, rtol=TOLERANCE)


def test_what_is_missing_is_said():
    with pytest.raises(ValueError, match="unknown output 'speed'"):
        rate_liquid(1.0, 2e5, 1e5, outputs="speed")
    with pytest.raises(ValueError, match="'fr' needs fd"):
        rate_liquid(1.0, 2e5, 1e5, outputs=["flow", "fr"])
    with pytest.raises(ValueError, match="fl and nominal_size not"):
        rate_liquid(1.0, 2e5, 1e5, fd=0.4)
    with pytest.raises(ValueError, match="a pipe is given but nominal_size is not"):
        rate_liquid(1.0, 2e5, 1e5, inlet_pipe=0.1)
    with pytest.raises(ValueError, match="no vapour_pressure"):
        rate_liquid(1.0, 2e5, 1e5, fl=0.9, fluid=Fluid("oil", {"density": 870.0}))
    with pytest.raises(ValueError, match="no critical_pressure"):
        rate_liquid(1.0, 2e5, 1e5, fl=0.9, fluid=Fluid("oil", {"density": 870.0, "vapour_pressure": 10.0}))
    with pytest.raises(ValueError, match="n_jobs"):
        rate_liquid(1.0, 2e5, 1e5, n_jobs=0)
    with pytest.raises(ValueError, match="broadcast"):
        rate_liquid([1.0, 2.0], 2e5, [1e5, 1e5, 1e5])


def test_importing_the_mechanism_does_not_import_the_compiler():
    code = "import sys, sklvalve.mechanism; print('numba' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False"
