# SPDX-License-Identifier: BSD-3-Clause
"""Names and numbers as a plant engineer says them."""

import re
from collections.abc import Iterable, Sequence
from math import isfinite

# what effects need that only a data sheet can give, as `not_testable` has it
_SHEET = "a data sheet that gives the trim's characteristic"
EFFECTS = {
    "stiction": "stiction",
    "friction": "raised friction of the stem",
    "backlash": "backlash",
    "presliding": "give of the packing before it slides",
    "positioner_deadband": "a dead band of the positioner",
    "spring_fault": "a faulty actuator spring",
    "supply_pressure_drop": "low air supply pressure",
    "actuator_leak": "an air leak of the actuator",
    "rod_bend": "a bent or twisted stem",
    "actuator_lag": "a slow actuator",
    "slew_limit": "a limited stroking speed",
    "dead_time": "a dead time between command and stem",
    "transducer_fault": "a fault of the I/P transducer",
    "positioner_feedback_fault": "a fault of the positioner's feedback",
    "stem_load": "a flow force that shifts the stem",
    "tight_shutoff": "a tight shut-off setting of the positioner",
    "positioner_characteriser": "a characteriser in the positioner",
    "stuck_valve": "a stuck stem",
    "capacity_error": "a capacity other than the data sheet's",
    "wrong_characteristic": "a trim characteristic other than the data sheet's",
    "clogging": "clogging that caps the opening",
    "sedimentation": "deposits growing in the trim",
    "erosion": "erosion of the trim near the seat",
    "seat_leakage": "seat leakage",
    "bypass_open": "an open bypass",
    "external_leakage": "a leak to the outside",
    "choked_flow": "choked flow",
    "cavitation": "cavitation",
    "flashing": "flashing",
    "viscous_flow": "viscous, no longer turbulent flow",
    "gas_expansion": "expansion of the gas",
    "density_change": "a change of density",
    "viscosity_change": "a change of viscosity",
    "piping_reducers": "reducers or fittings at the valve",
    "line_loss": "pressure loss of the line",
    "flow_inertia": "inertia of the liquid in the line",
    "two_phase": "gas carried in the liquid",
    "flow_meter_gain": "a wrong span of the flow meter",
    "flow_meter_bias": "a shifted zero of the flow meter",
    "flow_meter_drift": "a drift of the flow meter",
    "flow_meter_failure": "a failed flow meter",
    "position_sensor_bias": "a shifted zero of the position sensor",
    "position_sensor_gain": "a wrong span of the position sensor",
    "inlet_pressure_bias": "a shifted zero of the inlet pressure sensor",
    "outlet_pressure_bias": "a shifted zero of the outlet pressure sensor",
    "sensor_lag": "a slow sensor",
}

# what has happened where it is a fault, as a clause that follows "Likely fault:"
CLAUSES = {
    "stiction": "the stem sticks and jumps (stiction)",
    "friction": "the stem's friction is too high",
    "backlash": "the stem has play (backlash)",
    "presliding": "the packing gives before it slides",
    "positioner_deadband": "the positioner has a dead band",
    "spring_fault": "the actuator's spring is faulty",
    "supply_pressure_drop": "the air supply pressure is too low",
    "actuator_leak": "the actuator leaks air",
    "rod_bend": "the stem is bent or twisted",
    "actuator_lag": "the actuator is slow",
    "slew_limit": "the stroking speed is limited",
    "dead_time": "the stem answers its command after a dead time",
    "transducer_fault": "the I/P transducer is faulty",
    "positioner_feedback_fault": "the positioner's feedback is faulty",
    "stem_load": "the flow's force shifts the stem",
    "tight_shutoff": "the positioner shuts the valve early (tight shut-off)",
    "positioner_characteriser": "the positioner holds a characteriser",
    "stuck_valve": "the stem is stuck",
    "capacity_error": "the capacity differs from the data sheet's",
    "wrong_characteristic": "the trim's characteristic differs from the data sheet's",
    "clogging": "clogging limits the opening",
    "sedimentation": "deposits grow in the trim",
    "erosion": "the trim is worn near the seat",
    "seat_leakage": "the seat leaks",
    "bypass_open": "a bypass is open",
    "external_leakage": "liquid leaks to the outside",
    "choked_flow": "the flow chokes",
    "cavitation": "the liquid cavitates",
    "flashing": "the liquid flashes",
    "viscous_flow": "the flow is viscous, no longer turbulent",
    "gas_expansion": "the gas expands in the valve",
    "density_change": "the density has changed",
    "viscosity_change": "the viscosity has changed",
    "piping_reducers": "reducers or fittings at the valve take pressure",
    "line_loss": "the line loses pressure",
    "flow_inertia": "the liquid in the line is slow to follow",
    "two_phase": "the liquid carries gas",
    "flow_meter_gain": "the flow meter's span is wrong",
    "flow_meter_bias": "the flow meter's zero has shifted",
    "flow_meter_drift": "the flow meter drifts",
    "flow_meter_failure": "the flow meter has failed",
    "position_sensor_bias": "the position sensor's zero has shifted",
    "position_sensor_gain": "the position sensor's span is wrong",
    "inlet_pressure_bias": "the inlet pressure sensor's zero has shifted",
    "outlet_pressure_bias": "the outlet pressure sensor's zero has shifted",
    "sensor_lag": "a sensor is slow",
}

BLOCKS = {
    "actuator": "in the actuator",
    "valve": "in the valve",
    "line": "in the line",
    "measurement": "in the measurement",
}

ROLES = {"p1": "inlet pressure", "p2": "outlet pressure", None: "times"}

VERDICTS = {
    "no_mismatch": "nothing is missing",
    "named": "likely cause found",
    "none_of_these": "missing physics that no known effect explains",
    "cannot_tell": "something is missing; the recording does not identify what",
}


def verdict_words(d: dict) -> str:
    """Words for the verdict of a diagnosis."""
    if d["verdict"] == "cannot_tell" and not d["mismatch"].get("detected", True):
        if d.get("subject") == "loop":
            return "this recording cannot show whether the valve sticks"
        return "this recording cannot show whether anything is missing"
    levels = {(effect.get("grade") or {}).get("level") for effect in d.get("effects") or []}
    if d["verdict"] == "named" and levels == {"weak"}:
        return "possible cause, weak evidence"
    return VERDICTS[d["verdict"]]


def spoken(name: str) -> str:
    """Words for an effect, or its name without underscores where it has none."""
    return EFFECTS.get(name, name.replace("_", " "))


def role_words(role: str | None) -> str:
    """Words for a role."""
    return ROLES.get(role, str(role).replace("_", " "))


def either(items: Sequence[str], last: str = "or") -> str:
    """Words joined as a list is spoken: a, b or c."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {last} {items[-1]}"


def class_words(members: Iterable[dict], limit: int = 3) -> str:
    """Words for a class of effects that cannot be distinguished, most probable first."""
    return _shortened([spoken(member["name"]) for member in members], limit)


def class_clause(members: Iterable[dict], limit: int = 3) -> str:
    """The same as clauses: ``the seat leaks or a bypass is open``."""
    names = [member["name"] for member in members]
    return _shortened([CLAUSES.get(name, f"there is {spoken(name)}") for name in names], limit)


def _shortened(names: list[str], limit: int) -> str:
    if len(names) > limit:
        names = [*names[: limit - 1], f"one of {len(names) - limit + 1} others"]
    return either(names)


def block_words(blocks: Sequence[str], last: str = "or") -> str:
    """Words for the places where an effect may sit: in the actuator or in the valve."""
    return either([BLOCKS.get(block, f"in the {block}") for block in blocks], last)


def unsaid(words: str, blocks: Sequence[str]) -> list[str]:
    """Blocks to be named after these words: none where the words name them all ("a slow actuator")."""
    said = all(re.search(rf"\b{re.escape(block)}\b", words) for block in blocks)
    return [] if said else list(blocks)


def class_in_block(effect: dict, limit: int = 3) -> str:
    """Words for a class of effects and where it sits."""
    words = class_words(effect["members"], limit)
    return f"{words} {block_words(unsaid(words, effect['blocks']))}".rstrip()


def number(value: float | None, digits: int = 3) -> str:
    """A few significant digits without an exponent where a person would write none."""
    if value is None or not isfinite(value):
        return "unknown"
    short = f"{value:.{digits}g}"
    if "e" in short and 1e-4 <= abs(value) < 1e7:
        short = f"{float(short):.7f}".rstrip("0").rstrip(".")
    return short


def with_units(words: str) -> str:
    """Words whose numbers stay on one line with their units."""
    return re.sub(
        r"(?<=\d) (?=(?:%|s|h|m3/h|kPa|bar|nats)(?!\w))|(?<=\bp) (?=[<=])|(?<=\bp [<=]) (?=\d)",
        "\N{NO-BREAK SPACE}",
        words,
    )


def with_unit(value: float | None, unit: str | None) -> str:
    """Value and unit as they are written; a pure number has none."""
    return number(value) + (f" {unit}" if unit and unit != "1" else "")


def in_recorded(d: dict, role: str, share: float) -> str:
    """A share of a signal's span in its recorded unit, where the diagnosis has the span."""
    span, unit = (d.get("spans") or {}).get(role), (d.get("units") or {}).get(role)
    if role == "opening" or not span or not unit:
        return f"{percent(share)} of {'travel' if role == 'opening' else 'span'}"
    return with_unit(float(f"{span * share:.2g}"), unit)


def percent(share: float | None) -> str:
    """A share of one as percent: whole numbers where that is fine enough."""
    if share is None or not isfinite(share):
        return "unknown"
    value = 100.0 * share
    if value < 1.0 or 99.0 < value < 100.0:
        return f"{value:.1f} %"
    return f"{value:.0f} %"


def chance(probability: float | None) -> str:
    """A probability as percent; certainty is never claimed, and none where it was not checked."""
    if probability is None:
        return "not known"
    return "> 99 %" if probability > 0.99 else percent(probability)


def right(probability: float) -> str:
    """A checked frequency as a share of cases; certainty is never claimed."""
    return "more than 99 %" if probability > 0.99 else f"{100.0 * probability:.0f} %"


def sure(effect: dict) -> str:
    """How sure a finding is: how often such a one was right, else its grade."""
    probability = effect.get("probability")
    if probability is None:
        return f"{(effect.get('grade') or {}).get('level') or 'unknown'} evidence"
    return f"right in {right(probability)} of blind tests"


def likeliest_first(members: Iterable[dict]) -> list[dict]:
    """Members of one or several classes, most probable first; as given where no probability is known."""
    return sorted(members, key=lambda member: -(member.get("probability") or 0.0))


def named_effects(d: dict) -> list[dict]:
    """Findings to speak of first: all but the weak ones, where others are stronger."""
    effects = d.get("effects") or []
    sure = [each for each in effects if (each.get("grade") or {}).get("level") != "weak"]
    return sure or effects


def p_words(p_value: float | None) -> str:
    """P-value as it is usually printed."""
    if p_value is None:
        return "p unknown"
    return "p < 0.001" if p_value < 0.001 else f"p = {number(p_value)}"


def lacks_sheet(d: dict) -> bool:
    """Whether effects could not be asked for want of a data sheet: capacity and trim were learnt, then."""
    return any(each.get("needs") == _SHEET for each in d.get("not_testable") or [])
