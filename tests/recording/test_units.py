# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.recording import InputError
from sklvalve.recording.signal import ROLES, Signal
from sklvalve.recording.units import SI_UNITS, UNITS, from_si, quantity_of, to_si

ALL = [(unit, quantity) for quantity, units in UNITS.items() for unit in units]
DESIGNED = [
    *(
        "1",
        "%",
        "Pa",
        "kPa",
        "MPa",
        "bar",
        "mbar",
        "psi",
        "cmH2O",
        "mmHg",
        "degC",
        "degF",
        "K",
        "m3/h",
        "m3/s",
    ),
    *("l/min", "l/s", "cm3/s", "gpm", "t/h", "kg/h", "kg/s", "mm", "m", "s", "min", "h"),
]


def test_units_are_those_of_the_design():
    assert sorted(unit for unit, _ in ALL) == sorted(DESIGNED)


@pytest.mark.parametrize(
    ("value", "unit", "quantity", "expected"),
    [
        (46.5, "%", "fraction", 0.465),
        (1.0, "psi", "pressure", 6894.757),
        (1.0, "mmHg", "pressure", 133.322387415),
        (1000.0, "cmH2O", "pressure", 98066.5),
        (1013.25, "mbar", "pressure", 101325.0),
        (212.0, "degF", "temperature", 373.15),
        (-40.0, "degC", "temperature", 233.15),
        (3.6, "m3/h", "volume flow", 1e-3),
        (60.0, "l/min", "volume flow", 1e-3),
        (15850.323, "gpm", "volume flow", 1.0),
        (3.6, "t/h", "mass flow", 1.0),
        (3600.0, "kg/h", "mass flow", 1.0),
        (50.0, "mm", "length", 0.05),
        (2.0, "h", "time", 7200.0),
    ],
)
def test_known_conversions(value, unit, quantity, expected):
    assert to_si(value, unit, quantity) == pytest.approx(expected, rel=1e-7)


@given(value=st.floats(-1e6, 1e6), place=st.integers(0, len(ALL) - 1), gauge=st.booleans())
@settings(deadline=None, max_examples=50)
def test_there_and_back(value, place, gauge):
    unit, quantity = ALL[place]
    gauge = gauge and quantity == "pressure"
    back = from_si(to_si(value, unit, quantity, gauge=gauge), unit, quantity, gauge=gauge)
    # an atmosphere added and taken away again costs digits of small values in large units
    assert back == pytest.approx(value, rel=1e-12, abs=1e-9)


def test_gauge_adds_one_atmosphere_and_keeps_gaps():
    np.testing.assert_allclose(
        to_si([0.0, np.nan, 1.0], "bar", "pressure", gauge=True), [101325.0, np.nan, 201325.0]
    )


def test_si_units_convert_to_themselves():
    for quantity, unit in SI_UNITS.items():
        assert to_si(2.5, unit, quantity) == 2.5
        assert quantity_of(unit) == quantity


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("kpa", "pressure"), ["'kpa'", "pressure", "did you mean 'kPa'?"]),
        (("furlong", "length"), ["'furlong'", "m, mm"]),
        (("kPa", "temperature"), ["'kPa'", "temperature", "degC"]),
        (("kPa", "presure"), ["'presure'", "did you mean 'pressure'?"]),
    ],
)
def test_unknown_unit_names_the_known_ones(arguments, words):
    with pytest.raises(InputError) as caught:
        to_si(1.0, *arguments)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_gauge_belongs_to_pressure():
    with pytest.raises(InputError, match="gauge belongs to pressures only"):
        to_si(1.0, "K", "temperature", gauge=True)


@given(value=st.floats(-0.5, 1.5), sense=st.sampled_from(["opening", "closing"]), by_length=st.booleans())
@settings(deadline=None, max_examples=50)
def test_position_there_and_back(value, sense, by_length):
    signal = Signal("X", None, "mm" if by_length else "%", sense=sense, travel=0.0381 if by_length else None)
    assert signal.to_si(signal.from_si([value]))[0] == pytest.approx(value, abs=1e-12)
    assert signal.slope == pytest.approx(1.0 / 38.1 if by_length else 0.01, rel=1e-12)


def test_every_role_has_known_quantities():
    assert all(set(quantities) <= set(UNITS) for quantities in ROLES.values())
