# SPDX-License-Identifier: BSD-3-Clause
"""What the engineer knows of a valve and of its recording: valve.toml."""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path

from sklvalve.recording import _checks as check
from sklvalve.recording.errors import InputError, hint
from sklvalve.recording.signal import OPENING_ROLES, ROLES, Signal
from sklvalve.recording.units import UNITS, quantity_of

Table = tuple[tuple[float, float], ...]

_KV_OF_CV = 0.8649777  # m3/h of a US gallon a minute, at 1 bar instead of 1 psi
_MM = check.Number("mm", 1e-3)
_KPA = check.Number("kPa", 1e3)
_FACTOR = check.Number(high=1.0)

# section -> key -> check; the checks give SI
_KEYS: dict[str, dict[str, check.Check]] = {
    "valve": {
        "tag": check.text,
        "kv_rated": check.Number("m3/h"),
        "cv_rated": check.Number("US gallons a minute at 1 psi", _KV_OF_CV),
        "characteristic": check.characteristic,
        "rangeability": check.Number(low=1.0),
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
        "density": check.Number("kg/m3"),
        "kinematic_viscosity": check.Number("m2/s"),
        "vapour_pressure": check.Number("kPa, absolute", 1e3, open_low=False),
        "critical_pressure": check.Number("kPa, absolute", 1e3),
        "molar_mass": check.Number("kg/kmol", 1e-3),
        "heat_capacity_ratio": check.Number(low=1.0),
        "compressibility": check.Number(high=10.0),
    },
    "actuator": {
        "fail": check.one_of("closed", "open"),
        "supply_pressure": _KPA,
        "spring_range": check.rising_pair(check.Number("kPa", 1e3, open_low=False)),
        "effective_area": check.Number("cm2", 1e-4),
        "positioner": check.flag,
    },
    "simulation": {"physics": check.names_list},
}
_SIGNAL_KEYS = ("column", "constant", "unit", "sense", "gauge")
_SCALES = {
    **dict.fromkeys(("nominal_size", "inlet_pipe", "outlet_pipe", "travel"), 1e-3),
    **dict.fromkeys(("supply_pressure", "spring_range", "vapour_pressure", "critical_pressure"), 1e3),
    "effective_area": 1e-4,
    "molar_mass": 1e-3,
}


@dataclass(frozen=True)
class Valve:
    """A control valve as its data sheet gives it, and how its recording is laid out; None where not known.

    Parameters
    ----------
    tag : str or None
        Name of the valve in the plant.
    kv_rated : float or None
        Rated flow coefficient [m3/h]; in the file ``kv_rated``, or ``cv_rated`` times 0.8649777.
    characteristic : str, tuple of (opening, kv / kv_rated) pairs, or None
        Inherent characteristic of the trim.
    rangeability : float or None
        Inherent rangeability of the trim [1].
    shutoff : float or None
        Opening below which the trim closes down, linearly, to nothing [1].
    fl : float, tuple of (opening, value) pairs, or None
        Pressure recovery factor, the same at every opening or by opening [1].
    fd, xt : float or None
        Valve style modifier; pressure drop ratio at choking [1].
    nominal_size, inlet_pipe, outlet_pipe, travel : float or None
        Sizes and rated travel [m]; in the file in mm.
    fluid : dict
        Key -> value of section ``[fluid]``, in SI (pressures absolute [Pa], ``molar_mass`` [kg/mol]).
    fail : {"closed", "open"} or None
        Where the spring drives the valve without air.
    supply_pressure : float or None
        Air supply [Pa, gauge].
    spring_range : tuple (low, high) or None
        Bench range of the spring [Pa, gauge].
    effective_area : float or None
        Effective area of the diaphragm [m2].
    positioner : bool or None
        Whether the valve has one.
    physics : tuple of str
        Effects that the simulation holds already.
    roles : dict
        Role -> `Signal`.
    time : str
        Column of the time.
    source : str
        Where this came from, for messages.

    Examples
    --------
    >>> from sklvalve.recording import Valve
    >>> valve = Valve.from_dict({"valve": {"cv_rated": 10.0, "nominal_size": 50.0}})
    >>> round(valve.kv_rated, 3), valve.nominal_size, valve.fl
    (8.65, 0.05, None)
    """

    tag: str | None = None
    kv_rated: float | None = None
    characteristic: str | Table | None = None
    rangeability: float | None = None
    shutoff: float | None = None
    fl: float | Table | None = None
    fd: float | None = None
    xt: float | None = None
    nominal_size: float | None = None
    inlet_pipe: float | None = None
    outlet_pipe: float | None = None
    travel: float | None = None
    fluid: dict[str, str | float] = field(default_factory=dict)
    fail: str | None = None
    supply_pressure: float | None = None
    spring_range: tuple[float, float] | None = None
    effective_area: float | None = None
    positioner: bool | None = None
    physics: tuple[str, ...] = ()
    roles: dict[str, Signal] = field(default_factory=dict)
    time: str = "time"
    source: str = field(default="valve", compare=False)

    @classmethod
    def from_dict(cls, data: Mapping[str, object], *, source: str = "valve") -> "Valve":
        """Build a valve from plain data in the structure, and the units, of valve.toml.

        Parameters
        ----------
        data : mapping
            Sections ``valve``, ``fluid``, ``actuator``, ``simulation``, ``recording``, each optional.
        source : str, default="valve"
            What messages call the data; `read_valve` gives the path.

        Returns
        -------
        valve : Valve

        Raises
        ------
        InputError
            If a section, key or role is not known, or a value has the wrong type or is out of range.

        Examples
        --------
        >>> from sklvalve.recording import Valve
        >>> data = {"recording": {"p1": {"column": "P1", "unit": "kPa", "gauge": True}}}
        >>> Valve.from_dict(data).roles["p1"].gauge
        True
        """
        known = (*_KEYS, "recording")
        for name in data:
            if name not in known:
                raise InputError(f"{source}: [{name}] is no known section; {hint(name, known)}")
        found: dict[str, dict[str, object]] = {}
        for name, keys in _KEYS.items():
            found[name] = _read_section(_section(data, name, source), keys, f"{source}: [{name}]")
        valve = found["valve"]
        if "cv_rated" in valve:
            if "kv_rated" in valve:
                raise InputError(f"{source}: [valve] gives kv_rated and cv_rated; keep one of them")
            valve["kv_rated"] = valve.pop("cv_rated")
        recording = dict(_section(data, "recording", source)) time = check.text(recording.pop("time", "time"),
        f"{source}: [recording] time") travel = valve.get("travel") roles = {role: _read_role(role, value,
        travel, source) for role, value in recording.items()} fields = {**valve, **found["actuator"],
        **found["simulation"]} return cls(**fields, fluid=found["fluid"], roles=roles, time=time,
        source=source)  # type: ignore[arg-type]

    def to_dict(self) -> dict[str, dict[str, object]]:
        """Plain data in the structure and the units of valve.toml, fit for JSON and for `from_dict`.

        Returns
        -------
        data : dict of dict
            Only what is known; numbers to 12 digits, so that conversions leave no trace.

        Examples
        --------
        >>> from sklvalve.recording import Valve
        >>> Valve(tag="FV-101", travel=0.0381).to_dict()
        {'valve': {'tag': 'FV-101', 'travel': 38.1}, 'recording': {'time': 'time'}}
        """
        data: dict[str, dict[str, object]] = {}
        for name, keys in _KEYS.items():
            values = self.fluid if name == "fluid" else {key: getattr(self, key, None) for key in keys}
            section = {
                key: _plain(value, _SCALES.get(key, 1.0))
                for key, value in values.items()
                if value is not None
            }
            if section and section != {"physics": []}:
                data[name] = section
        data["recording"] = {"time": self.time}
        for role, signal in self.roles.items():
            entry: dict[str, object] = {
                "column": signal.column,
                "constant": signal.constant,
                "unit": signal.unit,
            }
            if role in OPENING_ROLES:
                entry["sense"] = signal.sense
            if signal.quantity == "pressure":
                entry["gauge"] = signal.gauge
            data["recording"][role] = {key: value for key, value in entry.items() if value is not None}
        return data


def read_valve(path: str | PathLike[str]) -> Valve:
    """Read what is known of a valve from a valve.toml file.

    Parameters
    ----------
    path : str or path-like
        The file; `docs/valve_toml.md` describes every key.

    Returns
    -------
    valve : Valve

    Raises
    ------
    InputError
        If the file is missing, is no TOML, or holds a section, key or value that cannot be used.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> from sklvalve.recording import read_valve
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "valve.toml"
    ...     _ = path.write_text("[valve]\\nkv_rated = 40.0\\n")
    ...     read_valve(path).kv_rated
    40.0
    """
    file = Path(path)
    try:
        content = file.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{file}: no such file; give the path of the valve.toml") from None
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror}); give a file that can") from None
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise InputError(f"{file}: line {line} is no UTF-8 text; save the file as UTF-8") from None
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(_toml_sentence(file, text, str(error))) from None
    return Valve.from_dict(data, source=str(file))


def _toml_sentence(file: Path, text: str, message: str) -> str:
    place = re.search(r"\(at line (\d+), column (\d+)\)", message)
    if place:
        line, column = int(place[1]), int(place[2])
    else:  # the parser says only that the text ended too early
        lines = text.splitlines() or [""]
        line, column = len(lines), len(lines[-1]) + 1
    reason = message.split(" (at ")[0]
    return f"{file}: line {line}, column {column} is no valid TOML ({reason}); correct that line"


def _section(data: Mapping[str, object], name: str, source: str) -> Mapping[str, object]:
    section = data.get(name, {})
    if not isinstance(section, Mapping):
        raise InputError(f"{source}: {name} must be a section [{name}]; got {section!r}")
    return section


def _read_section(
    section: Mapping[str, object], keys: dict[str, check.Check], where: str
) -> dict[str, object]:
    for key in section:
        if key not in keys:
            raise InputError(f"{where} knows no key {key!r}; {hint(key, keys)}")
    return {key: keys[key](value, f"{where} {key}") for key, value in section.items()}


def _read_role(role: str, value: object, travel: object, source: str) -> Signal:
    if role not in ROLES:
        raise InputError(f"{source}: [recording.{role}] is no known role; {hint(role, ROLES)}")
    where = f"{source}: [recording.{role}]"
    if not isinstance(value, Mapping):
        raise InputError(f"{where} must be a section with column and unit; got {value!r}")
    for key in value:
        if key not in _SIGNAL_KEYS:
            raise InputError(f"{where} knows no key {key!r}; {hint(key, _SIGNAL_KEYS)}")
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
        raise InputError(f"{where} unit = {unit!r} is no known unit of this role; {near}{more}")
    return unit


def _plain(value: object, scale: float) -> object:
    if isinstance(value, tuple):
        return [_plain(item, scale) for item in value]
    if isinstance(value, float):
        return float(f"{value / scale:.12g}")
    return value
