# SPDX-License-Identifier: BSD-3-Clause
"""Days of the recordings of the Lublin sugar factory, and the names of their files."""

import datetime
import re

#: The period of the recordings; on three of its days there are none.
FIRST, LAST = datetime.date(2001, 10, 27), datetime.date(2001, 11, 23)
_STEM = re.compile(r"(\d{2})(\d{2})(\d{4})")


def iso_day(day):
    """A day as ``"2001-11-09"``.

    Parameters
    ----------
    day : str or datetime.date
        A date, in ISO 8601, or as the files write it: ``"09112001"``.

    Raises
    ------
    ValueError
        If it is no day of the period.

    Examples
    --------
    >>> iso_day("09112001")
    '2001-11-09'
    """
    try:
        found = _date(day)
    except ValueError:
        found = None
    if found is None or not FIRST <= found <= LAST:
        raise ValueError(f"A day must be a date from {FIRST} to {LAST} such as '2001-11-09', got {day!r}.")
    return found.isoformat()


def file_of(day):
    """Name of the file of a day in ISO 8601: ``"09112001.txt"``."""
    return f"{datetime.date.fromisoformat(day):%d%m%Y}.txt"


def day_of(name):
    """Day of a file by its name, in ISO 8601; None where the name is no day of the period."""
    stem, _, kind = name.partition(".")
    if kind != "txt" or not _STEM.fullmatch(stem):
        return None
    try:
        return iso_day(stem)
    except ValueError:
        return None


def _date(day):
    if isinstance(day, datetime.date):
        return day.date() if isinstance(day, datetime.datetime) else day
    written = _STEM.fullmatch(str(day))
    # ISO 8601 would take eight digits for year, month and day
    return datetime.date.fromisoformat("-".join(written.groups()[::-1]) if written else str(day))
