# SPDX-License-Identifier: BSD-3-Clause
"""Times of every spelling, and dates whose order only the whole file tells."""

from datetime import UTC, datetime

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sklvalve.recording import InputError
from sklvalve.recording.historian.moments import HOUR, SECOND, date_order, looks_like_time, read_moments


def _read(*cells, unit="", day_first=True):
    return read_moments(list(cells), unit, day_first, "line {}".format)


EXPECTED = int(datetime(2024, 3, 5, 14, 7, 9, tzinfo=UTC).timestamp()) * SECOND
SPELT = [
    "2024-03-05 14:07:09",
    "2024-03-05T14:07:09",
    "2024/3/5 14:07:09",
    "05.03.2024 14:07:09",
    "5.3.24 14:07:09",
    "05/03/2024 2:07:09 PM",
    "05-Mar-24 14:07:09",
    "05-MAR-2024 14:07:09.000",
    "5 März 2024 14:07:09",
    "5 mars 2024 14:07:09",
    "05 marzec 2024 14:07:09",
    "Mar 5, 2024 2:07:09 pm",
    "20240305 140709",
    "20240305140709",
    "2024-03-05 14:07:09,000",
]


@pytest.mark.parametrize("cell", SPELT)
def test_spelling(cell):
    assert looks_like_time(cell)
    moments = _read(cell)
    assert (moments.kind, moments.ticks.tolist()) == ("local", [EXPECTED])


@pytest.mark.parametrize(
    ("month", "names"),
    [
        (1, "Jan sty ene janv. January"),
        (5, "May Mai maj mayo"),
        (6, "Jun Juni cze juin"),
        (7, "Jul Juli lip juillet"),
        (8, "Aug sie août ago"),
        (10, "Oct Okt paź octobre"),
        (12, "Dec Dez gru déc. dic"),
    ],
)
def test_names_of_months(month, names):
    for name in names.split():
        moments = _read(f"07-{name}-2024 00:00:00")
        assert moments.ticks[0].astype("datetime64[us]").astype(object).month == month, name


@pytest.mark.parametrize(
    ("cell", "hours"),
    [
        ("2024-03-05T14:07:09Z", 0),
        ("2024-03-05 14:07:09+0100", 1),
        ("2024-03-05 14:07:09 -05", -5),
        ("05.03.2024 14:07:09 MEZ", 1),
        ("2024-03-05 14:07:09 UTC", 0),
    ],
)
def test_offset(cell, hours):
    moments = _read(cell)
    assert (moments.kind, moments.offsets.tolist()) == ("offset", [hours * HOUR])


@pytest.mark.parametrize(
    "cell",
    [
        "2024-13-05 10:00",
        "2024-02-30 10:00",
        "2024-02-03 25:00",
        "2024-02-03 10:60",
        "05 Foo 2024",
        "noon",
        "1/2/3 4",
        "2024-02-03 13:00 PM",
        "2024-02-03 10:00:00 XYZ",
        "24:00",
    ],
)
def test_no_time(cell):
    with pytest.raises(InputError, match=r"line 1: .* is no time"):
        _read("2024-01-01 10:00:00", cell)


def test_midnight_at_the_end_of_a_day():
    late, early = _read("2024-02-03 24:00:00", "2024-02-04 00:00:00").ticks
    assert late == early


@given(st.datetimes(datetime(1971, 1, 1), datetime(2068, 12, 31)))
def test_any_moment_survives_being_written(moment):
    expected = np.datetime64(moment, "us").astype(np.int64)
    assert _read(moment.isoformat(sep=" ")).ticks[0] == expected
    assert _read(f"{moment:%d.%m.%Y %H:%M:%S.%f}").ticks[0] == expected
    assert _read(f"{moment:%m/%d/%Y %I:%M:%S.%f %p}", day_first=False).ticks[0] == expected


@pytest.mark.parametrize(
    ("cells", "day_first", "assumed"),
    [
        (["28/06/2024 10:00", "01/07/2024 10:00"], True, False),
        (["06/28/2024 10:00", "07/01/2024 10:00"], False, False),
        (["03.04.2024 10:00"], True, False),
        (["03/04/2024 10:00"], True, True),
        (["03/04/2024 10:00 AM"], False, False),
        (["03/04/2024 10:00", "04/04/2024 10:00", "05/04/2024 10:00"], True, False),
        (["03/04/2024 10:00", "03/05/2024 10:00", "03/06/2024 10:00"], False, False),
        (["2024-04-03"], True, False),
    ],
)
def test_order_of_day_and_month(cells, day_first, assumed):
    assert date_order(cells, "here") == (day_first, assumed)


def test_counted_times():
    assert _read("0", "0.5", "1").ticks.tolist() == [0, SECOND // 2, SECOND]
    assert _read("0", "2", unit="min").ticks.tolist() == [0, 120 * SECOND]
    assert _read("0", "250", unit="ms").ticks.tolist() == [0, SECOND // 4]
    assert _read("0,0", "0,5").kind == "seconds"
    for scale in (1, 1000, 1_000_000, 1_000_000_000):
        moments = _read(str(1709647629 * scale), str(1709647630 * scale))
        assert (moments.kind, moments.ticks[0]) == ("offset", EXPECTED)
    serial = _read("45356,58829861", "45356,58831019")
    assert (serial.kind, int(np.rint(serial.ticks[0] / SECOND)) * SECOND) == ("local", EXPECTED)
    with pytest.raises(InputError, match="line 1: 'x' is no time, unlike '0'"):
        _read("0", "x", *map(str, range(1, 99)))
    with pytest.raises(InputError, match="line 60: 'x' is no time, unlike '0'"):
        _read(*map(str, range(60)), "x")
