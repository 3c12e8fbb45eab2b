# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the calibration, then and now, as a plant engineer writes them."""

import re
from typing import NamedTuple

from sklvalve.report.words import number

#: Heads of the table.
HEAD = ("calibration", "then", "expected now, 95 %", "now", "apart, standard deviations")
# parameters that a person asks for
_ASKED = ("capacity", "given_gain", "flow_zero", "position_zero", "meter_lag", "actuator_filter")
# what lies further apart is shown with these, the furthest first, so many of them
_APART, _SHOWN = 2.0, 3
_WORDS = {
    "capacity": "rated capacity Kv",
    "given_gain": "gain of the simulation given",
    "flow_zero": "zero of the flow meter",
    "position_zero": "zero of the position sensor",
    "stem_zero": "zero of the stem",
    "link_play": "play in the linkage",
    "plug_play": "play between stem and plug",
    "plug_overshoot": "swing of the stem after a stroke",
    "dp_zero": "zero of the pressure drop",
    "meter_lag": "lag of the flow meter",
    "meter_ahead": "timing of the flow meter between two rows",
    "fl_scale": "F_L as a multiple of the sheet's",
    "fl_slope": "slope of F_L over the opening",
    "knee": "sharpness of the onset of choking",
    "actuator_filter": "time constant of the actuator",
    "actuator_gain": "gain of the positioner",
    "actuator_reset": "integral action of the positioner",
    "actuator_rate": "speed of the stem",
    "actuator_speed": "speed of the stem",
    "actuator_coulomb": "friction of the stem",
    "actuator_feedback": "pressure feedback of the positioner",
    "actuator_vent": "speed of venting as a multiple of that of filling",
    "actuator_loop": "time constant of the positioner",
    "actuator_delay": "delay of the stem",
    "actuator_dead_band": "dead band of the actuator",
}
_SHARES = {"flow_zero": "", "position_zero": "% of travel", "stem_zero": "% of travel"} | dict.fromkeys(
    ("link_play", "plug_play"), "% of travel"
)


class Then(NamedTuple):
    """One parameter then and now.

    Parameters
    ----------
    cells : tuple of str
        As `HEAD` has them.
    name : str
        Key of diagnosis.json.
    deviations : float
    """

    cells: tuple[str, ...]
    name: str
    deviations: float


def parameter_words(name: str) -> str:
    """Words for a parameter of the calibration; its name without underscores where it has none."""
    point = re.fullmatch(r"(trim|rise)_(\d+)", name)
    if point:
        what = "capacity beside the sheet's curve" if point[1] == "trim" else "rise of the capacity"
        return f"{what}, point {int(point[2]) + 1}"
    return _WORDS.get(name, name.replace("_", " ").replace(".", ", "))


def then_and_now(since: dict) -> list[Then]:
    """All parameters then and now.

    Parameters
    ----------
    since : dict
        ``since_history`` of a diagnosis.
    """
    return [_then(item) for item in since.get("calibration") or []]


def worth_showing(all_rows: list[Then]) -> list[Then]:
    """Parameters that a person asks for, and the few others that lie furthest apart."""
    asked = [row for row in all_rows if row.name in _ASKED]
    others = [row for row in all_rows if row not in asked and abs(row.deviations) >= _APART]
    return [*asked, *sorted(others, key=lambda row: -abs(row.deviations))[:_SHOWN]]


def _then(item: dict) -> Then:
    name, unit = item["name"], "" if item["unit"] == "1" else item["unit"]
    scale = 1.0
    if item["unit"] == "1" and (name in _SHARES or name.startswith("trim_")):
        scale, unit = 100.0, _SHARES.get(name) or "%"
    ends = [number(scale * end) for end in item["ci95"]]
    cells = (
        f"{parameter_words(name)}{f' [{unit}]' if unit else ''}",
        number(scale * item["then"]),
        f"{ends[0]} to {ends[1]}",
        number(scale * item["now"]),
        number(item["deviations"], 2),
    )
    return Then(cells, name, float(item["deviations"]))
