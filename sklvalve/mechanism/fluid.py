# SPDX-License-Identifier: BSD-3-Clause
"""The fluid: its properties by temperature, from a formula, a number or the user's function."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sklvalve.mechanism.liquid import WATER_CRITICAL_PRESSURE
from sklvalve.mechanism.validity import MissingDatum, warn_rows
from sklvalve.mechanism.water import water_density, water_kinematic_viscosity, water_vapour_pressure

GAS_CONSTANT = 8.314462618
"""Molar gas constant; the paper's 287 is the specific constant of dry air. [J/(mol K)]"""

WATER_CLAUSIUS_CLAPEYRON = {"p_ref": 12351.95, "t_ref": 323.15, "enthalpy": 42911.0}
"""Water about 50 degC: within 13 % of IAPWS-95 from 0 to 150 degC."""

WATER_ANTOINE = {"a": 8.07131, "b": 1730.63, "c": 233.426, "form": "log10_mmHg"}
"""Water, 1 to 100 degC: within 1.2 % of IAPWS-95 from 0 to 150 degC."""

STANDARD_TEMPERATURE = 293.15
"""Temperature taken where none is given: 20 degC. [K]"""

_SWITCHABLE = (water_density, water_vapour_pressure, water_kinematic_viscosity)
_PROPERTIES = ("density", "vapour_pressure", "kinematic_viscosity")


@dataclass(frozen=True)
class Fluid:
    """A liquid as the valve equations need it. Make one with `fluid_from`.

    Parameters
    ----------
    name : str
        Name for people.
    properties : dict
        For each known one of ``density`` [kg/m3], ``vapour_pressure`` [Pa], ``kinematic_viscosity`` [m2/s] a
        number or a function of the temperature [K].
    critical_pressure : float or None, default=None
        Thermodynamic critical pressure. [Pa]

    Examples
    --------
    >>> oil = Fluid("oil", {"density": 870.0})
    >>> oil.density(), oil.knows("vapour_pressure")
    (870.0, False)
    """

    name: str
    properties: dict[str, float | Callable]
    critical_pressure: float | None = None

    def knows(self, what):
        """Whether `what`, a property or ``critical_pressure``, is given. False for what the fluid lacks."""
        if what == "critical_pressure":
            return self.critical_pressure is not None
        return what in self.properties

    def density(self, temperature=None, *, warn=True):
        """Density [kg/m3] at `temperature` [K]; None is 20 degC. ValueError where it is not given."""
        return self._at("density", temperature, warn)

    def vapour_pressure(self, temperature=None, *, warn=True):
        """Vapour pressure [Pa] at `temperature` [K]; None is 20 degC. ValueError where it is not given."""
        return self._at("vapour_pressure", temperature, warn)

    def kinematic_viscosity(self, temperature=None, *, warn=True):
        """Viscosity [m2/s] at `temperature` [K]; None is 20 degC. ValueError where it is not given."""
        return self._at("kinematic_viscosity", temperature, warn)

    def _at(self, what, temperature, warn):
        if what not in self.properties:
            raise MissingDatum(f"the fluid {self.name!r} has no {what}: give {what}=... for it.")
        value = self.properties[what]
        if callable(value):
            temperature = STANDARD_TEMPERATURE if temperature is None else temperature
            # a user's function owes nobody a switch for its warnings
            return value(temperature, warn=warn) if value in _SWITCHABLE else value(temperature)
        if temperature is None or np.ndim(temperature) == 0:
            return float(value)
        return np.full(np.shape(temperature), float(value))


def fluid_from(
    name="water", density=None, kinematic_viscosity=None, vapour_pressure=None, critical_pressure=None
):
    """Fluid from a name, and from numbers or functions where the name is not enough.

    Parameters
    ----------
    name : str or Fluid, default="water"
        ``"water"`` brings every property by temperature; any other name needs at least a density.
    density : float or callable, default=None
        Density, or a function of the temperature [K]; None takes the named fluid's. [kg/m3]
    kinematic_viscosity : float or callable, default=None
        Likewise. [m2/s]
    vapour_pressure : float or callable, default=None
        Likewise, absolute. [Pa]
    critical_pressure : float, default=None
        Likewise. [Pa]

    Returns
    -------
    fluid : Fluid
        What is neither named nor given stays unknown, and asking for it raises a ValueError that says so.

    Raises
    ------
    ValueError
        If the fluid is not known by name and no density is given, or a number is not positive.

    Examples
    --------
    >>> round(float(fluid_from("water").density(363.15)), 1)
    965.3
    >>> juice = fluid_from("thin juice", density=1060.0, vapour_pressure=water_vapour_pressure)
    >>> round(float(juice.vapour_pressure(373.1243)) / 1e3, 1)
    101.3
    """
    given = {
        "density": density,
        "vapour_pressure": vapour_pressure,
        "kinematic_viscosity": kinematic_viscosity,
        "critical_pressure": critical_pressure,
    }
    given = {what: value for what, value in given.items() if value is not None}
    for what, value in given.items():
        if what == "critical_pressure" or not callable(value):
            _check_number(what, value)
    base = name if isinstance(name, Fluid) else _named(name, given)
    properties = {**base.properties, **{what: given[what] for what in _PROPERTIES if what in given}}
    return Fluid(base.name, properties, given.get("critical_pressure", base.critical_pressure))


def clausius_clapeyron(temperature, *, p_ref, t_ref, enthalpy):
    r"""Vapour pressure by Clausius-Clapeyron, heat of vaporisation constant: the paper's equations 3 and 4.

    Parameters
    ----------
    temperature : float or array-like
        Temperature. [K]
    p_ref : float
        Vapour pressure at the reference. [Pa]
    t_ref : float
        Temperature of the reference. [K]
    enthalpy : float
        Molar heat of vaporisation. [J/mol]

    Returns
    -------
    p_vapour : float or ndarray
        Vapour pressure; NaN at or below 0 K. [Pa]

    Notes
    -----
    .. math:: \ln \frac{p_v}{p_{ref}}
              = -\frac{\Delta_{vap} H_m}{R}\left(\frac{1}{T} - \frac{1}{T_{ref}}\right)

    with R = 8.314462618 J/(mol K). The paper prints R = 287, which belongs to a kilogram of dry air: with it
    the vapour pressure of water is 157 % too high at 150 degC. Good near the reference only: for water about
    50 degC 13 % at worst from 0 to 150 degC.

    Examples
    --------
    >>> round(float(clausius_clapeyron(333.15, **WATER_CLAUSIUS_CLAPEYRON)))
    19950
    """
    temperature = _positive(temperature)
    return p_ref * np.exp(-enthalpy / GAS_CONSTANT * (1.0 / temperature - 1.0 / t_ref))


def antoine(temperature, *, a, b, c, form="log10_mmHg", warn=True):
    r"""Vapour pressure by Antoine.

    Parameters
    ----------
    temperature : float or array-like
        Temperature. [K]
    a, b, c : float
        Constants as tabulated for `form` and a temperature t in degC.
    form : {"log10_mmHg", "ln_kPa"}, default="log10_mmHg"
        What a - b / (c + t) is: the decimal logarithm in mmHg or the natural one in kPa.
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of temperatures at or below the pole t = -c.

    Returns
    -------
    p_vapour : float or ndarray
        Vapour pressure; NaN at or below the pole. [Pa]

    Raises
    ------
    ValueError
        If `form` is unknown.

    Notes
    -----
    .. math:: \log p_v = a - \frac{b}{c + t}

    An interpolation: use it inside the range of its constants.

    Examples
    --------
    >>> round(float(antoine(373.15, **WATER_ANTOINE)) / 1e3, 1)
    101.3
    """
    if form not in ("log10_mmHg", "ln_kPa"):
        raise ValueError(f"form must be 'log10_mmHg' or 'ln_kPa'; got {form!r}.")
    above = np.asarray(temperature, dtype=float) - 273.15 + c
    if warn:
        warn_rows(above <= 0.0, "antoine", "have a temperature at or below the pole of the formula: NaN.")
    exponent = a - b / np.where(above > 0.0, above, np.nan)[()]
    return np.exp(exponent) * 1e3 if form == "ln_kPa" else 10.0**exponent * (101325.0 / 760.0)


def _named(name, given):
    if name == "water":
        formulas = {
            "density": water_density,
            "vapour_pressure": water_vapour_pressure,
            "kinematic_viscosity": water_kinematic_viscosity,
        }
        return Fluid("water", formulas, WATER_CRITICAL_PRESSURE)
    if "density" not in given:
        raise ValueError(
            f"unknown fluid {name!r}: use 'water', or give at least its density [kg/m3] "
            "(and for choking its vapour_pressure and critical_pressure [Pa])."
        )
    return Fluid(str(name), {})


def _check_number(what, value):
    if not (np.isscalar(value) and np.isreal(value) and 0.0 < float(value) < np.inf):
        raise ValueError(
            f"{what} must be a positive number, or a function of the temperature; got {value!r}."
        )


def _positive(temperature):
    temperature = np.asarray(temperature, dtype=float)
    return np.where(temperature > 0.0, temperature, np.nan)[()]
