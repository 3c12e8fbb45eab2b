# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of effects as a plant engineer writes them: percent of travel, the recording's own units."""

from sklvalve.recording.units import from_si, quantity_of, to_si
from sklvalve.report.words import number

# (name, unit) -> words, factor, unit shown; any other parameter is shown as it is
_SPOKEN = {
    ("width", "1"): ("play", 100.0, "% of travel"),
    ("half_width", "1"): ("dead band each way", 100.0, "% of travel"),
    ("limit", "1"): ("blocked above", 100.0, "% opening"),
    ("drop", "1"): ("loss of supply pressure", 100.0, "%"),
    ("bias", "1"): ("offset", 100.0, "% of travel"),
    ("gain", "1"): ("deviation", 100.0, "%"),
    ("fl", "1"): ("F_L", 1.0, ""),
    ("knee", "1"): ("sharpness of the knee", 1.0, ""),
    ("delay", "s"): ("delay", 1.0, "s"),
    ("loss", "1"): ("loss, as a multiple of the open valve's own,", 1.0, ""),
    ("static_friction", "1"): ("friction at rest", 100.0, "% of the spring range"),
    ("sliding_share", "1"): ("sliding friction", 100.0, "% of that at rest"),
}


def parameters(effect: dict, d: dict) -> list[tuple[str, str]]:
    """Parameters of an entry of ``effects``: (name, value with its 95 % interval), the effect's size first.

    Parameters
    ----------
    effect : dict
        An entry of ``effects``.
    d : dict
        The whole diagnosis; flows in SI are shown in the unit in which the recording has its flow.
    """
    return [_shown(name, item, d) for name, item in (effect.get("parameters") or {}).items()]


def _shown(name: str, item: dict, d: dict) -> tuple[str, str]:
    unit = item.get("unit") or "1"
    low, high = item.get("ci95") or (None, None)
    words, factor, shown = _SPOKEN.get(
        (name, unit), (name.replace("_", " "), 1.0, "" if unit == "1" else unit)
    )
    flow_unit = ((d.get("fit") or {}).get("flow") or {}).get("unit")
    quantity = quantity_of(unit)
    if flow_unit and quantity in ("volume flow", "mass flow") and quantity_of(flow_unit) == quantity:
        factor, shown = float(from_si(to_si(1.0, unit, quantity), flow_unit, quantity)), flow_unit
        words = "offset" if name == "bias" else words
    value = None if item["value"] is None else factor * item["value"]
    text = number(value) + (f" {shown}" if shown else "")
    if low is not None and high is not None:
        text += f" [{number(factor * low)} to {number(factor * high)}]"
    return words, text
