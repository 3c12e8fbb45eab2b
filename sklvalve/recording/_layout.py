# SPDX-License-Identifier: BSD-3-Clause
"""What a valve.toml may hold: its sections and keys, and how each value is read and written."""

from collections.abc import Mapping

from sklvalve.recording import _checks as check
from sklvalve.recording.errors import InputError, hint
from sklvalve.recording.signal import OPENING_ROLES, ROLES, Signal
from sklvalve.recording.units import UNITS, quantity_of

_KV_OF_CV = 0.8649777  # m3/h of a US gallon a minute, at 1 bar instead of 1 psi
_MM = check.Number("mm", 1e-3, high=1e6)
# wide of all that is built, and near enough for a simulation of the actuator to come to an end
_AIR = check.Number("kPa", 1e3, low=10.0, high=2000.0, open_low=False)
_SPRING = check.Number("kPa", 1e3, high=1000.0, open_low=False)
_NARROWEST_SPRING = 5.0  # kPa
_FACTOR = check.Number(high=1.0)
_SLOWEST = 3600.0  # s; the largest gate valves take some minutes

# section -> key -> check; the checks give SI
KEYS: dict[str, dict[str, check.Check]] = {
    "valve": {
        "tag": check.text,
        "kv_rated": check.Number("m3/h", high=1e6),
        "cv_rated": check.Number("US gallons a minute at 1 psi", _KV_OF_CV, high=1e6),
        "characteristic": check.characteristic,
        "rangeability": check.Number(low=1.0, high=1e6),
        "shutoff": check.Number(low=0.0, high=1.0, open_low=False, open_high=True),
        "fl": check.number_or_table(_FACTOR),
        "fd": check.Number(high=2.0),
        "xt": _FACTOR,
        "nominal_size": _MM,
        "inlet_pipe": _MM,
        "outlet_pipe": _MM,
        "travel": _MM,
    },
    "fluid": {
        "name": check.text,
        "density": check.Number("kg/m3", high=1e5),
        "kinematic_viscosity": check.Number("m2/s", high=1e3),
        "vapour_pressure": check.Number("kPa, absolute", 1e3, high=1e6),
        # that of helium, the lowest there is, is 227 kPa
        "critical_pressure": check.Number("kPa, absolute", 1e3, low=200.0, high=1e6, open_low=False),
        "molar_mass": check.Number("kg/kmol", 1e-3, high=1e4),
        "heat_capacity_ratio": check.Number(low=1.0, high=10.0),
        "compressibility": check.Number(high=10.0),
    },
    "actuator": {
        "kind": check.or_left_out(check.one_of("pneumatic", "electric", "hydraulic", "unknown")),
        "stroke_time": check.or_left_out(check.Number("s", high=_SLOWEST)),
        "dead_time": check.or_left_out(check.Number("s", high=_SLOWEST, open_low=False)),
        # of a band as wide as this nothing of the travel would be left
        "dead_band": check.or_left_out(check.Number("% of travel", 1e-2, high=50.0, open_low=False)),
        "fail": check.one_of("closed", "open"),
        "supply_pressure": _AIR,
        "spring_range": check.rising_pair(_SPRING, _NARROWEST_SPRING),
        "effective_area": check.Number("cm2", 1e-4, high=1e6),
        "positioner": check.flag,
    },
    "simulation": {"physics": check.names_list},
}
#: Keys of [fluid] that only a gas has.
GAS_KEYS = ("molar_mass", "heat_capacity_ratio", "compressibility")
#: Fluids whose properties are known by name.
FLUIDS = ("water",)
_SIGNAL_KEYS = ("column", "constant", "unit", "sense", "gauge")
SCALES = {
    **dict.fromkeys(("nominal_size", "inlet_pipe", "outlet_pipe", "travel"), 1e-3),
    **dict.fromkeys(("supply_pressure", "spring_range", "vapour_pressure", "critical_pressure"), 1e3),
    "effective_area": 1e-4,
    "dead_band": 1e-2,
    "molar_mass": 1e-3,
}


def section(data: Mapping[str, object], name: str, source: str) -> Mapping[str, object]:
    section = data.get(name, {})
    if not isinstance(section, Mapping):
        raise InputError(f"{source}: {name} must be a section [{name}]; got {check.shown(section)}")
    return section


def read_section(
    section: Mapping[str, object], keys: dict[str, check.Check], where: str
) -> dict[str, object]:
    for key in section:
        if key not in keys:
            raise InputError(f"{where} knows no key {check.shown(key)}; {hint(key, keys)}")
    return {key: keys[key](value, f"{where} {key}") for key, value in section.items()}


def require_known_fluid(fluid: Mapping[str, object], source: str) -> None:
    """A name that is not known must come with a density, or with what makes it a gas."""
    name = fluid.get("name", FLUIDS[0])
    if name not in FLUIDS and not {"density", *GAS_KEYS} & fluid.keys():
        raise InputError(
            f"{source}: [fluid] name = {check.shown(name)} is no known fluid; give its density in kg/m3, or "
            f"write a name that is known ({', '.join(FLUIDS)})"
        )


def read_role(role: str, value: object, travel: object, source: str) -> Signal:
    if role not in ROLES:
        raise InputError(f"{source}: [recording.{role}] is no known role; {hint(role, ROLES)}")
    where = f"{source}: [recording.{role}]"
    if not isinstance(value, Mapping):
        raise InputError(f"{where} must be a section with column and unit; got {check.shown(value)}")
    for key in value:
        if key not in _SIGNAL_KEYS:
            raise InputError(f"{where} knows no key {check.shown(key)}; {hint(key, _SIGNAL_KEYS)}")
    if ("column" in value) == ("constant" in value):
        raise InputError(f"{where} must give either a column or a constant, and not both")
    unit = _read_unit(role, value, where)
    quantity = quantity_of(unit)
    if "sense" in value and role not in OPENING_ROLES:
        raise InputError(
            f"{where} has a sense, which belongs to {', '.join(OPENING_ROLES)} only; leave it out"
        )
    if "gauge" in value and quantity != "pressure":
        raise InputError(f"{where} has gauge, which belongs to pressures only; leave it out")
    as_length = role in OPENING_ROLES and quantity == "length"
    if as_length and not isinstance(travel, float):
        raise InputError(f"{where} is recorded in {unit}, so give the rated travel in [valve] travel, in mm")
    return Signal(
        column=check.text(value["column"], f"{where} column") if "column" in value else None,
        constant=check.plain_number(value["constant"], f"{where} constant") if "constant" in value else None,
        unit=unit,
        sense=str(check.one_of("opening", "closing")(value.get("sense", "opening"), f"{where} sense")),
        gauge=check.flag(value.get("gauge", False), f"{where} gauge"),
        travel=travel if as_length and isinstance(travel, float) else None,
    )


def _read_unit(role: str, value: Mapping[str, object], where: str) -> str:
    units = [unit for quantity in ROLES[role] for unit in UNITS[quantity]]
    if "unit" not in value:
        raise InputError(f"{where} has no unit; add unit = one of {', '.join(units)}")
    unit = value["unit"]
    if not isinstance(unit, str) or unit not in units:
        near = hint(unit, units)
        more = f" (known are {', '.join(units)})" if near.startswith("did") else ""
        raise InputError(f"{where} unit = {check.shown(unit)} is no known unit of this role; {near}{more}")
    return unit


def plain(value: object, scale: float) -> object:
    if isinstance(value, tuple):
        return [plain(item, scale) for item in value]
    if isinstance(value, float):
        return float(f"{value / scale:.12g}")
    return value
