# SPDX-License-Identifier: BSD-3-Clause
"""Where and when a mismatch acts, in words."""

import re
from collections.abc import Sequence
from datetime import datetime, timedelta

from sklvalve.report.words import block_words, number, percent, role_words, with_unit

_FORMULA = " dp/(p1 - FF pv)"
# signal -> what it is called, factor and offset from SI to what is shown, unit shown
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


def region_words(region: dict, digits: int = 3) -> str:
    """Words for one region: ``below 12 % opening while closing``.

    Parameters
    ----------
    region : dict
        An item of ``location.regions``; bounds in SI, None where the region is open; ``and`` holds a second
        range where two signals bound it.
    digits : int, default=3
        Of the bounds.
    """
    words = _range_words(region, digits)
    if region.get("direction"):
        words += f" while {region['direction']}"
    if region.get("and"):
        words += f" {_placed(_range_words(region['and'], digits))}"
    return words


def _range_words(region: dict, digits: int) -> str:
    name, factor, offset, unit = _SIGNALS.get(
        region["signal"], (str(region["signal"]).replace("_", " "), 1.0, 0.0, "")
    )
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
    return " and ".join(_placed(region_words(region)) for region in location.get("regions") or [])


def brief_place(d: dict, blocks: list[str]) -> str:
    """Where and since when in few words: in the valve, mostly below 12 % opening, from 812 s on.

    Of several regions only the one that holds most rows is told, to two digits.
    """
    location = d.get("location") or {}
    regions = sorted(location.get("regions") or [], key=lambda region: -(region.get("share") or 0.0))
    parts = [block_words(blocks)]
    if regions:
        largest = _placed(region_words(regions[0], digits=2).replace(_FORMULA, ""))
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
    """A time from the first sample; where several recordings were joined, from the start of its own."""
    begun = [each for each in location.get("recordings") or [] if each["begins"] <= seconds + 1e-6]
    if not begun:
        return duration(seconds)
    since = seconds - begun[-1]["begins"]
    return f"{'the start' if since < 1e-6 else duration(since)} of {begun[-1]['source']}"


def onset_words(location: dict) -> str:
    """Since when, with its interval: from the start, or from a time after the first sample, or in spells."""
    spells = location.get("intervals") or []
    if location.get("course") == "in spells" and len(spells) == 1:
        until = f"{moment(spells[0][1], location)}{_until_within(location)}"
        return f"from {_begin(location)} until {until}"
    if location.get("course") == "in spells":
        return f"in {len(spells)} spells from {_begin(location)} on"
    onset = location.get("onset")
    words = "from the start" if onset is None else f"from {_begin(location)} on"
    return f"growing {words}" if location.get("course") == "growing" else words


def _begin(location: dict) -> str:
    onset = location.get("onset")
    return "the start" if onset is None else f"{moment(onset, location)}{_onset_within(location)}"


def _onset_within(location: dict) -> str:
    return _within(location.get("onset_ci95"), location)


def _until_within(location: dict) -> str:
    ranges = location.get("intervals_ci95")
    return _within(ranges[-1][1], location) if ranges else ""


def _within(ci: list | None, location: dict) -> str:
    """An interval of confidence of a moment."""
    return "" if ci is None else f" (95 %: {_span(ci[0], ci[1], location)})"


def _span(low: float, high: float, location: dict) -> str:
    """Two times, the unit once where it is the same."""
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
        f"at {moment(change['time'], location)} [{_span(low, high, location)}]: the "
        f"{role_words(change['signal'])} reads {size} {which} from then on"
    )


def since_known(d: dict) -> bool:
    """Whether a diagnosis tells since when something acts.

    What no effect explains is learnt from all rows alike, so that nothing tells when it began; and where
    nothing is even a candidate, nothing was dated.
    """
    location = d.get("location") or {}
    nameless = d["verdict"] == "none_of_these" or (d["verdict"] == "cannot_tell" and not d.get("effects"))
    return not nameless or location.get("onset") is not None


def since_words(location: dict, begins: str | None = None) -> str:
    """Since when, for a table.

    Parameters
    ----------
    location : dict
    begins : str, default=None
        ISO 8601 stamp of the first sample, where the recording has clock times: they are told too.
    """
    onset = location.get("onset")
    if onset is None:
        return f"the start{_bracketed([_clock([0.0], begins)])}"
    after = "" if location.get("recordings") else " after the first sample"
    ci = location.get("onset_ci95")
    within = f"95 %: {_span(ci[0], ci[1], location)}" if ci else ""
    return f"{moment(onset, location)}{after}{_bracketed([_clock([onset], begins), within])}"


def intervals_words(location: dict, begins: str | None = None, limit: int = 4) -> str:
    """Times at which the mismatch is there, the first few of them.

    Parameters
    ----------
    location : dict
    begins : str, default=None
        ISO 8601 stamp of the first sample, where the recording has clock times: they are told too.
    limit : int, default=4
    """
    spans = [
        f"{moment(start, location)} to {moment(stop, location)}{_bracketed([_clock([start, stop], begins)])}"
        for start, stop in location.get("intervals") or []
    ]
    if len(spans) > limit:
        spans = [*spans[:limit], f"and {len(spans) - limit} more"]
    return ", ".join(spans)


def _clock(seconds: Sequence[float], begins: str | None) -> str:
    """Times from the first sample as clock times: ``14:12:23 to 14:20:00 on 2024-03-01``."""
    if begins is None:
        return ""
    try:
        first = datetime.fromisoformat(begins)
    except ValueError:
        return ""
    told = [first + timedelta(seconds=round(each)) for each in seconds]
    if told[0].date() == told[-1].date():
        return f"{' to '.join(f'{each:%H:%M:%S}' for each in told)} on {told[0]:%Y-%m-%d}"
    return " to ".join(f"{each:%H:%M:%S} on {each:%Y-%m-%d}" for each in told)


def _bracketed(words: Sequence[str]) -> str:
    told = "; ".join(each for each in words if each)
    return f" ({told})" if told else ""
