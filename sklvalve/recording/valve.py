# SPDX-License-Identifier: BSD-3-Clause
"""What the engineer knows of a valve and of its recording: valve.toml."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path

from sklvalve.recording import _checks as check
from sklvalve.recording._agreement import require_agreement
from sklvalve.recording._layout import (
    KEYS,
    SCALES,
    plain,
    read_role,
    read_section,
    require_known_fluid,
    section,
)
from sklvalve.recording.errors import InputError, hint, shown
from sklvalve.recording.signal import OPENING_ROLES, Signal
from sklvalve.recording.toml_file import read_toml

Table = tuple[tuple[float, float], ...]


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
    kind : {"pneumatic", "electric", "hydraulic", "unknown"} or None
        What drives the stem.
    stroke_time, dead_time : float or None
        Time of a stroke over the whole travel, and from a command to the first movement [s].
    dead_band : float or None
        How far the command may turn back before the stem follows [1 = travel]; in the file in % of travel.
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
    kind: str | None = None
    stroke_time: float | None = None
    dead_time: float | None = None
    dead_band: float | None = None
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
            If a section, key, role or fluid is not known, a value has the wrong type or is out of range, an
            equal-percentage trim has no rangeability, two roles name one column, or two values contradict
            each other.

        Examples
        --------
        >>> from sklvalve.recording import Valve
        >>> data = {"recording": {"p1": {"column": "P1", "unit": "kPa", "gauge": True}}}
        >>> Valve.from_dict(data).roles["p1"].gauge
        True
        """
        known = (*KEYS, "recording")
        for name in data:
            if name not in known:
                raise InputError(f"{source}: [{shown(name)[1:-1]}] is no known section; {hint(name, known)}")
        found: dict[str, dict[str, object]] = {}
        for name, keys in KEYS.items():
            found[name] = read_section(section(data, name, source), keys, f"{source}: [{name}]")
        valve = found["valve"]
        if "cv_rated" in valve:
            if "kv_rated" in valve:
                raise InputError(f"{source}: [valve] gives kv_rated and cv_rated; keep one of them")
            valve["kv_rated"] = valve.pop("cv_rated")
        if valve.get("characteristic") == "equal_percentage" and "rangeability" not in valve:
            raise InputError(
                f'{source}: [valve] characteristic = "equal_percentage" needs rangeability, a number above '
                '1; add it, or write characteristic = "unknown"'
            )
        require_known_fluid(found["fluid"], source)
        recording = dict(section(data, "recording", source))
        time = check.text(recording.pop("time", "time"), f"{source}: [recording] time")
        travel = valve.get("travel")
        roles = {role: read_role(role, value, travel, source) for role, value in recording.items()}
        require_agreement(found["fluid"], found["actuator"], roles, time, source)
        fields = {**valve, **found["actuator"], **found["simulation"]}
        return cls(**fields, fluid=found["fluid"], roles=roles, time=time, source=source)  # type: ignore[arg-type]

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
        for name, keys in KEYS.items():
            values = self.fluid if name == "fluid" else {key: getattr(self, key, None) for key in keys}
            written = {
                key: plain(value, SCALES.get(key, 1.0)) for key, value in values.items() if value is not None
            }
            if written and written != {"physics": []}:
                data[name] = written
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
        The file; :doc:`/valve_toml` describes every key.

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
    if file.name.lower().endswith((".csv", ".csv.gz", ".parquet")):
        raise InputError(f"{file}: this is named as a recording is; give the valve.toml")
    data = read_toml(file, missing="give the path of the valve.toml", folder="give the valve.toml in it")
    return Valve.from_dict(data, source=str(file))
