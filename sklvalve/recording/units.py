# SPDX-License-Identifier: BSD-3-Clause
"""Units of recordings, converted once at the border; inside the package everything is SI."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sklvalve.recording.errors import InputError, hint

STANDARD_ATMOSPHERE = 101325.0  # Pa; what a gauge pressure lacks

_US_GALLON = 3.785411784e-3  # m3

# unit -> factor, offset: value in SI = factor * value + offset
_TABLE: dict[str, dict[str, tuple[float, float]]] = {
    "fraction": {"1": (1.0, 0.0), "%": (0.01, 0.0)},
    "pressure": {
        "Pa": (1.0, 0.0),
        "kPa": (1e3, 0.0),
        "MPa": (1e6, 0.0),
        "bar": (1e5, 0.0),
        "mbar": (1e2, 0.0),
        "psi": (6894.757293168361, 0.0),
        "cmH2O": (98.0665, 0.0),
        "mmHg": (133.322387415, 0.0),
    },
    "temperature": {"K": (1.0, 0.0), "degC": (1.0, 273.15), "degF": (5.0 / 9.0, 273.15 - 32.0 * 5.0 / 9.0)},
    "volume flow": {
        "m3/s": (1.0, 0.0),
        "m3/h": (1.0 / 3600.0, 0.0),
        "l/s": (1e-3, 0.0),
        "l/min": (1e-3 / 60.0, 0.0),
        "cm3/s": (1e-6, 0.0),
        "gpm": (_US_GALLON / 60.0, 0.0),
    },
    "mass flow": {"kg/s": (1.0, 0.0), "kg/h": (1.0 / 3600.0, 0.0), "t/h": (1.0 / 3.6, 0.0)},
    "length": {"m": (1.0, 0.0), "mm": (1e-3, 0.0)},
    "time": {"s": (1.0, 0.0), "min": (60.0, 0.0), "h": (3600.0, 0.0)},
}

#: Known units of each quantity, the SI unit first.
UNITS: dict[str, tuple[str, ...]] = {quantity: tuple(units) for quantity, units in _TABLE.items()}

#: The SI unit of each quantity.
SI_UNITS: dict[str, str] = {quantity: units[0] for quantity, units in UNITS.items()}

_QUANTITY_OF = {unit: quantity for quantity, units in UNITS.items() for unit in units}


def quantity_of(unit: str) -> str | None:
    """Quantity that a unit measures (``"pressure"`` for ``"kPa"``), or None for a unit that is not known."""
    return _QUANTITY_OF.get(unit)


def _factor_and_offset(unit: str, quantity: str, gauge: bool) -> tuple[float, float]:
    if quantity not in _TABLE:
        raise InputError(f"{quantity!r} is no known quantity; {hint(quantity, _TABLE)}")
    if unit not in _TABLE[quantity]:
        near = hint(unit, UNITS[quantity])
        more = f" (known are {', '.join(UNITS[quantity])})" if near.startswith("did") else ""
        raise InputError(f"{unit!r} is no known unit of {quantity}; {near}{more}")
    if gauge and quantity != "pressure":
        raise InputError(f"gauge belongs to pressures only, not to {quantity}; leave it out")
    factor, offset = _TABLE[quantity][unit]
    return factor, offset + (STANDARD_ATMOSPHERE if gauge else 0.0)


def to_si(values: ArrayLike, unit: str, quantity: str, *, gauge: bool = False) -> NDArray[np.float64]:
    r"""Convert recorded values to SI.

    .. math:: v_{SI} = a v + b

    with the factor *a* and the offset *b* of the unit; a gauge pressure gets 101325 Pa more, the standard
    atmosphere. Flow stays what it is: mass in kg/s, volume in m3/s.

    Parameters
    ----------
    values : array-like of shape (n,) or float
        Values in `unit`; NaN stays NaN.
    unit : str
        A known unit of `quantity`, spelt as in `UNITS`.
    quantity : {"fraction", "pressure", "temperature", "volume flow", "mass flow", "length", "time"}
        What the values measure.
    gauge : bool, default=False
        Whether pressures are above the atmosphere instead of absolute.

    Returns
    -------
    si : ndarray of shape (n,), float64
        The values in 1, Pa, K, m3/s, kg/s, m or s.

    Raises
    ------
    InputError
        If the unit is not one of the quantity, or gauge is asked for something that is no pressure.

    Examples
    --------
    >>> from sklvalve.recording.units import to_si
    >>> to_si([0.0, 2.0], "bar", "pressure", gauge=True)
    array([101325., 301325.])
    """
    factor, offset = _factor_and_offset(unit, quantity, gauge)
    return factor * np.asarray(values, dtype=np.float64) + offset


def from_si(values: ArrayLike, unit: str, quantity: str, *, gauge: bool = False) -> NDArray[np.float64]:
    """Convert SI values back to a unit, the inverse of `to_si`.

    Parameters
    ----------
    values : array-like of shape (n,) or float
        Values in SI.
    unit, quantity, gauge
        As in `to_si`.

    Returns
    -------
    recorded : ndarray of shape (n,), float64
        The values in `unit`.

    Raises
    ------
    InputError
        As in `to_si`.

    Examples
    --------
    >>> from sklvalve.recording.units import from_si
    >>> from_si([300.15], "degC", "temperature")
    array([27.])
    """
    factor, offset = _factor_and_offset(unit, quantity, gauge)
    return (np.asarray(values, dtype=np.float64) - offset) / factor
