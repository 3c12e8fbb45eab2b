# SPDX-License-Identifier: BSD-3-Clause
"""Cells: numbers of every spelling, qualities of every historian, points of one tag."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sklvalve.recording import InputError
from sklvalve.recording.historian.clean import Points, join_points
from sklvalve.recording.historian.decimals import decimal_mark, looks_numeric, read_numbers
from sklvalve.recording.historian.quality import is_bad_text, is_uncertain_text, judge


def _mark(*cells, separator=";"):
    return decimal_mark([(cell, "here") for cell in cells], separator)


@pytest.mark.parametrize(
    ("cells", "mark"),
    [
        (("12,5",), ","),
        (("12.5",), "."),
        (("1.234,5",), ","),
        (("1,234.5",), "."),
        (("0,123",), ","),
        (("0.123",), "."),
        (("12",), "."),
        (("1e-3",), "."),
        (("1,5E-3",), ","),
        (("-3,25", "1.000"), ","),
    ],
)
def test_decimal_mark(cells, mark):
    found = _mark(*cells)
    assert (found.mark, found.assumed) == (mark, False)


def test_decimal_mark_that_nothing_tells_is_assumed():
    assert _mark("1,234", "5,678") == (",", True)
    assert _mark("1,234", "5,678", separator=",") == (".", True)


def test_both_marks_are_refused():
    with pytest.raises(InputError, match="decimal points and decimal commas in one file"):
        _mark("12,5", "12.5")


@pytest.mark.parametrize(
    ("cell", "mark", "value"),
    [
        ("1.234,5", ",", 1234.5),
        ("1,234.5", ".", 1234.5),
        ("1 234,5", ",", 1234.5),
        ("1\u00a0234,5", ",", 1234.5),
        ("1'234.5", ".", 1234.5),
        ("-,5", ",", -0.5),
        (".5", ".", 0.5),
        ("1,2E+3", ",", 1200.0),
        ("12,5 %", ",", 12.5),
        ("7.5 bar(g)", ".", 7.5),
        ("3 m³/h", ".", 3.0),
        ("1.234", ",", 1234.0),
        ("+4", ".", 4.0),
    ],
)
def test_number(cell, mark, value):
    numbers, texts = read_numbers([cell], mark)
    assert (numbers[0], texts) == (value, {})


@pytest.mark.parametrize(
    "cell", ["", "nan", "inf", "1_000", "Bad", "1.2.3", "12 apples", "--", "0x1F", "1e999"]
)
def test_no_number(cell):
    numbers, texts = read_numbers([cell], ".")
    assert np.isnan(numbers[0])
    assert texts == {0: cell}


@given(st.floats(allow_nan=False, allow_infinity=False, width=32), st.sampled_from(".,"))
def test_numbers_survive_being_written(value, mark):
    numbers, _ = read_numbers([repr(value).replace(".", mark)], mark)
    assert numbers[0] == value
    assert looks_numeric(f"{abs(value):.3f}")


@pytest.mark.parametrize(
    "text",
    [
        "Bad",
        "Bad Input",
        "I/O Timeout",
        "No Data",
        "[-11059] No Good Data For Calculation",
        "Pt Created",
        "#N/A",
        "Scan Off",
        "Comm Fail",
        "Over Range",
        "Not Connect",
        "Intf Shut",
        "Calc Failed",
        "---",
        "null",
        "NaN",
        "schlecht",
        "Fehler",
        "kein Wert",
        "błąd",
        "brak danych",
        "mauvaise",
        "sin datos",
        "Shutdown",
        "Invalid Float",
    ],
)
def test_bad_text(text):
    assert is_bad_text(text)
    assert is_bad_text(text.upper())


@pytest.mark.parametrize("text", ["AUTO", "Running", "Open", "Manual", "12", "Ein"])
def test_states_are_no_faults(text):
    assert not is_bad_text(text)
    assert not is_uncertain_text(text)


QUALITIES = {
    "words": (
        "Quality",
        {"Good": "good", "Bad": "bad", "Uncertain": "uncertain", "Questionable": "uncertain"},
    ),
    "german": ("Status", {"gut": "good", "schlecht": "bad", "unsicher": "uncertain"}),
    "polish": ("Jakość", {"dobra": "good", "zła": "bad", "niepewna": "uncertain"}),
    "OPC DA": ("Quality", {"192": "good", "216": "good", "64": "uncertain", "0": "bad", "24": "bad"}),
    "OPC UA": ("StatusCode", {"0": "good", str(0x80000000): "bad", str(0x40000000): "uncertain"}),
    "OPC UA, hexadecimal": ("StatusCode", {"0x00000000": "good", "0x80310000": "bad"}),
    "percent": ("Quality", {"100": "good", "0": "bad", "50": "uncertain"}),
    "status": ("Status", {"0": "good", "-254": "bad", "3": "bad"}),
    "good flag": ("IsGood", {"1": "good", "0": "bad"}),
    "fault flag": ("Questionable", {"0": "good", "1": "bad"}),
    "truth": ("Valid", {"True": "good", "False": "bad"}),
    "truth of a fault": ("IsBad", {"True": "bad", "False": "good"}),
    "with words": ("Quality", {"192 Good": "good", "No Good": "bad", "Good, Raw": "good"}),
}


@pytest.mark.parametrize(("name", "meaning"), QUALITIES.values(), ids=QUALITIES)
def test_quality(name, meaning):
    assert judge(list(meaning), name) == meaning


def test_flag_without_a_telling_name_is_good_where_it_is_frequent():
    assert judge(["0"] * 9 + ["1"], "Status") == {"0": "good", "1": "bad"}
    assert judge(["1"] * 9 + ["0"], "Status") == {"1": "good", "0": "bad"}


def _points(times, values):
    return Points("F", "", np.array(times, dtype=np.int64), np.array(values, dtype=float), rows=len(times))


def test_last_good_point_of_a_moment_stays():
    joined = join_points([_points([1, 2, 2, 2, 3, 4, 4], [1.0, 2.0, 5.0, np.nan, 3.0, 4.0, 4.0])])
    np.testing.assert_array_equal(joined.times, [1, 2, 3, 4])
    np.testing.assert_array_equal(joined.values, [1.0, 5.0, 3.0, 4.0])
    assert (joined.doubled, joined.contradicting, joined.out_of_order) == (3, 1, 0)


def test_points_out_of_order_are_put_in_order_and_counted():
    joined = join_points([_points([1, 3, 2, 4, 6, 5], [1.0, 3.0, 2.0, 4.0, 6.0, 5.0])])
    np.testing.assert_array_equal(joined.values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert joined.out_of_order == 2


def test_empty_parts_are_no_parts():
    joined = join_points([_points([], []), _points([5, 6], [1.0, 2.0]), _points([1], [0.0])])
    np.testing.assert_array_equal(joined.times, [1, 5, 6])
    assert len(join_points([_points([], [])]).times) == 0
