# SPDX-License-Identifier: BSD-3-Clause
"""What a gas flow is counted in: mass, volume at the inlet, or volume at a reference state."""

import numpy as np

from sklvalve.mechanism._constants import FLOW_CONSTANT, HOUR
from sklvalve.mechanism.gas_data import sensible

GAS_CONSTANT = 8.31446261815324
"""Molar gas constant, exact in SI. [J/(mol K)]"""

REFERENCE_PRESSURE = 101.325e3
"""Pressure of both reference states. [Pa]"""

_REFERENCE_TEMPERATURE = {"normal": 273.15, "standard": 288.15}

GAS_FLOW_BASES = ("mass", "actual", "normal", "standard")
"""What `basis` can be: mass [kg/s]; volume at the inlet, at 0 degC or at 15 degC and 101.325 kPa [m3/s]."""

_PRINTED = {"mass": 1.10, "actual": 3.16, "normal": 24.6, "standard": 26.0}
"""N8, N6 and the two N9 of the standard, for m3/h, kg/h, kPa and kg/kmol."""


def gas_density(pressure, temperature, molar_mass, compressibility=1.0):
    r"""Density of a gas.

    Parameters
    ----------
    pressure : float or array-like
        Absolute pressure. [Pa]
    temperature : float or array-like
        Temperature. [K]
    molar_mass : float or array-like
        Molar mass: 0.02896 for air. [kg/mol]
    compressibility : float or array-like, default=1.0
        Compressibility factor at this pressure and temperature; 1 is an ideal gas. [1]

    Returns
    -------
    density : float or ndarray
        Density; NaN where the pressure is negative, or another input is not positive and finite. [kg/m3]

    Notes
    -----
    .. math:: \rho = \frac{p M}{Z R T}

    Where a density is known instead (steam from a table), ``density / gas_density(p, T, molar_mass)`` is the
    reciprocal of the compressibility that the gas functions need.

    Examples
    --------
    >>> round(float(gas_density(101.325e3, 273.15, 0.028965)), 4)
    1.2923
    """
    pressure = np.asarray(pressure, dtype=float)
    with np.errstate(all="ignore"):
        inverse = _specific_inverse(temperature, molar_mass, compressibility)
        return np.where(pressure >= 0.0, pressure * inverse, np.nan)[()]


def gas_volume_flow(mass_flow, basis, pressure, temperature, molar_mass, compressibility=1.0):
    r"""Gas flow on another basis, from the mass flow.

    Parameters
    ----------
    mass_flow : float or array-like
        Mass flow. [kg/s]
    basis : {"mass", "actual", "normal", "standard"}
        What to count in; see Notes.
    pressure, temperature, molar_mass, compressibility
        As in `gas_density`, at the inlet of the valve. Only ``"actual"`` uses the first two and the last.

    Returns
    -------
    flow : float or ndarray
        Flow on that basis. [kg/s] or [m3/s]

    Raises
    ------
    ValueError
        If the basis is unknown.

    See Also
    --------
    gas_mass_flow : The inverse.

    Notes
    -----
    ============  ============================================================
    basis         the flow is
    ============  ============================================================
    mass          kg/s
    actual        m3/s at the pressure and temperature before the valve
    normal        m3/s of the ideal gas at 0 degC and 101.325 kPa
    standard      m3/s of the ideal gas at 15 degC and 101.325 kPa
    ============  ============================================================

    A normal cubic metre is thus an amount, :math:`p_n / (R T_n)` = 44.615 mol: the 22.414 m3/kmol in the
    constant N9 of the standard.

    Examples
    --------
    >>> round(float(gas_volume_flow(1.0, "normal", 5e5, 300.0, 0.028965)), 4)
    0.7738
    >>> round(float(gas_volume_flow(1.0, "actual", 5e5, 300.0, 0.028965)), 4)
    0.1722
    """
    density = _density_of_basis(basis, pressure, temperature, molar_mass, compressibility)
    with np.errstate(all="ignore"):
        return np.asarray(mass_flow, dtype=float) / density


def gas_mass_flow(flow, basis, pressure, temperature, molar_mass, compressibility=1.0):
    """Mass flow from a gas flow on any basis: the inverse of `gas_volume_flow`.

    Parameters
    ----------
    flow : float or array-like
        Flow on that basis. [kg/s] or [m3/s]
    basis, pressure, temperature, molar_mass, compressibility
        As in `gas_volume_flow`.

    Returns
    -------
    mass_flow : float or ndarray
        Mass flow. [kg/s]

    Raises
    ------
    ValueError
        If the basis is unknown.

    Examples
    --------
    >>> round(float(gas_mass_flow(3800 / 3600, "normal", 680e3, 433.0, 0.04401, 0.988)), 4)
    2.0726
    """
    density = _density_of_basis(basis, pressure, temperature, molar_mass, compressibility)
    with np.errstate(all="ignore"):
        return np.asarray(flow, dtype=float) * density


def check_basis(basis):
    if basis not in GAS_FLOW_BASES:
        raise ValueError(f"basis must be one of {', '.join(GAS_FLOW_BASES)}; got {basis!r}.")


def _density_of_basis(basis, pressure, temperature, molar_mass, compressibility):
    check_basis(basis)
    if basis == "mass":
        return 1.0
    if basis == "actual":
        return gas_density(pressure, temperature, molar_mass, compressibility)
    return gas_density(REFERENCE_PRESSURE, _REFERENCE_TEMPERATURE[basis], molar_mass)


def rounding_of_constant(basis):
    """The constant that the standard prints for flow on a basis, over what it stands for."""
    of_density = np.sqrt(1e3) * FLOW_CONSTANT * HOUR
    of_mass = 1e3 * FLOW_CONSTANT * HOUR / np.sqrt(1e3 * GAS_CONSTANT)
    if basis in _REFERENCE_TEMPERATURE:
        kilomole = 1e3 * GAS_CONSTANT * _REFERENCE_TEMPERATURE[basis] / REFERENCE_PRESSURE
        return _PRINTED[basis] / (of_mass * kilomole)
    return _PRINTED[basis] / (of_density if basis == "actual" else of_mass)


def _specific_inverse(temperature, molar_mass, compressibility):
    """M / (Z R T) [s2/m2], NaN where one of them is senseless."""
    temperature, molar_mass, compressibility = map(sensible, (temperature, molar_mass, compressibility))
    return molar_mass / (compressibility * GAS_CONSTANT * temperature)
