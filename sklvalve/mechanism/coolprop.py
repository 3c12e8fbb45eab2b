# SPDX-License-Identifier: BSD-3-Clause
"""Any pure fluid that CoolProp knows, on its saturation line; the package is an extra."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sklvalve.mechanism.validity import warn_rows

COOLPROP_PREFIX = "CoolProp::"

_CODES = {"density": "D", "vapour_pressure": "P", "kinematic_viscosity": "V"}


@dataclass(frozen=True)
class CoolPropProperty:
    """One property of one saturated liquid as a function of temperature, found by name at each call.

    Parameters
    ----------
    name : str
        Name of a pure fluid, as CoolProp has it.
    what : str
        ``density``, ``vapour_pressure`` or ``kinematic_viscosity``.

    Notes
    -----
    It holds names only, so that an estimator with such a fluid can be copied, pickled and sent to workers.
    The liquid is at its boiling pressure. A row costs about 500 ns, against 20 ns for the water built in.
    """

    takes_warn: ClassVar[bool] = True

    name: str
    what: str

    def __call__(self, temperature, *, warn=True):
        """Property at temperatures [K] in SI; NaN, with a `ValidityWarning`, off the saturation line."""
        properties = _properties_function()
        lowest, highest = (float(properties(end, self.name)) for end in ("Tmin", "Tcrit"))
        temperature = np.asarray(temperature, dtype=float)
        # at the critical point itself the two phases can no longer be told apart
        inside = (temperature >= lowest) & (temperature < highest)
        if warn:
            what = f"have a temperature outside {lowest:.6g} to {highest:.6g} K, where it is no liquid: NaN."
            warn_rows(~inside & ~np.isnan(temperature), f"{self.what} of {self.name}", what)
        values = np.full(temperature.shape, np.nan)
        if np.any(inside):
            at = ("T", temperature[inside], "Q", np.zeros(np.count_nonzero(inside)), self.name)
            found = np.asarray(properties(_CODES[self.what], *at), dtype=float)
            if self.what == "kinematic_viscosity":
                found = found / np.asarray(properties("D", *at), dtype=float)
            values[inside] = np.where(np.isfinite(found), found, np.nan)
        return values[()]


def coolprop_properties(name):
    """Properties by name, and the critical pressure [Pa], of a pure fluid of CoolProp's.

    ImportError where the package is absent; ValueError for a name that it does not know, and for mixtures,
    which have no one vapour pressure.
    """
    properties = _properties_function()
    try:
        if "&" in name:
            raise ValueError("a mixture")
        critical_pressure = float(properties("pcrit", name))
        middle = 0.5 * (float(properties("Tmin", name)) + float(properties("Tcrit", name)))
        float(properties("P", "T", middle, "Q", 0.0, name))
    except ValueError as error:
        raise ValueError(
            f"CoolProp has no pure liquid {name!r} on a saturation line: use a name from its list of fluids, "
            "for example 'CoolProp::Propane'."
        ) from error
    known = {what: CoolPropProperty(name, what) for what in _CODES}
    try:
        float(properties("V", "T", middle, "Q", 0.0, name))
    except ValueError:
        # not every fluid has a viscosity model
        del known["kinematic_viscosity"]
    return known, critical_pressure


def _properties_function():
    try:
        from CoolProp.CoolProp import PropsSI
    except ImportError as error:
        raise ImportError(
            'this fluid needs CoolProp, which is not installed: pip install "sklvalve[fluids]".'
        ) from error
    return PropsSI
