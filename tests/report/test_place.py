# SPDX-License-Identifier: BSD-3-Clause
import pytest

from sklvalve.report import summary_sentence
from sklvalve.report.headline import headline
from sklvalve.report.place import (
    change_words,
    duration,
    intervals_words,
    onset_words,
    region_words,
    regions_words,
    since_words,
)
from sklvalve.report.rows import places
from sklvalve.report.words import chance, class_words, number, p_words, percent, spoken, sure
from tests.report import examples


@pytest.mark.parametrize(
    ("signal", "low", "high", "direction", "words"),
    [
        ("opening", 0.0, 0.12, None, "below 12 % opening"),
        ("opening", 0.66, 1.0, None, "above 66 % opening"),
        ("opening", 0.12, 0.4, "closing", "between 12 and 40 % opening while the stem closes"),
        ("opening", 0.0, 1.0, "opening", "at every opening while the stem opens"),
        ("pressure_ratio", 0.52, None, None, "pressure ratio dp/(p1 - FF pv) above 0.52"),
        ("dp", 1e5, 3e5, None, "pressure drop between 100 and 300 kPa"),
        ("temperature", None, 323.15, None, "temperature below 50 degC"),
        ("novel_signal", 1.0, 2.0, None, "novel signal between 1 and 2"),
    ],
)
def test_regions_in_words(signal, low, high, direction, words):
    region = {"signal": signal, "low": low, "high": high, "direction": direction, "share": 0.1}
    assert region_words(region) == words


def test_box_of_two_signals_in_words():
    box = {"signal": "opening", "low": 0.5, "high": 1.0, "direction": None, "share": 0.1}
    box["and"] = {"signal": "dp", "low": 1e5, "high": 3e5}
    words = "above 50 % opening where the pressure drop is between 100 and 300 kPa"
    assert region_words(box) == words
    assert regions_words({"regions": [box]}) == words


def test_several_regions_are_joined():
    regions = [
        {"signal": "opening", "low": 0.0, "high": 0.1, "direction": None, "share": 0.1},
        {"signal": "dp", "low": 1e5, "high": None, "direction": None, "share": 0.1},
    ]
    words = regions_words({"regions": regions})
    assert words == "below 10 % opening and where the pressure drop is above 100 kPa"


@pytest.mark.parametrize(
    ("seconds", "words"), [(812.4, "812 s"), (36_000.0, "10.0 h"), (1_000_000.0, "11.6 days")]
)
def test_durations(seconds, words):
    assert duration(seconds) == words


def test_times():
    assert onset_words({"onset": None}) == "from the start"
    assert onset_words({"onset": 30.0}) == "from 30 s on"
    known = {"onset": 812.0, "onset_ci95": [790.4, 833.0], "intervals": [[812.0, 5759.0]]}
    assert onset_words(known) == "from 812 s (95 %: 790 to 833 s) on"
    assert since_words(known) == "812 s after the first sample (95 %: 790 to 833 s)"
    assert onset_words(known | {"course": "growing"}) == "growing from 812 s (95 %: 790 to 833 s) on"
    spell = {"course": "in spells", "intervals": [[812.0, 900.0]]}
    ends = {"intervals_ci95": [[[790.4, 833.0], [880.0, 920.0]]]}
    words = "from 812 s (95 %: 790 to 833 s) until 900 s (95 %: 880 to 920 s)"
    assert onset_words(known | spell | ends) == words
    two = spell | {"onset": None, "intervals": [[0.0, 10.0], [20.0, 30.0]]}
    assert onset_words(two) == "in 2 episodes from the start on"
    spans = [[10.0 * k, 10.0 * k + 5.0] for k in range(6)]
    assert intervals_words({"intervals": spans}).endswith("30 s to 35 s, and 2 more")


def test_times_are_those_of_the_calendar_where_the_recording_has_it():
    known = {"onset": 812.4, "onset_ci95": [790.4, 833.0], "intervals": [[812.4, 900.0], [36000.0, 87000.0]]}
    known["begins"] = "2024-03-01T13:28:00"
    assert since_words(known) == "2024-03-01 13:41:32 (95 %: 13:41:10 to 13:41:53)"
    assert onset_words(known) == "from 2024-03-01 13:41:32 (95 %: 13:41:10 to 13:41:53) on"
    assert since_words(known | {"onset": None}) == "the start (2024-03-01 13:28:00)"
    assert intervals_words(known) == (
        "2024-03-01 13:41:32 to 13:43:00, 2024-03-01 23:28:00 to 2024-03-02 13:38:00"
    )
    # a stamp that no calendar has, and times beyond it, are seconds
    assert since_words({"onset": 812.4, "begins": "yesterday"}) == "812 s after the first sample"
    assert onset_words({"onset": 1e15, "begins": known["begins"]}).startswith("from 115740740")


def test_the_calendar_reaches_headline_table_and_change():
    made = examples.named()
    made["provenance"] |= {"begins": "2024-03-01T13:28:00"}
    change = {"signal": "flow", "time": 812.0, "ci95": [800.0, 820.0], "size": 0.5, "unit": "m3/h"}
    made["location"] = made["location"] | {"onset": 812.0, "change": change}
    assert dict(places(made))["Since"] == "2024-03-01 13:41:32"
    assert dict(places(made))["Present"] == "2024-03-01 13:41:32 to 15:03:59"
    assert dict(places(made))["Changed"].startswith("at 2024-03-01 13:41:32 [13:41:20 to 13:41:40]: the flow")
    assert "from 2024-03-01 13:41:32 on" in headline(made)
    assert "812 s" not in headline(made) + summary_sentence(made)


@pytest.mark.parametrize(
    ("signal", "role", "unit", "words"),
    [
        ("dp", "p1", "bar", "pressure drop between 1 and 3 bar"),
        ("temperature", "temperature", "degF", "temperature between 32 and 212 degF"),
        ("flow", "flow", "t/h", "flow between 3.6 and 7.2 t/h"),
        ("dp", "p1", None, "pressure drop between 100 and 300 kPa"),
    ],
)
def test_regions_are_in_recorded_units(signal, role, unit, words):
    low, high = {"dp": (1e5, 3e5), "temperature": (273.15, 373.15), "flow": (1.0, 2.0)}[signal]
    region = {"signal": signal, "low": low, "high": high, "direction": None, "share": 0.1}
    assert region_words(region, units={role: unit} if unit else {}) == words


def test_certainty_is_never_claimed():
    assert sure({"probability": 1.0}) == "right in more than 99 % of blind tests"
    assert sure({"probability": 0.87}) == "right in 87 % of blind tests"
    assert sure({"probability": None, "grade": {"level": "weak"}}) == "weak evidence"
    assert chance(1.0) == "> 99 %"
    assert chance(0.87) == "87 %"
    assert p_words(0.0) == "p < 0.001"
    assert percent(0.0004) == "0.0 %"


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0.0, "0"),
        (1234.5, "1230"),
        (0.000123456, "0.000123"),
        (-2.0, "-2"),
        (None, "unknown"),
        (2e9, "2e+09"),
    ],
)
def test_numbers_are_written_as_people_write_them(value, words):
    assert number(value) == words


def test_large_classes_are_cut_short():
    members = [{"name": name} for name in ("stiction", "backlash", "dead_time", "new_effect")]
    assert class_words(members) == "stiction, backlash or one of 2 others"
    assert spoken("new_effect") == "new effect"


def test_a_change_has_a_time_an_interval_and_a_size():
    change = {"signal": "flow", "time": 9757.0, "ci95": [9750.0, 9761.0], "size": -12.3, "unit": "cm3/s"}
    words = "at 9757 s [9750 to 9761 s]: the flow reads 12.3 cm3/s lower from then on, in the median"
    assert change_words({"change": change}) == words
    assert change_words({"change": None}) == change_words({}) == ""
    opened = change | {"signal": "opening", "size": 0.05, "unit": "1"}
    assert change_words({"change": opened}).endswith(
        "the opening reads 5 % of travel higher from then on, in the median"
    )
    nameless = {"verdict": "none_of_these", "location": {"blocks": ["valve"], "change": change}}
    assert ("Changed", words) in places(nameless)
    assert "Since" not in dict(places(nameless))
