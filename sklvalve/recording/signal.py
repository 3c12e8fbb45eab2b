# SPDX-License-Identifier: BSD-3-Clause
"""The roles that signals play, and how one of them stands in a recording."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sklvalve.recording.units import SI_UNITS, UNITS, from_si, quantity_of, to_si

_POSITION = ("fraction", "length")
_PRESSURE = ("pressure",)
_FLOW = ("volume flow", "mass flow")
_ANY = tuple(quantity for quantity in UNITS if quantity != "time")

#: Quantities that a role may be recorded in, the usual one first.
ROLES: dict[str, tuple[str, ...]] = {
    "command": ("fraction",),
    "opening": _POSITION,
    "p1": _PRESSURE,
    "p2": _PRESSURE,
    "temperature": ("temperature",),
    "flow": _FLOW,
    "actuator_pressure": _PRESSURE,
    "supply_pressure": _PRESSURE,
    "setpoint": _ANY,
    "process_value": _ANY,
    "simulated_flow": _FLOW,
    "simulated_opening": _POSITION,
}

#: Roles that say how far open the valve is (0 = shut, 1 = open), whichever sense they are recorded in.
OPENING_ROLES = ("command", "opening", "simulated_opening")


@dataclass(frozen=True)
class Signal:
    """Where one signal of a recording stands, and in which unit.

    Parameters
    ----------
    column : str or None
        Column of the recording; None where the signal is a constant.
    constant : float or None
        Value of a constant signal, in `unit`.
    unit : str
        Unit in the recording.
    sense : {"opening", "closing"}, default="opening"
        For command and position: whether a larger number means further open or further shut.
    gauge : bool, default=False
        For pressures: above the atmosphere (101325 Pa) instead of absolute.
    travel : float or None
        Rated travel [m], where position is recorded as a length.

    Examples
    --------
    >>> from sklvalve.recording.signal import Signal
    >>> Signal("X", None, "%", sense="closing").to_si([100.0, 25.0])
    array([0.  , 0.75])
    """

    column: str | None
    constant: float | None
    unit: str
    sense: str = "opening"
    gauge: bool = False
    travel: float | None = None

    @property
    def quantity(self) -> str:
        """What the recorded unit measures."""
        return quantity_of(self.unit) or "unknown"

    @property
    def mass_flow(self) -> bool:
        """Whether a flow is recorded by mass instead of by volume."""
        return self.quantity == "mass flow"

    @property
    def si_unit(self) -> str:
        """SI unit of the signal inside the package; an opening is a fraction even where recorded in mm."""
        return "1" if self.travel is not None else SI_UNITS[self.quantity]

    def to_si(self, values: ArrayLike) -> NDArray[np.float64]:
        """Recorded values to SI: gauge to absolute pressure, closing to opening, length to fraction."""
        si = to_si(values, self.unit, self.quantity, gauge=self.gauge)
        if self.travel is not None:
            si = si / self.travel
        return 1.0 - si if self.sense == "closing" else si

    def from_si(self, values: ArrayLike) -> NDArray[np.float64]:
        """Convert SI values to what the recording would hold, the inverse of `to_si`."""
        si = np.asarray(values, dtype=np.float64)
        if self.sense == "closing":
            si = 1.0 - si
        if self.travel is not None:
            si = si * self.travel
        return from_si(si, self.unit, self.quantity, gauge=self.gauge)

    @property
    def slope(self) -> float:
        """Size of one recorded unit in SI, without sign (0.01 for %)."""
        return float(abs(np.diff(self.to_si([0.0, 1.0]))[0]))


def si_signal(role: str, *, column: str | None = None, mass_flow: bool = False) -> Signal:
    """Signal of a role that is recorded in SI already."""
    quantity = "mass flow" if mass_flow and "mass flow" in ROLES[role] else ROLES[role][0]
    return Signal(column or role, None, SI_UNITS[quantity])
