# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of effects as a plant engineer writes them: percent of travel, the recording's own units."""

from collections.abc import Callable
from math import exp
from typing import NamedTuple

from sklvalve.recording.units import from_si, quantity_of, to_si
from sklvalve.report.words import number

_Words = tuple[str, float | Callable[[float], float], str]

# of no meaning without the equation: they are in diagnosis.json
_SILENT = {
    "backlash": ("overshoot", "first_side"),
    "choked_flow": ("slope",),
    "spring_fault": ("hardening",),
    "wrong_characteristic": ("bow",),
}
# (name, unit) -> words, factor or function to what is shown, its unit; any other parameter is shown as it is
_SPOKEN: dict[tuple[str, str], _Words] = {
    ("width", "1"): ("play", 100.0, "% of travel"),
    ("half_width", "1"): ("dead band each way", 100.0, "% of travel"),
    ("reversal", "1"): ("dead band where it turns, as a multiple", 1.0, ""),
    ("limit", "1"): ("blocked at", 100.0, "% opening"),
    ("stick", "1"): ("dead band plus stick band", 100.0, "% of travel"),
    ("slip", "1"): ("slip jump", 100.0, "% of travel"),
    ("free", "1"): ("capacity that is left", 100.0, "%"),
    ("drop", "1"): ("loss of supply pressure", 100.0, "%"),
    ("bias", "1"): ("offset", 100.0, "% of travel"),
    ("gain", "1"): ("deviation", 100.0, "%"),
    ("fl", "1"): ("F_L", 1.0, ""),
    ("xt", "1"): ("x_T", 1.0, ""),
    ("knee", "1"): ("sharpness of the knee", 1.0, ""),
    ("delay", "s"): ("delay", 1.0, "s"),
    ("loss", "1"): ("loss, as a multiple of the open valve's own,", 1.0, ""),
    ("static_friction", "1"): ("friction at rest", 100.0, "% of the spring range"),
    ("sliding_share", "1"): ("sliding friction", 100.0, "% of that at rest"),
    ("friction", "1"): ("friction", 100.0, "% of the spring range"),
    ("jump", "1"): ("jump", 100.0, "% of travel"),
    ("speed", "1/s"): ("largest speed", 100.0, "%/s"),
    ("closing_ratio", "1"): ("speed of closing over that of opening", 1.0, ""),
    ("opening", "1"): ("stuck at", 100.0, "% opening"),
    ("cut_off", "1"): ("cut-off", 100.0, "% of the command"),
    ("curvature", "1"): ("curvature (0 is straight)", 1.0, ""),
    ("load", "1"): ("force at a large drop", 100.0, "% of the spring range"),
    ("strength", "1"): ("force of the spring", 100.0, "% of the sheet's"),
    ("leak", "1"): ("leak", 100.0, "% of the positioner's capacity"),
    ("lost_area", "1"): ("area without pressure", 100.0, "%"),
    ("share", "1"): ("air that passes", 100.0, "%"),
    ("gas_share", "1"): ("gas share", 100.0, "% of the volume"),
    ("ratio", "1"): ("density, as a multiple of the sheet's,", 1.0, ""),
    ("expansion", "1/K"): ("change of density", 100.0, "%/K"),
    ("fall", "1/K"): ("fall of viscosity", 100.0, "%/K"),
    ("rate", "1/h"): ("rate", 100.0, "%/h"),
}
# the same name means another thing there
_OF_EFFECT: dict[tuple[str, str], _Words] = {
    ("cavitation", "loss"): ("largest loss of capacity", 100.0, "%"),
    ("cavitation", "begins"): ("pressure ratio at which it begins", 1.0, ""),
    ("rod_bend", "begins"): ("begins at", 100.0, "% opening"),
    ("erosion", "reach"): ("reach of the wear", 100.0, "% of travel"),
    ("presliding", "reach"): ("give before it slides", 100.0, "% of travel"),
    ("wrong_characteristic", "slope"): ("rangeability, as a multiple of the sheet's,", exp, ""),
}


# a third digit says nothing where the interval is wider than this share of the value
_WIDE = 0.2
_ABOVE, _BELOW = "{} or more, upper bound unknown", "{} or less, lower bound unknown"


class Parameter(NamedTuple):
    """A parameter as it is shown: in `unit`, with the ends of its 95 % interval, None where it has none.

    Ends that are no more than the bound of what is possible are in `unknown_ends`: lower, upper.
    """

    name: str
    value: float | None
    low: float | None
    high: float | None
    unit: str
    unknown_ends: tuple[str, ...] = ()

    @property
    def words(self) -> str:
        """Value, unit and interval; an end that is not known is said to be so."""
        digits = self._digits()
        text = number(self.value, digits) + (f" {self.unit}" if self.unit else "")
        if self.low is None or self.high is None:
            return text
        low, high = number(self.low, digits), number(self.high, digits)
        if len(self.unknown_ends) > 1:
            return f"{text} (bounds unknown)"
        if "upper" in self.unknown_ends:
            return f"{text} (upper bound unknown)" if self.low == 0.0 else f"{text} ({_ABOVE.format(low)})"
        if "lower" in self.unknown_ends:
            return f"{text} ({_BELOW.format(high)})"
        return f"{text} [{low} to {high}]"

    @property
    def short(self) -> str:
        """Value and unit; of the interval only what is not known of it."""
        text = number(self.value, self._digits()) + (f" {self.unit}" if self.unit else "")
        if self.low is None or self.high is None or not self.unknown_ends:
            return text
        ends = "bounds" if len(self.unknown_ends) > 1 else f"{self.unknown_ends[0]} bound"
        return f"{text} ({ends} unknown)"

    def _digits(self) -> int:
        """Two digits where the interval is wide, else three."""
        if self.value is None or self.low is None or self.high is None:
            return 3
        wide = self.unknown_ends or self.high - self.low > _WIDE * abs(self.value)
        return 2 if wide else 3


def parameters(effect: dict, d: dict) -> list[tuple[str, str]]:
    """Parameters of an entry of ``effects`` in words: (name, value with its 95 % interval)."""
    return [(shown.name, shown.words) for shown in shown_parameters(effect, d)]


def shown_parameters(effect: dict, d: dict) -> list[Parameter]:
    """Parameters of an entry of ``effects`` with their 95 % intervals, the effect's size first.

    Those that only their equation gives a meaning are left to diagnosis.json.

    Parameters
    ----------
    effect : dict
        An entry of ``effects``.
    d : dict
        The whole diagnosis; flows in SI are shown in the unit in which the recording has its flow.
    """
    who = next((member["name"] for member in effect.get("members") or []), "")
    return [
        _shown(who, name, item, d)
        for name, item in (effect.get("parameters") or {}).items()
        if name not in _SILENT.get(who, ())
    ]


def _shown(who: str, name: str, item: dict, d: dict) -> Parameter:
    unit = item.get("unit") or "1"
    low, high = item.get("ci95") or (None, None)
    spelt = " ".join({"kv": "Kv"}.get(word, word) for word in name.split("_"))
    plain: _Words = (spelt, 1.0, "" if unit == "1" else unit)
    words, factor, shown = _OF_EFFECT.get((who, name)) or _SPOKEN.get((name, unit), plain)
    flow_unit = ((d.get("fit") or {}).get("flow") or {}).get("unit")
    quantity = quantity_of(unit)
    if flow_unit and quantity in ("volume flow", "mass flow") and quantity_of(flow_unit) == quantity:
        factor, shown = float(from_si(to_si(1.0, unit, quantity), flow_unit, quantity)), flow_unit
        words = "offset" if name == "bias" else words
    value, low, high = (_turned(v, factor) for v in (item["value"], low, high))
    unknown = tuple(item.get("unknown_ends") or ())
    return Parameter(words, value, low, high, shown, unknown)


def _turned(value: float | None, factor: float | Callable[[float], float]) -> float | None:
    if value is None:
        return None
    return factor(value) if callable(factor) else factor * value
