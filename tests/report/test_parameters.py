# SPDX-License-Identifier: BSD-3-Clause
import pytest

from sklvalve.report.parameters import parameters, shown_parameters


def _one(name, unit, value, ci95, flow_unit="m3/h"):
    effect = {"parameters": {name: {"value": value, "unit": unit, "ci95": ci95}}}
    return parameters(effect, {"fit": {"flow": {"unit": flow_unit}}})[0]


@pytest.mark.parametrize(
    ("name", "unit", "value", "ci95", "shown"),
    [
        ("width", "1", 0.031, [0.029, 0.033], ("play", "3.1 % of travel [2.9 to 3.3]")),
        ("fl", "1", 0.71, [0.68, 0.74], ("F_L", "0.71 [0.68 to 0.74]")),
        ("bias", "1", -0.02, None, ("offset", "-2 % of travel")),
        ("bias", "m3/s", 0.001, [0.0005, 0.0015], ("offset", "3.6 m3/h [1.8 to 5.4]")),
        ("leak_kv", "m3/h", 0.8, [0.7, 0.9], ("leak Kv", "0.8 m3/h [0.7 to 0.9]")),
        ("new_thing", "Pa", 1.0, [None, None], ("new thing", "1 Pa")),
        ("new_thing", "1", None, None, ("new thing", "unknown")),
    ],
)
def test_parameters_in_an_engineers_units(name, unit, value, ci95, shown):
    assert _one(name, unit, value, ci95) == shown


@pytest.mark.parametrize(
    ("ends", "ci95", "words"),
    [
        (["upper"], [0.0096, 1.0], "2.1 % of travel (0.96 or more, upper bound unknown)"),
        (["upper"], [0.0, 1.0], "2.1 % of travel (upper bound unknown)"),
        (["lower"], [0.002, 0.05], "2.1 % of travel (5 or less, lower bound unknown)"),
        (["lower", "upper"], [0.002, 1.0], "2.1 % of travel (bounds unknown)"),
        ([], [0.0096, 0.05], "2.1 % of travel [0.96 to 5]"),
    ],
)
def test_an_end_at_its_bound_is_unknown(ends, ci95, words):
    item = {"value": 0.0214, "unit": "1", "ci95": ci95, "unknown_ends": ends}
    (shown,) = shown_parameters({"parameters": {"stick": item}}, {})
    assert (shown.name, shown.words) == ("dead band plus stick band", words)
    assert shown.short.startswith("2.1 % of travel")
    assert ("unknown" in shown.short) == bool(ends)


def test_mass_flow_is_not_turned_into_volume():
    assert _one("bias", "kg/s", 1.0, None) == ("bias", "1 kg/s")
    assert _one("bias", "kg/s", 1.0, None, flow_unit="t/h") == ("offset", "3.6 t/h")


def test_effect_without_parameters_has_none_to_show():
    assert parameters({}, {}) == []


def _of(name, parameters_):
    effect = {"members": [{"name": name, "probability": 1.0}], "parameters": parameters_}
    return parameters(effect, {"fit": {}})


def test_what_only_an_equation_gives_a_meaning_is_left_out():
    play = {
        "width": {"value": 0.03, "unit": "1", "ci95": None},
        "overshoot": {"value": 0.1, "unit": "1", "ci95": [0.0, 0.2]},
        "first_side": {"value": -1.0, "unit": "1", "ci95": [-1.0, -1.0]},
    }
    assert _of("backlash", play) == [("play", "3 % of travel")]


@pytest.mark.parametrize(
    ("effect", "name", "unit", "value", "shown"),
    [
        ("slew_limit", "speed", "1/s", 0.021, ("largest speed", "2.1 %/s")),
        ("sedimentation", "rate", "1/h", 0.05, ("rate", "5 %/h")),
        ("cavitation", "loss", "1", 0.08, ("largest loss of capacity", "8 %")),
        ("line_loss", "loss", "1", 1.5, ("loss, as a multiple of the open valve's own,", "1.5")),
        ("wrong_characteristic", "slope", "1", 0.0, ("rangeability, as a multiple of the sheet's,", "1")),
        ("rod_bend", "begins", "1", 0.3, ("begins at", "30 % opening")),
    ],
)
def test_one_unit_for_one_thing(effect, name, unit, value, shown):
    assert _of(effect, {name: {"value": value, "unit": unit, "ci95": None}}) == [shown]
