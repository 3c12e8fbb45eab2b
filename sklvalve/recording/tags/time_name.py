# SPDX-License-Identifier: BSD-3-Clause
"""Whether a column is named for the time, and the unit in which its name says that it counts."""

import re
import unicodedata

from sklvalve.recording.tags import words
from sklvalve.recording.tags.unit_text import read_unit, split_unit

_UNITS = {
    "s": "s", "sec": "s", "secs": "s", "second": "s", "seconds": "s", "sek": "s", "sekunden": "s",
    "ms": "ms", "msec": "ms", "milliseconds": "ms",
    "min": "min", "mins": "min", "minute": "min", "minutes": "min", "minuten": "min",
    "h": "h", "hr": "h", "hrs": "h", "hour": "h", "hours": "h", "stunden": "h",
}  # fmt: skip
_ZONES = ("utc", "gmt", "local", "iso")


def read_time_name(name: str) -> str | None:
    """Unit of a column that is named for the time.

    Parameters
    ----------
    name : str

    Returns
    -------
    unit : {"s", "ms", "min", "h", ""} or None
        Empty where the name gives no unit; None where the name is not that of a time.

    Examples
    --------
    >>> from sklvalve.recording.tags import read_time_name
    >>> read_time_name("time_s"), read_time_name("Time [min]"), read_time_name("Time Stamp")
    ('s', 'min', '')
    >>> read_time_name("FIC101.PV") is None
    True
    """
    if read_unit(name) is not None:  # t/h
        return None
    rest, unit = split_unit(name)
    small = unicodedata.normalize("NFKD", rest.casefold().translate({ord("ł"): "l"}))
    parts = re.findall(r"[a-z0-9]+", small.encode("ascii", "ignore").decode())
    given = _UNITS.get(unit.casefold().strip(" .()[]"), "")
    if len(parts) > 1 and not given and parts[-1] in _UNITS:
        given = _UNITS[parts.pop()]
    if len(parts) > 1 and parts[-1] in _ZONES:
        parts.pop()
    if parts[:1] in (["elapsed"], ["relative"]) and (len(parts) > 1 or given):
        parts = parts[1:] or ["time"]
    return given if "".join(parts) in words.TIME else None
