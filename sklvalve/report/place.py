# SPDX-License-Identifier: BSD-3-Clause
"""Where and when a mismatch acts, in words."""

import re
from datetime import datetime, timedelta

from sklvalve.recording.units import from_si, quantity_of
from sklvalve.report.words import block_words, number, percent, role_words, with_unit

_STAMP = "%Y-%m-%d %H:%M:%S"
_MOVES = {"opening": "opens", "closing": "closes"}
_FORMULA = " dp/(p1 - FF pv)"
# signal -> what it is called, factor and offset from SI to what is shown, unit shown; the last three where
# the recording has no unit of its own
_SIGNALS: dict[str, tuple[str, float, float, str]] = {
    "opening": ("opening", 100.0, 0.0, "%"),
    "command": ("command", 100.0, 0.0, "%"),
    "pressure_ratio": (f"pressure ratio{_FORMULA}", 1.0, 0.0, ""),
    "dp": ("pressure drop", 1e-3, 0.0, "kPa"),
    "temperature": ("temperature", 1.0, -273.15, "degC"),
    "flow": ("flow", 3600.0, 0.0, "m3/h"),
    "rate": ("rate of travel", 100.0, 0.0, "%/s"),
    "reynolds": ("valve Reynolds number", 1.0, 0.0, ""),
}
# signal -> the role in whose unit it is shown
_SHOWN_AS = {"dp": "p1", "temperature": "temperature", "flow": "flow"}


def located(d: dict) -> dict:
    """The location of a diagnosis, with what its words need: recorded units, and when the clock began.

    Parameters
    ----------
    d : dict

    Returns
    -------
    location : dict
        With ``units`` by role, and ``begins``, the stamp of the first sample, where there is one.
    """
    begins = (d.get("provenance") or {}).get("begins")
    return (d.get("location") or {}) | {"units": d.get("units") or {}, "begins": begins}


def _scale(signal: str, units: dict) -> tuple[str, float, float, str]:
    """Name of a signal, factor and offset from SI to the unit shown, and that unit."""
    name, factor, offset, unit = _SIGNALS.get(signal, (str(signal).replace("_", " "), 1.0, 0.0, ""))
    own = units.get(_SHOWN_AS.get(signal, ""))
    quantity = quantity_of(own) if own else None
    if own is None or quantity is None:
        return name, factor, offset, unit
    zero, one = (float(from_si(value, own, quantity)) for value in (0.0, 1.0))
    # a drop is a difference of pressures: where their zero lies is of no account
    return name, one - zero, 0.0 if signal == "dp" else zero, own


def region_words(region: dict, digits: int = 3, units: dict | None = None) -> str:
    """Words for one region: ``below 12 % opening while the stem closes``.

    Parameters
    ----------
    region : dict
        An item of ``location.regions``; bounds in SI, None where the region is open; ``and`` holds a second
        range where two signals bound it.
    digits : int, default=3
        Of the bounds.
    units : dict or None, default=None
        Recorded unit by role.
    """
    words = _range_words(region, digits, units or {})
    if region.get("direction"):
        words += f" while the stem {_MOVES.get(region['direction'], region['direction'])}"
    if region.get("and"):
        words += f" {_placed(_range_words(region['and'], digits, units or {}))}"
    return words


def _range_words(region: dict, digits: int, units: dict) -> str:
    name, factor, offset, unit = _scale(region["signal"], units)
    low, high = region.get("low"), region.get("high")
    if region["signal"] in ("opening", "command"):
        low = None if low is not None and low <= 0.005 else low
        high = None if high is not None and high >= 0.995 else high
    shown = [None if bound is None else number(factor * bound + offset, digits) for bound in (low, high)]
    return _bounds(name, shown[0], shown[1], f" {unit}" if unit else "")


def _bounds(name: str, low: str | None, high: str | None, unit: str) -> str:
    at = f"{unit} {name}" if unit == " %" else unit
    before = "" if unit == " %" else f"{name} "
    if low is None and high is None:
        return f"at every {name}"
    if low is None:
        return f"{before}below {high}{at}"
    if high is None:
        return f"{before}above {low}{at}"
    return f"{before}between {low} and {high}{at}"


def regions_words(location: dict) -> str:
    """Words for all regions of a location, or an empty text where none stands out."""
    units = location.get("units")
    return " and ".join(_placed(region_words(each, units=units)) for each in location.get("regions") or [])


def brief_place(d: dict, blocks: list[str]) -> str:
    """Where and since when in few words: in the valve, mostly below 12 % opening, from 812 s on.

    Of several regions only the one that holds most rows is named, to two digits.
    """
    location = located(d)
    regions = sorted(location.get("regions") or [], key=lambda region: -(region.get("share") or 0.0))
    parts = [block_words(blocks)]
    if regions:
        largest = _placed(region_words(regions[0], 2, location["units"]).replace(_FORMULA, ""))
        parts.append(f"mostly {largest}" if len(regions) > 1 else largest)
    if since_known(d) and (location.get("onset") is not None or location.get("intervals")):
        plain = {key: value for key, value in location.items() if not key.endswith("_ci95")}
        parts.append(onset_words(plain))
    return ", ".join(part for part in parts if part)


def _placed(words: str) -> str:
    if words.startswith(("at ", "below ", "above ", "between ")):
        return words
    name, bound, rest = re.split(r" (?=below|above|between)(\w+) ", words, maxsplit=1)
    return f"where the {name} is {bound} {rest}"


def share_words(region: dict) -> str:
    """Words for the rows that a region holds."""
    share = region.get("share")
    return "" if share is None else f"{percent(share)} of the rows"


def duration(seconds: float) -> str:
    """Time from the first sample: seconds, and hours or days where seconds would not be read."""
    if seconds < 36_000.0:
        return f"{seconds:.0f} s"
    if seconds < 864_000.0:
        return f"{seconds / 3600.0:.1f} h"
    return f"{seconds / 86400.0:.1f} days"


def moment(seconds: float, location: dict) -> str:
    """A time: by the calendar where the recording has it, else from the first sample.

    Of several recordings without a common clock it counts from the start of its own.
    """
    stamp = _stamp(seconds, location)
    if stamp is not None:
        return f"{stamp:{_STAMP}}"
    begun = [each for each in location.get("recordings") or [] if each["begins"] <= seconds + 1e-6]
    if not begun:
        return duration(seconds)
    since = seconds - begun[-1]["begins"]
    return f"{'the start' if since < 1e-6 else duration(since)} of {begun[-1]['source']}"


def _stamp(seconds: float, location: dict) -> datetime | None:
    """A time from the first sample by the calendar; None where the recording has none."""
    try:
        return datetime.fromisoformat(location.get("begins") or "") + timedelta(seconds=round(seconds))
    except (ValueError, OverflowError):
        return None


def onset_words(location: dict) -> str:
    """Since when, with its interval: from the start, or from a time on, or in episodes."""
    episodes = location.get("intervals") or []
    if location.get("course") == "in spells" and len(episodes) == 1:
        until = f"{moment(episodes[0][1], location)}{_until_within(location)}"
        return f"from {_begin(location)} until {until}"
    if location.get("course") == "in spells":
        return f"in {len(episodes)} episodes from {_begin(location)} on"
    onset = location.get("onset")
    words = "from the start" if onset is None else f"from {_begin(location)} on"
    return f"growing {words}" if location.get("course") == "growing" else words


def _begin(location: dict) -> str:
    onset = location.get("onset")
    return "the start" if onset is None else f"{moment(onset, location)}{_onset_within(location)}"


def _onset_within(location: dict) -> str:
    return _within(location.get("onset_ci95"), location, location.get("onset"))


def _until_within(location: dict) -> str:
    ranges = location.get("intervals_ci95")
    return _within(ranges[-1][1], location, location["intervals"][-1][1]) if ranges else ""


def _within(ci: list | None, location: dict, around: float | None) -> str:
    """An interval of confidence of a moment, in brackets."""
    return "" if ci is None else f" (95 %: {_span(ci[0], ci[1], location, around)})"


def _span(low: float, high: float, location: dict, around: float | None = None) -> str:
    """Two times; the unit once where it is the same, and no date that the words before them have."""
    stamps = _stamp(low, location), _stamp(high, location)
    if stamps[0] is not None and stamps[1] is not None:
        near = None if around is None else _stamp(around, location)
        shown = []
        for stamp in (stamps[0], stamps[1]):
            day = None if near is None else near.date()
            shown.append(f"{stamp:%H:%M:%S}" if day == stamp.date() else f"{stamp:{_STAMP}}")
            near = stamp
        return " to ".join(shown)
    begin, end = moment(low, location), moment(high, location)
    if location.get("recordings"):
        return f"{begin} to {end}"
    same = begin.split(" ")[1] == end.split(" ")[1]
    return f"{begin.split(' ')[0] if same else begin} to {end}"


def change_words(location: dict) -> str:
    """When a signal changed and by how much: ``at 9757 s [9750 to 9761 s]: the flow reads 12 cm3/s lower``.

    Empty where nothing changed in time.
    """
    change = location.get("change")
    if not change:
        return ""
    low, high = change["ci95"]
    scale, unit = (100.0, "% of travel") if change["unit"] == "1" else (1.0, change["unit"])
    size = with_unit(abs(scale * change["size"]), unit)
    which = "lower" if change["size"] < 0.0 else "higher"
    return (
        f"at {moment(change['time'], location)} [{_span(low, high, location, change['time'])}]: the "
        f"{role_words(change['signal'])} reads {size} {which} from then on, in the median"
    )


def since_known(d: dict) -> bool:
    """Whether a diagnosis says since when something acts.

    What no effect explains is learnt from all rows alike, so that nothing says when it began; and where
    nothing is even a candidate, nothing was dated.
    """
    location = d.get("location") or {}
    nameless = d["verdict"] == "none_of_these" or (d["verdict"] == "cannot_tell" and not d.get("effects"))
    return not nameless or location.get("onset") is not None


def since_words(location: dict) -> str:
    """Since when, for a table.

    Parameters
    ----------
    location : dict
        As `located` gives it.
    """
    onset = location.get("onset")
    first = _stamp(0.0, location)
    if onset is None:
        return "the start" + (f" ({first:{_STAMP}})" if first is not None else "")
    after = "" if first is not None or location.get("recordings") else " after the first sample"
    return f"{moment(onset, location)}{after}{_onset_within(location)}"


def intervals_words(location: dict, limit: int = 4) -> str:
    """Times at which the mismatch is there, the first few of them.

    Parameters
    ----------
    location : dict
        As `located` gives it.
    limit : int, default=4
    """
    spans = []
    for start, stop in location.get("intervals") or []:
        begins, ends = moment(start, location), moment(stop, location)
        if _stamp(start, location) is not None:
            spans.append(_span(start, stop, location))
        else:
            spans.append(f"{begins} to {ends}")
    if len(spans) > limit:
        spans = [*spans[:limit], f"and {len(spans) - limit} more"]
    return ", ".join(spans)
