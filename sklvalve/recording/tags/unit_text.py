# SPDX-License-Identifier: BSD-3-Clause
"""Units as people and historians write them, to the spelling that a valve.toml knows."""

import re
from typing import NamedTuple

from sklvalve.recording.units import quantity_of

# what is written, in small letters and without blanks -> known unit
_SPELT = {
    "%": ("%", "pct", "percent", "prozent", "procent", "pourcent", "%open", "%opening", "%auf", "%ouv"),
    "1": ("1", "fraction", "p.u.", "pu"),
    "Pa": ("pa",),
    "kPa": ("kpa",),
    "MPa": ("mpa",),
    "bar": ("bar",),
    "mbar": ("mbar", "hpa"),
    "psi": ("psi", "lb/in2", "lbf/in2"),
    "cmH2O": ("cmh2o", "cmwc", "cmws"),
    "mmHg": ("mmhg", "torr"),
    "degC": ("degc", "c", "celsius", "gradc", "oc", "deg.c"),
    "degF": ("degf", "f", "fahrenheit", "deg.f"),
    "K": ("k", "kelvin"),
    "m3/h": ("m3/h", "m3/hr", "m3h", "m3ph", "cbm/h", "cmh", "m^3/h", "m3.h-1"),
    "m3/s": ("m3/s", "m^3/s"),
    "l/s": ("l/s", "lps"),
    "l/min": ("l/min", "lpm", "l/m"),
    "cm3/s": ("cm3/s", "ml/s", "cm^3/s"),
    "gpm": ("gpm", "usgpm", "gal/min"),
    "t/h": ("t/h", "tph", "to/h", "t/hr", "mt/h"),
    "kg/h": ("kg/h", "kg/hr", "kgh", "kgph"),
    "kg/s": ("kg/s", "kgps"),
    "mm": ("mm",),
    "m": ("m",),
    "s": ("s", "sec", "seconds"),
    "min": ("min", "minutes"),
    "h": ("h", "hr", "hours"),
}
_UNIT_OF = {text: unit for unit, texts in _SPELT.items() for text in texts}
_SPOILT = str.maketrans({"³": "3", "²": "2", "℃": "degc", "℉": "degf", "º": "°", "ℓ": "l", "·": "."})
_OVER_ATMOSPHERE = ("(g)", "-g", "_g", "gauge", "gage", "ü", "g")
_ABSOLUTE = ("(a)", "(abs)", "-a", "_a", "abs", "a")
_BRACKETS = re.compile(r"^(.*?)[\s_]*[\[(<{]\s*([^\])>}]*(?:\([^)]*\))?)\s*[\])>}]\s*$")
# no column has a longer name; on longer ones looking for brackets takes the square of their length
_LONGEST = 500
_DEGREES = re.compile(r"(.*?[^\s_.])[\s_.]+(deg(?:rees?)?[\s_.]+[cfk])", re.IGNORECASE)
# endings of column names that are units beyond doubt; a single letter, or "min", may mean anything
_SAFE_ENDING = frozenset(
    text for text in _UNIT_OF if text == "%" or (len(text) > 1 and text not in ("min", "sec", "mm", "pu"))
)


class UnitReading(NamedTuple):
    """A known unit; for a pressure whether it is above the atmosphere, None where the text does not say."""

    unit: str
    gauge: bool | None = None


def read_unit(text: str) -> UnitReading | None:
    """Known unit that a text means, or None.

    Parameters
    ----------
    text : str
        As in a header row or a bracket, brackets included or not.

    Returns
    -------
    reading : UnitReading or None

    Examples
    --------
    >>> from sklvalve.recording.tags import read_unit
    >>> read_unit("m³/h").unit, read_unit("bar(g)"), read_unit("furlong")
    ('m3/h', UnitReading(unit='bar', gauge=True), None)
    """
    plain = _plain(bare(text))
    if plain in _UNIT_OF:
        return UnitReading(_UNIT_OF[plain])
    for endings, gauge in ((_OVER_ATMOSPHERE, True), (_ABSOLUTE, False)):
        for ending in endings:
            unit = _UNIT_OF.get(plain.removesuffix(ending)) if plain.endswith(ending) else None
            if unit is not None and quantity_of(unit) == "pressure":
                return UnitReading(unit, gauge)
    return None


def _plain(text: str) -> str:
    """A unit in small letters, without blanks; a degree in one spelling."""
    small = text.translate(_SPOILT).casefold().replace("°", "deg")
    return re.sub(r"^(?:degrees?|deg)[\s._]*(?=[cfk]|$)", "deg", small).replace(" ", "")


def bare(text: str) -> str:
    """A unit without the brackets around it."""
    text = text.strip()
    return text[1:-1].strip() if text[:1] + text[-1:] in ("[]", "()", "<>", "{}") else text


def split_unit(name: str) -> tuple[str, str]:
    """Take the unit off a column's name.

    Parameters
    ----------
    name : str

    Returns
    -------
    rest, unit : str
        What remains, and the text of the unit as it was written: in brackets, or a known one as the last part
        of the name; empty where there is none.

    Examples
    --------
    >>> from sklvalve.recording.tags import split_unit
    >>> split_unit("FIC101.PV [m3/h]"), split_unit("P74_00_kPa"), split_unit("F")
    (('FIC101.PV', 'm3/h'), ('P74_00', 'kPa'), ('F', ''))
    """
    if len(name) > _LONGEST:
        return name.strip(), ""
    bracket = _BRACKETS.match(name)
    if bracket and bracket[1] and (read_unit(bracket[2]) or name.rstrip().endswith("]")):
        return bracket[1].strip(), bracket[2].strip()
    degrees = _DEGREES.fullmatch(name.strip())
    if degrees:
        return degrees[1], degrees[2]
    parts = re.split(r"[\s_.]+(?=[^\s_.]+$)", name.strip())
    if len(parts) == 2 and parts[0] and _ending(parts[1]):
        return parts[0], parts[1]
    return name.strip(), ""


def _ending(text: str) -> bool:
    plain = _plain(text)
    return plain in _SAFE_ENDING or (len(plain) > 3 and read_unit(text) is not None)
