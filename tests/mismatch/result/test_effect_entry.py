# SPDX-License-Identifier: BSD-3-Clause
"""Entries of diagnosis.json: recorded units, and ends of intervals that nothing was tried beyond."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch.effects.base import Quantity
from sklvalve.mismatch.effects.inlet_pressure_bias import InletPressureBias
from sklvalve.mismatch.loop.verdict import effect_of, grade_of
from sklvalve.mismatch.result.effect_entry import _in_units, _sentence, _unknown_ends
from sklvalve.recording import Recording, Valve

RECORDING = Recording.from_frame(
    {"time": np.arange(30.0), "P1": np.linspace(4.0, 5.0, 30)},
    Valve.from_dict({"recording": {"p1": {"column": "P1", "unit": "bar", "gauge": True}}}),
)


def test_a_pressure_is_in_the_unit_of_the_recorded_pressures():
    (quantity,) = InletPressureBias.parameters
    told = _in_units(quantity, -5e3, (-7e3, -3e3), RECORDING)
    assert (told["value"], told["unit"]) == (pytest.approx(-0.05), "bar")
    assert told["ci95"] == pytest.approx([-0.07, -0.03])
    who = SimpleNamespace(effect=InletPressureBias())
    words = _sentence(who, {"bias": -5e3}, (quantity,), RECORDING)
    assert words == "The recorded pressures are off by -0.05 bar against the drop over the valve."


@pytest.mark.parametrize(
    ("quantity", "ends", "unknown"),
    [
        (Quantity("width", "1", 0.002, 0.4, (0.05,), log=True), (0.002, 0.1), ["lower"]),
        (Quantity("width", "1", 0.002, 0.4, (0.05,), log=True), (0.01, 0.4), ["upper"]),
        (Quantity("width", "1", 0.002, 0.4, (0.05,), log=True), (0.002, 0.4), ["lower", "upper"]),
        # no effect, and nothing left, are ends of their own
        (Quantity("leak", "m3/h", 0.0, 1.0, (0.3,)), (0.0, 0.5), []),
        (Quantity("free", "1", 0.0, 1.0, (0.3,), null=1.0), (0.0, 1.0), []),
        (Quantity("leak", "m3/h", 0.0, 1.0, (0.3,)), None, []),
    ],
)
def test_an_end_at_the_bound_is_not_known(quantity, ends, unknown):
    assert _unknown_ends(quantity, ends) == unknown


def _result(turns=12, evidence=40.0):
    return SimpleNamespace(turns=turns, evidence=evidence)


def _entry(interval):
    """The effect of a loop whose band lies in an interval, by a command that moves 5 %."""
    sticking = SimpleNamespace(
        shares={"stiction": 1.0},
        stick=0.0214,
        slip=0.01,
        stick_interval=interval,
        slip_interval=(0.001, interval[1]),
    )
    return effect_of(sticking, SimpleNamespace(span=0.05), {})


def test_a_loop_says_which_bound_of_its_band_is_unknown():
    entry = _entry((0.00964, 1.0))
    assert entry["parameters"]["stick"]["unknown_ends"] == ["upper"]
    assert entry["parameters"]["slip"]["unknown_ends"] == ["upper"]
    assert "turned by 2.1 % of its range (95 %: 0.96 % or more), and then jumps by 1 %." in entry["sentence"]
    entry = _entry((0.17 * 0.05, 0.04))
    assert entry["parameters"]["stick"]["unknown_ends"] == ["lower"]
    assert "(95 %: 4 % or less)" in entry["sentence"]
    entry = _entry((0.012, 0.04))
    assert entry["parameters"]["stick"]["unknown_ends"] == []
    assert "(95 %: 1.2 % to 4 %)" in entry["sentence"]


@pytest.mark.parametrize(
    ("turns", "evidence", "helps", "level", "words"),
    [
        (12, 40.0, True, "strong", "far better than the command itself, over 12 turns"),
        (8, 40.0, True, "moderate", "The command makes only 8 turns."),
        (1, 40.0, True, "weak", "The command makes only 1 turn."),
        (12, 20.0, True, "moderate", "only somewhat better"),
        (12, 40.0, False, "moderate", "does not lower the error on forecast rows"),
    ],
)
def test_the_grade_of_a_loop_says_what_holds_it_back(turns, evidence, helps, level, words):
    grade = grade_of(_result(turns, evidence), helps)
    assert grade["level"] == level
    assert words in grade["reason"]
    assert "nats" not in grade["reason"]
