# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the calibration in words: shares in percent, those shown that a person asks for."""

from sklvalve.report.calibration import HEAD, parameter_words, then_and_now, worth_showing
from tests.report.examples import SINCE_HISTORY


def test_cells_are_in_the_units_of_a_plant():
    rows = {row.name: row.cells for row in then_and_now(SINCE_HISTORY)}
    assert rows["capacity"] == ("rated capacity Kv [m3/h]", "40", "39 to 41", "40.5", "0.98")
    zero = ("zero of the position sensor [% of travel]", "0.1", "-0.1 to 0.3", "0.2", "0.98")
    assert rows["position_zero"] == zero
    assert rows["trim_2"][0] == "capacity beside the sheet's curve, point 3 [%]"
    assert rows["trim_2"][1:] == ("1", "-1 to 3", "4", "2.9")
    assert all(len(cells) == len(HEAD) for cells in rows.values())


def test_shown_is_what_a_person_asks_for_and_what_lies_furthest_apart():
    rows = then_and_now(SINCE_HISTORY)
    assert [row.name for row in worth_showing(rows)] == ["capacity", "position_zero", "trim_2"]
    assert worth_showing([]) == []


def test_a_parameter_without_words_keeps_its_name():
    assert parameter_words("rise_0") == "rise of the capacity, point 1"
    assert parameter_words("seat_leakage.leak_kv") == "seat leakage, leak kv"
