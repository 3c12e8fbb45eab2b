# SPDX-License-Identifier: BSD-3-Clause
"""What might have gone unnoticed, in words."""

from types import SimpleNamespace

import pytest

from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.report import to_markdown, to_text
from sklvalve.report.html import render
from sklvalve.report.unnoticed import UNNOTICED, unnoticed


def told(name, parameter, unit, low, high):
    limit = {"name": name, "form": name, "parameter": parameter, "unit": unit, "low": low, "high": high}
    return [each.words for each in unnoticed(diagnosis([limit]))]


def diagnosis(limits):
    return {
        "verdict": "no_mismatch",
        "mismatch": {"detected": False, "p_value": 0.43, "alpha": 0.01},
        "fit": {"flow": {"unit": "m3/h"}},
        "effects": [],
        "units": {"p1": "bar", "flow": "m3/h"},
        "detection_limits": limits,
    }


@pytest.mark.parametrize(
    ("limit", "words"),
    [
        (("backlash", "width", "1", None, 0.0123), "backlash up to 1.2 % of travel (play)"),
        (
            ("flow_meter_bias", "bias", "m3/s", -0.001, 0.002),
            "a shifted zero of the flow meter from -3.6 to 7.2 m3/h (offset)",
        ),
        (
            ("flow_meter_drift", "drift", "m3/s/h", -0.001, 0.002),
            "a drift of the flow meter from -3.6 to 7.2 m3/h per hour (drift)",
        ),
        (
            ("inlet_pressure_bias", "bias", "Pa", -1000.0, None),
            "a shifted zero of the inlet pressure sensor from -0.01 bar on (bias)",
        ),
        (("choked_flow", "fl", "1", 0.446, None), "choked flow from 0.45 on (F_L)"),
        (
            ("flow_inertia", "length_over_area", "1/m", None, None),
            "at any size inertia of the liquid in the line",
        ),
    ],
)
def test_an_end_that_nothing_is_noticed_beyond_is_left_out(limit, words):
    assert told(*limit) == [words]


def test_forms_of_one_effect_are_one_and_blocks_come_in_their_order():
    limits = [
        {
            "name": "sensor_lag",
            "form": "sensor_lag",
            "parameter": "lag",
            "unit": "s",
            "low": None,
            "high": 6.0,
        },
        {
            "name": "backlash",
            "form": "backlash",
            "parameter": "width",
            "unit": "1",
            "low": None,
            "high": 0.01,
        },
        {"name": "backlash", "form": "other", "parameter": "width", "unit": "1", "low": None, "high": 0.3},
        {"name": "backlash", "form": "third", "parameter": "share", "unit": "1", "low": 0.5, "high": None},
    ]
    assert unnoticed(diagnosis(limits)) == [
        (
            "In the valve",
            [("backlash", "up to 30 % of travel", "play"), ("backlash", "from 50 % on", "air that passes")],
        ),
        ("In the measurement", [("a slow sensor", "up to 6 s", "lag")]),
    ]


def test_a_scale_that_falls_turns_the_range_round():
    class Stretched(Effect):
        name = key = "stretched_for_a_test"
        block = "valve"
        parameters = (
            Quantity(
                "ratio", "1", 1.02, 2.0, (1.2,), null=1.0, shown=Shown("time", "s", lambda v: 1 / (v - 0.2))
            ),
        )

    # kept: a class that is gone is known no more
    assert Stretched.name
    assert told("stretched_for_a_test", "ratio", "1", None, 1.2) == [
        "stretched for a test from 1 s on (time)"
    ]


def test_a_name_that_is_known_nowhere_is_left_out():
    assert told("<b>nobody</b>", "size", "1", None, 1.0) == []


def test_text_markdown_and_page_say_it():
    d = diagnosis(
        [
            {
                "name": "backlash",
                "form": "backlash",
                "parameter": "width",
                "unit": "1",
                "low": None,
                "high": 0.01,
            }
        ]
    )
    text = " ".join(to_text(d).split())
    assert f"Unnoticed {UNNOTICED} In the valve: backlash up to 1 % of travel (play)." in text
    assert "What might have gone unnoticed is listed below." in text
    assert "- In the valve: backlash up to 1 % of travel (play)." in to_markdown(d)
    assert "Unnoticed" not in to_text(diagnosis([]))

    page = render(SimpleNamespace(traces={}, to_dict=lambda: d))
    assert "What might have gone unnoticed" in page
