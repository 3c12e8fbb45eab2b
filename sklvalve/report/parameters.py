# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of effects as a plant engineer writes them: percent of travel, the recording's own units."""

from collections.abc import Callable
from typing import NamedTuple

from sklvalve.recording.units import from_si, quantity_of, to_si
from sklvalve.report.words import number

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
    shown = (_shown(who, name, item, d) for name, item in (effect.get("parameters") or {}).items())
    return [parameter for parameter in shown if parameter is not None]


def _shown(who: str, name: str, item: dict, d: dict) -> Parameter | None:
    told = _scale(who, name, item.get("unit") or "1", d)
    if told is None:
        return None
    words, shown, turn = told
    low, high = item.get("ci95") or (None, None)
    value, low, high = (_turned(v, turn) for v in (item["value"], low, high))
    unknown = tuple(item.get("unknown_ends") or ())
    return Parameter(words, value, low, high, shown, unknown)


def shown_range(limit: dict, d: dict) -> tuple[str, float | None, float | None, str]:
    """A range of a parameter as it is shown: its name, both ends, None where it has none, and its unit.

    Parameters
    ----------
    limit : dict
        ``name`` of an effect, its ``parameter`` and ``unit``, ``low`` and ``high``.
    d : dict
        The whole diagnosis, as in `shown_parameters`.
    """
    who, name, unit = limit["name"], limit["parameter"], limit["unit"]
    words, shown, turn = _scale(who, name, unit, d) or (name, unit, 1.0)
    low, high = (_turned(limit[end], turn) for end in ("low", "high"))
    return (words, high, low, shown) if _falls(who, name, unit, turn) else (words, low, high, shown)


def _falls(who: str, name: str, unit: str, turn: float | Callable[[float], float]) -> bool:
    """Whether what is shown falls as the parameter rises, as the time of a stroke does with its speed."""
    from sklvalve.mismatch.result.known_effects import quantity_named

    quantity = quantity_named(who, name, unit)
    if quantity is None or not callable(turn):
        return not callable(turn) and turn < 0.0
    return turn(quantity.low) > turn(quantity.high)


def _scale(who: str, name: str, unit: str, d: dict) -> tuple[str, str, float | Callable] | None:
    """Words, unit and factor, or function, by which a parameter is shown; None where reports leave it out."""
    # a report without effects does without the simulation, which takes a second to import
    from sklvalve.mismatch.result.known_effects import quantity_named

    quantity = quantity_named(who, name, unit)
    if quantity is not None and quantity.silent:
        return None
    told = quantity.shown if quantity is not None else None
    return (told.words, told.unit, told.turn) if told else _plain(name, unit, d)


def _plain(name: str, unit: str, d: dict) -> tuple[str, str, float]:
    """Words, unit and factor of a parameter that says nothing of them; flow and pressure as recorded."""
    words = " ".join({"kv": "Kv"}.get(word, word) for word in name.split("_"))
    flow_unit = ((d.get("fit") or {}).get("flow") or {}).get("unit")
    each, per = (unit[:-2], " per hour") if unit.endswith("/s/h") else (unit, "")
    quantity = quantity_of(each)
    if flow_unit and quantity in ("volume flow", "mass flow") and quantity_of(flow_unit) == quantity:
        factor = float(from_si(to_si(1.0, each, quantity), flow_unit, quantity))
        return "offset" if name == "bias" else words, f"{flow_unit}{per}", factor
    units = d.get("units") or {}
    pressure_unit = units.get("p1") or units.get("p2") or ""
    if quantity == quantity_of(pressure_unit) == "pressure":
        # of a difference: a gauge's zero is none of it
        high, low = (float(to_si(value, pressure_unit, quantity)) for value in (1.0, 0.0))
        return words, pressure_unit, 1.0 / (high - low)
    return words, "" if unit == "1" else unit, 1.0


def _turned(value: float | None, turn: float | Callable[[float], float]) -> float | None:
    if value is None:
        return None
    return turn(value) if callable(turn) else turn * value
