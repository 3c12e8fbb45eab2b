# SPDX-License-Identifier: BSD-3-Clause
"""A learnt rest in words: a formula that holds it, and its course over the signal that tells most of it."""

import numpy as np
import pytest

from sklvalve.lssvm import LSSVMRegressor
from sklvalve.mismatch.describe.describing import described, scales_of
from sklvalve.recording import Recording, Valve

SPAN = 1e-3


def learnt(rest, **inputs):
    """The plain data of an LS-SVM fitted to a rest [SI] of flow."""
    X = np.column_stack(list(inputs.values()))
    centre, scale = X.mean(axis=0), X.std(axis=0)
    Z = (X - centre) / scale
    regressor = LSSVMRegressor(gamma=8.0, C=1e4).fit(Z, rest / SPAN)
    return {
        "channel": "flow",
        "inputs": tuple(inputs),
        "centre": centre,
        "scale": scale,
        "support": Z,
        "coefficients": regressor.dual_coef_,
        "intercept": regressor.intercept_,
        "gamma": 8.0,
        "span": SPAN,
    }


OPENING = np.linspace(0.1, 0.9, 240)
CASES = {
    "a bend": (np.maximum(OPENING - 0.5, 0.0), "max(0, opening [%] - 50)"),
    "a step": ((OPENING > 0.5) + 0.0, "(opening [%] > 50)"),
    "a line": (OPENING, "= -"),
    "a wave": (np.sin(2.0 * np.pi * OPENING / 0.25), "sin(360 deg (opening [%] - "),
    "a bump": (np.exp(-(((OPENING - 0.5) / 0.096) ** 2)), "exp(-((opening [%] - 50) / 9.6)^2)"),
}


@pytest.mark.parametrize("case", CASES)
def test_a_shape_is_said_by_its_own_formula(case):
    rest, words = CASES[case]
    told = described(learnt(1e-4 * rest - 2e-5, opening=OPENING), 3600.0, "m3/h")
    assert told["formula"].startswith("flow residual [m3/h] = ")
    assert words in told["formula"]
    assert told["share"] > 0.9
    curve = told["curve"]
    assert (curve["signal"], curve["unit"]) == ("opening", "%")
    # a step is learnt as a steep slope; elsewhere the course is the rest itself
    expected = np.interp(curve["at"], 100.0 * OPENING, 3600.0 * (1e-4 * rest - 2e-5))
    assert np.median(np.abs(expected - curve["rest"])) < 0.01


def test_the_signal_that_tells_most_is_the_one_shown():
    rng = np.random.default_rng(0)
    temperature = 300.0 + 20.0 * rng.uniform(size=240)
    rest = 1e-5 * (temperature - 310.0)
    told = described(learnt(rest, opening=OPENING, temperature=temperature), 3600.0, "m3/h")
    assert told["curve"]["signal"] == "temperature"
    assert 26.8 < min(told["curve"]["at"]) < max(told["curve"]["at"]) < 46.9
    assert "temperature [degC]" in told["formula"]
    assert "opening" not in told["formula"]


def test_a_product_of_two_signals():
    rng = np.random.default_rng(0)
    dp = 1.0 + rng.uniform(size=240)
    rest = 1e-4 * OPENING * (dp - 1.5)
    told = described(learnt(rest, opening=OPENING, dp=dp), 3600.0, "m3/h")
    assert "(opening [%] - 50) (dp [kPa] - 153)" in told["formula"]
    assert told["share"] > 0.9


def test_what_no_short_formula_holds_is_not_given_one():
    rest = 1e-4 * np.random.default_rng(0).normal(size=240)
    rough = learnt(rest, opening=OPENING) | {"gamma": 800.0}
    told = described(rough, 3600.0, "m3/h")
    assert told["formula"] is None
    assert told["share"] < 0.6
    assert len(told["curve"]["at"]) == len(told["curve"]["rest"]) == 40


def test_signals_are_shown_in_recorded_units():
    time = np.arange(240.0)
    dp = 1.0 + np.random.default_rng(0).uniform(size=240)
    valve = Valve.from_dict(
        {
            "recording": {
                "p1": {"column": "P1", "unit": "psi", "gauge": False},
                "temperature": {"column": "T", "unit": "degF"},
            }
        }
    )
    scales = scales_of(Recording.from_frame({"time": time, "P1": 100.0 + time, "T": 70.0 + time}, valve))
    told = described(learnt(1e-4 * (dp - 1.5), opening=OPENING, dp=dp), 3600.0, "m3/h", scales)
    assert (told["curve"]["signal"], told["curve"]["unit"]) == ("dp", "psi")
    assert 14.5 < min(told["curve"]["at"]) < max(told["curve"]["at"]) < 29.1
    factor, offset, unit = scales["temperature"]
    assert unit == "degF"
    assert factor * 310.928 + offset == pytest.approx(100.0, abs=0.01)
