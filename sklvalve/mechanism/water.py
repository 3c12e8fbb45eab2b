# SPDX-License-Identifier: BSD-3-Clause
"""Water on its saturation line: vapour pressure, liquid density and viscosity from temperature."""

import numpy as np

from sklvalve.mechanism._constants import (
    COLDEST,
    CRITICAL_DENSITY,
    CRITICAL_PRESSURE,
    CRITICAL_TEMPERATURE,
    FREEZING,
    VISCOSITY_LIMIT,
)
from sklvalve.mechanism.validity import warn_rows


def water_vapour_pressure(temperature, *, warn=True):
    r"""Vapour pressure of water.

    Parameters
    ----------
    temperature : float or array-like
        Temperature. [K]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of temperatures outside 273.15 to 647.096 K.

    Returns
    -------
    p_vapour : float or ndarray
        Saturation pressure, absolute; NaN below 230 K and above the critical temperature. [Pa]

    Notes
    -----
    With :math:`\tau = 1 - T/T_c`

    .. math:: \ln\frac{p_v}{p_c} = \frac{T_c}{T}\left(a_1 \tau + a_2 \tau^{1.5} + a_3 \tau^3 + a_4 \tau^{3.5}
              + a_5 \tau^4 + a_6 \tau^{7.5}\right)

    Within 0.007 % of IAPWS-95 from 0 to 150 degC.

    References
    ----------
    .. [1] IAPWS SR1-86(1992), Saturation properties of ordinary water substance.

    Examples
    --------
    >>> round(float(water_vapour_pressure(373.1243)))
    101325
    """
    temperature, tau = saturation_tau(temperature, "water_vapour_pressure", warn)
    return CRITICAL_PRESSURE * np.exp(CRITICAL_TEMPERATURE / temperature * _pressure_series(tau))


def water_saturation_temperature(p_vapour, *, warn=True):
    r"""Boiling point of water at a pressure: the inverse of `water_vapour_pressure`.

    Parameters
    ----------
    p_vapour : float or array-like
        Pressure, absolute. [Pa]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of pressures outside 611 Pa to 22.064 MPa.

    Returns
    -------
    temperature : float or ndarray
        Temperature of boiling water and of saturated steam; NaN outside the range. [K]

    Notes
    -----
    Newton steps on :math:`\ln p_v` over 1/T, which is nearly a straight line; eight reach the last digits
    from anywhere.

    Examples
    --------
    >>> round(float(water_saturation_temperature(101325.0)), 4)
    373.1243
    """
    p_vapour = np.asarray(p_vapour, dtype=float)
    lowest = float(water_vapour_pressure(FREEZING))
    inside = (p_vapour >= lowest) & (p_vapour <= CRITICAL_PRESSURE)
    if warn:
        what = f"have a pressure outside {lowest:.0f} to {CRITICAL_PRESSURE:.0f} Pa (is it absolute?): NaN."
        warn_rows(~inside & ~np.isnan(p_vapour), "water_saturation_temperature", what)
    wanted = np.log(np.where(inside, p_vapour, np.nan) / CRITICAL_PRESSURE)
    inverse = 1.0 / CRITICAL_TEMPERATURE - wanted * 2.0e-4
    for _ in range(8):
        temperature = np.minimum(1.0 / inverse, CRITICAL_TEMPERATURE)
        tau = 1.0 - temperature / CRITICAL_TEMPERATURE
        found = CRITICAL_TEMPERATURE / temperature * _pressure_series(tau)
        slope = temperature * (found + _pressure_series_slope(tau))
        inverse = 1.0 / temperature - (found - wanted) / slope
    return np.minimum(1.0 / inverse, CRITICAL_TEMPERATURE)[()]


def water_density(temperature, *, warn=True):
    r"""Density of liquid water at saturation.

    Parameters
    ----------
    temperature : float or array-like
        Temperature. [K]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of temperatures outside 273.15 to 647.096 K.

    Returns
    -------
    density : float or ndarray
        Density; NaN below 230 K and above the critical temperature. [kg/m3]

    Notes
    -----
    With :math:`\tau = 1 - T/T_c`

    .. math:: \frac{\rho}{\rho_c} = 1 + b_1 \tau^{1/3} + b_2 \tau^{2/3} + b_3 \tau^{5/3} + b_4 \tau^{16/3}
              + b_5 \tau^{43/3} + b_6 \tau^{110/3}

    Compression is left out: 10 bar more make water 0.05 % denser.

    References
    ----------
    .. [1] IAPWS SR1-86(1992), Saturation properties of ordinary water substance.

    Examples
    --------
    >>> round(float(water_density(373.1243)), 3)
    958.365
    """
    _, tau = saturation_tau(temperature, "water_density", warn)
    third = np.cbrt(tau)
    two_thirds = third * third
    tau2 = tau * tau
    tau4 = tau2 * tau2
    tau5 = tau4 * tau
    tau9 = tau5 * tau4
    tau22 = (tau9 * tau2) ** 2
    series = 1.99274064 * third + two_thirds * (1.09965342 - 0.510839303 * tau)
    series = series + third * tau5 * (-1.75493479 - 45.5170352 * tau9)
    series = series - 6.74694450e5 * two_thirds * tau22 * tau9 * tau5
    return CRITICAL_DENSITY * (1.0 + series)


def water_kinematic_viscosity(temperature, *, warn=True):
    r"""Kinematic viscosity of liquid water.

    Parameters
    ----------
    temperature : float or array-like
        Temperature. [K]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of temperatures outside 273.15 to 423.15 K.

    Returns
    -------
    kinematic_viscosity : float or ndarray
        Dynamic viscosity at 0.1 MPa divided by the density at saturation; NaN where that is. [m2/s]

    Notes
    -----
    .. math:: \eta = 10^{-6}\,\mathrm{Pa\,s} \sum_{i=1}^{4} a_i \left(\frac{T}{300\,\mathrm{K}}\right)^{b_i}

    Released for 253.15 to 383.15 K; within 0.2 % of the full formulation up to 423.15 K.

    References
    ----------
    .. [1] IAPWS SR6-08, Properties of liquid water at 0.1 MPa.

    Examples
    --------
    >>> round(float(water_kinematic_viscosity(293.15)) * 1e6, 3)
    1.003
    """
    temperature = np.asarray(temperature, dtype=float)
    if warn:
        outside = (temperature < FREEZING) | (temperature > VISCOSITY_LIMIT)
        what = (
            f"have a temperature outside {FREEZING} to {VISCOSITY_LIMIT} K: the viscosity is extrapolated, "
            f"and NaN below {COLDEST:.0f} K and above {CRITICAL_TEMPERATURE} K."
        )
        warn_rows(outside, "water_kinematic_viscosity", what)
    with np.errstate(invalid="ignore", divide="ignore"):
        log = np.log(np.where(temperature > 0.0, temperature, np.nan) / 300.0)
    viscosity = 280.68 * np.exp(-1.9 * log) + 511.45 * np.exp(-7.7 * log)
    viscosity = viscosity + 61.131 * np.exp(-19.6 * log) + 0.45903 * np.exp(-40.0 * log)
    return 1e-6 * viscosity / water_density(temperature, warn=False)


def _pressure_series(tau):
    root = np.sqrt(tau)
    cube = tau * tau * tau
    series = -7.85951783 * tau + 1.84408259 * tau * root
    return series + cube * (
        -11.7866497 + 22.6807411 * root - 15.9618719 * tau + 1.80122502 * cube * tau * root
    )


def _pressure_series_slope(tau):
    root = np.sqrt(tau)
    series = -7.85951783 + 1.5 * 1.84408259 * root
    middle = -3.0 * 11.7866497 + 3.5 * 22.6807411 * root - 4.0 * 15.9618719 * tau
    return series + tau * tau * (middle + 7.5 * 1.80122502 * tau**4 * root)


def saturation_tau(temperature, name, warn):
    temperature = np.asarray(temperature, dtype=float)
    if warn:
        outside = (temperature < FREEZING) | (temperature > CRITICAL_TEMPERATURE)
        what = f"have a temperature outside {FREEZING} to {CRITICAL_TEMPERATURE} K (is it in kelvin?)"
        warn_rows(
            outside, name, f"{what}; above the range and below {COLDEST:.0f} K they give NaN.", stacklevel=4
        )
    liquid = (temperature >= COLDEST) & (temperature <= CRITICAL_TEMPERATURE)
    temperature = np.where(liquid, temperature, np.nan)[()]
    return temperature, 1.0 - temperature / CRITICAL_TEMPERATURE
