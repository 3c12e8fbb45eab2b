# SPDX-License-Identifier: BSD-3-Clause
"""The fluid: its properties by temperature, from a formula, a number or the user's function."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from sklvalve.mechanism.coolprop import COOLPROP_PREFIX, coolprop_properties
from sklvalve.mechanism.juice import juice_density, juice_kinematic_viscosity, juice_vapour_pressure
from sklvalve.mechanism.liquid import WATER_CRITICAL_PRESSURE
from sklvalve.mechanism.validity import MissingDatum
from sklvalve.mechanism.vapour_pressure import antoine, clausius_clapeyron
from sklvalve.mechanism.water import water_density, water_kinematic_viscosity, water_vapour_pressure

STANDARD_TEMPERATURE = 293.15
"""Temperature taken where none is given: 20 degC. [K]"""

_WATER = {
    "density": water_density,
    "vapour_pressure": water_vapour_pressure,
    "kinematic_viscosity": water_kinematic_viscosity,
}
_JUICE = {
    "density": juice_density,
    "vapour_pressure": juice_vapour_pressure,
    "kinematic_viscosity": juice_kinematic_viscosity,
}
_SWITCHABLE = (*_WATER.values(), *_JUICE.values(), antoine, clausius_clapeyron)
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
            # a user's function owes nobody a switch for its warnings; ours may have their constants bound
            ours = getattr(value, "func", value) in _SWITCHABLE or getattr(value, "takes_warn", False)
            return value(temperature, warn=warn) if ours else value(temperature)
        if temperature is None or np.ndim(temperature) == 0:
            return float(value)
        return np.full(np.shape(temperature), float(value))


def fluid_from(
    name="water",
    density=None,
    kinematic_viscosity=None,
    vapour_pressure=None,
    critical_pressure=None,
    *,
    brix=None,
):
    """Fluid from a name, and from numbers or functions where the name is not enough.

    Parameters
    ----------
    name : str or Fluid, default="water"
        ``"water"`` brings every property by temperature, ``"sugar juice"`` as well for a `brix`, and so does
        ``"CoolProp::"`` and a name of CoolProp's, as in ``"CoolProp::Propane"``, where that package is
        installed; any other name needs at least a density.
    density : float or callable, default=None
        Density, or a function of the temperature [K]; None takes the named fluid's. [kg/m3]
    kinematic_viscosity : float or callable, default=None
        Likewise. [m2/s]
    vapour_pressure : float or callable, default=None
        Likewise, absolute. [Pa]
    critical_pressure : float, default=None
        Likewise. [Pa]
    brix : float, default=None
        Dissolved solids in percent of the mass, for ``"sugar juice"``. [%]

    Returns
    -------
    fluid : Fluid
        What is neither named nor given stays unknown, and asking for it raises a ValueError that says so.

    Raises
    ------
    ValueError
        If the fluid is not known by name and no density is given, a number is not positive, or a juice has no
        brix or another fluid has one.
    ImportError
        If CoolProp is asked for and not installed.

    See Also
    --------
    fit_clausius_clapeyron, fit_antoine : Constants of a vapour-pressure curve from its points.

    Examples
    --------
    >>> round(float(fluid_from("water").density(363.15)), 1)
    965.3
    >>> juice = fluid_from("thin juice", density=1060.0, vapour_pressure=water_vapour_pressure)
    >>> round(float(juice.vapour_pressure(373.1243)) / 1e3, 1)
    101.3
    >>> round(float(fluid_from("sugar juice", brix=65.0).density(353.15)))
    1294

    A vapour pressure of one's own, here by Antoine:

    >>> from functools import partial
    >>> from sklvalve.mechanism import WATER_ANTOINE, antoine
    >>> mine = fluid_from("brine", density=1070.0, vapour_pressure=partial(antoine, **WATER_ANTOINE))
    >>> round(float(mine.vapour_pressure(353.15)) / 1e3, 1)
    47.3
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
    if brix is not None and name != "sugar juice":
        raise ValueError("brix belongs to the fluid 'sugar juice': leave it out, or name that fluid.")
    base = name if isinstance(name, Fluid) else _named(name, given, brix)
    properties = {**base.properties, **{what: given[what] for what in _PROPERTIES if what in given}}
    return Fluid(base.name, properties, given.get("critical_pressure", base.critical_pressure))


def _named(name, given, brix):
    if name == "water":
        return Fluid("water", dict(_WATER), WATER_CRITICAL_PRESSURE)
    if name == "sugar juice":
        return _juice(brix)
    if str(name).startswith(COOLPROP_PREFIX):
        return Fluid(str(name), *coolprop_properties(str(name).removeprefix(COOLPROP_PREFIX)))
    if "density" not in given:
        raise ValueError(
            f"unknown fluid {name!r}: use 'water', 'sugar juice' or 'CoolProp::' and a name, or give at "
            "least its density [kg/m3] (and for choking its vapour_pressure and critical_pressure [Pa])."
        )
    return Fluid(str(name), {})


def _juice(brix):
    if brix is None or not (np.ndim(brix) == 0 and 0.0 <= float(brix) <= 85.0):
        raise ValueError(
            f"sugar juice needs its brix, the percent of dissolved solids (0 to 85); got {brix!r}."
        )
    properties = {what: partial(formula, brix=float(brix)) for what, formula in _JUICE.items()}
    # sucrose does not boil: F_F stays that of the water
    return Fluid(f"sugar juice of {float(brix):g} %", properties, WATER_CRITICAL_PRESSURE)


def _check_number(what, value):
    if not (np.isscalar(value) and np.isreal(value) and 0.0 < float(value) < np.inf):
        raise ValueError(
            f"{what} must be a positive number, or a function of the temperature; got {value!r}."
        )
