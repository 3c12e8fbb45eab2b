# SPDX-License-Identifier: BSD-3-Clause
"""Sugar juice: water with sucrose in it, from temperature and Brix."""

import numpy as np

from sklvalve.mechanism._constants import FREEZING, WATER_MOLAR_MASS
from sklvalve.mechanism.validity import warn_rows
from sklvalve.mechanism.water import water_density, water_vapour_pressure

_SUCROSE_MOLAR_MASS = 0.3422965
# what the viscosity was fitted to, and what stays dissolved in a factory
_BRIX_LIMIT = 85.0


def juice_density(temperature, brix, *, warn=True):
    r"""Density of sugar juice.

    Parameters
    ----------
    temperature : float or array-like
        Temperature. [K]
    brix : float or array-like
        Dissolved solids, taken as sucrose, in percent of the mass. [%]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows outside 0 to 85 % or 273.15 to 647.096 K.

    Returns
    -------
    density : float or ndarray
        Density; NaN outside 0 to 85 % and where water has none. [kg/m3]

    Notes
    -----
    With the mass fraction w = brix / 100 and t in degC

    .. math:: \frac{1}{\rho} = \frac{1 - w}{\rho_{water}(T)} + \frac{w}{1599.1 - 0.31046\,t}

    that is, volumes add; the water is that of `water_density`, so that 0 % is water. Within 0.4 % of the
    tabulated densities of pure sucrose at 20 degC up to 72 %, within 1.1 % at 84 %.

    References
    ----------
    .. [1] Choi, Y. and M. R. Okos, Effects of temperature and composition on the thermal properties of foods,
       in Food Engineering and Process Applications 1, Elsevier, 1986.

    Examples
    --------
    >>> juice_density(363.15, [0.0, 15.0, 65.0]).round(1)
    array([ 965.3, 1024.6, 1288.2])
    """
    brix = _brix(brix, "juice_density", warn)
    temperature = np.asarray(temperature, dtype=float)
    share = 0.01 * brix
    sucrose = 1599.1 - 0.31046 * (temperature - FREEZING)
    return (1.0 / ((1.0 - share) / water_density(temperature, warn=warn) + share / sucrose))[()]


def juice_vapour_pressure(temperature, brix, *, warn=True):
    r"""Vapour pressure of sugar juice.

    Parameters
    ----------
    temperature, brix, warn
        As in `juice_density`.

    Returns
    -------
    p_vapour : float or ndarray
        Vapour pressure, absolute; NaN outside 0 to 85 % and where water has none. [Pa]

    Notes
    -----
    Water activity by Norrish, with the mole fractions x of water and sucrose:

    .. math:: p_v = a_w\, p_{v,water}(T), \qquad \ln a_w = \ln x_w - 6.47\, x_s^2

    15 % takes 1 % off the vapour pressure of water, 65 % takes 13 %. Made for room temperature; sucrose
    moves little with it.

    References
    ----------
    .. [1] Norrish, R. S., An equation for the activity coefficients and equilibrium relative humidities of
       water in confectionery syrups, J. Food Technology 1 (1966) 25-39.

    Examples
    --------
    >>> (juice_vapour_pressure(373.1243, [0.0, 15.0, 65.0]) / 101325.0).round(3)
    array([1.   , 0.99 , 0.865])
    """
    share = 0.01 * _brix(brix, "juice_vapour_pressure", warn)
    sucrose = share / _SUCROSE_MOLAR_MASS
    sucrose = sucrose / (sucrose + (1.0 - share) / WATER_MOLAR_MASS)
    activity = (1.0 - sucrose) * np.exp(-6.47 * sucrose**2)
    return (activity * water_vapour_pressure(temperature, warn=warn))[()]


def juice_kinematic_viscosity(temperature, brix, *, warn=True):
    r"""Kinematic viscosity of sugar juice.

    Parameters
    ----------
    temperature, brix, warn
        As in `juice_density`.

    Returns
    -------
    kinematic_viscosity : float or ndarray
        Dynamic viscosity over density; NaN outside 0 to 85 % and where water has none. [m2/s]

    Notes
    -----
    With t in degC and N = B / (1900 - 18 B), the moles of sucrose to 100 g of water,

    .. math:: \log_{10} \frac{\eta}{\mathrm{mPa\,s}} = 22.46 N - 0.114
              + \frac{30 - t}{91 + t} \left(1.1 + 43.1\, N^{1.25}\right)

    For pure sucrose of 20 to 60 % within 9 % of the tabulated values from 20 to 85 degC and within 14 % from
    freezing on; real juices differ more. At 0 % it is 4 % under `water_kinematic_viscosity` at 20 degC: for
    water take that.

    References
    ----------
    .. [1] Genotelle, J., Expression de la viscosité des solutions sucrées, Industries alimentaires et
       agricoles 95 (1978).

    Examples
    --------
    >>> (juice_kinematic_viscosity(293.15, [15.0, 40.0, 65.0]) * 1e6).round(2)
    array([  1.51,   5.41, 113.21])
    """
    temperature = np.asarray(temperature, dtype=float)
    density = juice_density(temperature, brix, warn=warn)
    brix = _brix(brix, "juice_kinematic_viscosity", False)
    moles = brix / (1900.0 - 18.0 * brix)
    t = temperature - FREEZING
    # colder than ice the formula has its pole, and the density its warning
    mobility = (30.0 - t) / np.where(t > -90.0, 91.0 + t, np.nan)
    exponent = 22.46 * moles - 0.114 + mobility * (1.1 + 43.1 * moles**1.25)
    return (1e-3 * 10.0**exponent / density)[()]


def _brix(brix, name, warn):
    brix = np.asarray(brix, dtype=float)
    inside = (brix >= 0.0) & (brix <= _BRIX_LIMIT)
    if warn:
        what = f"have a brix outside 0 to {_BRIX_LIMIT:.0f} % (it is in percent) and give NaN."
        warn_rows(~inside & ~np.isnan(brix), name, what, stacklevel=4)
    return np.where(inside, brix, np.nan)
