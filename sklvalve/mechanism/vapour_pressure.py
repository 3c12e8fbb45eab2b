# SPDX-License-Identifier: BSD-3-Clause
"""Vapour pressure by Clausius-Clapeyron and by Antoine, and their constants from measured points."""

import numpy as np
from scipy.optimize import least_squares

from sklvalve.mechanism.gas_units import GAS_CONSTANT
from sklvalve.mechanism.validity import warn_rows

WATER_CLAUSIUS_CLAPEYRON = {"p_ref": 12351.95, "t_ref": 323.15, "enthalpy": 42911.0}
"""Water about 50 degC: within 13 % of IAPWS-95 from 0 to 150 degC."""

WATER_ANTOINE = {"a": 8.07131, "b": 1730.63, "c": 233.426, "form": "log10_mmHg"}
"""Water, 1 to 100 degC: within 1.2 % of IAPWS-95 from 0 to 150 degC."""


def clausius_clapeyron(temperature, *, p_ref, t_ref, enthalpy, warn=True):
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
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of temperatures at or below 0 K.

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
    temperature = np.asarray(temperature, dtype=float)
    if warn:
        warn_rows(temperature <= 0.0, "clausius_clapeyron", "have a temperature at or below 0 K: NaN.")
    temperature = np.where(temperature > 0.0, temperature, np.nan)[()]
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
    _log_units(form)  # refuses an unknown form
    above = np.asarray(temperature, dtype=float) - 273.15 + c
    if warn:
        warn_rows(above <= 0.0, "antoine", "have a temperature at or below the pole of the formula: NaN.")
    exponent = a - b / np.where(above > 0.0, above, np.nan)[()]
    return np.exp(exponent) * 1e3 if form == "ln_kPa" else 10.0**exponent * (101325.0 / 760.0)


def fit_clausius_clapeyron(temperature, p_vapour, *, t_ref=None):
    r"""Constants of `clausius_clapeyron` from points of a vapour-pressure curve.

    Parameters
    ----------
    temperature : array-like of shape (n_points,)
        Temperatures, at least two different ones. [K]
    p_vapour : array-like of shape (n_points,)
        Vapour pressures there, absolute. [Pa]
    t_ref : float, default=None
        Temperature of the reference; it changes how the line is written, not the line. None takes the middle
        of the points on the scale of 1/T. [K]

    Returns
    -------
    constants : dict
        ``p_ref`` [Pa], ``t_ref`` [K] and ``enthalpy`` [J/mol], as `clausius_clapeyron` takes them.

    Raises
    ------
    ValueError
        If the points differ in number, are too few, or a temperature or pressure is not positive.

    Notes
    -----
    Least squares of :math:`\ln p_v` on :math:`1/T`, so every point counts by its relative error. For water
    from 0 to 150 degC the best line is off by 8 % at worst.

    Examples
    --------
    >>> from sklvalve.mechanism import water_vapour_pressure
    >>> t = [313.15, 323.15, 333.15]
    >>> constants = fit_clausius_clapeyron(t, water_vapour_pressure(t), t_ref=323.15)
    >>> round(constants["p_ref"]), round(constants["enthalpy"])
    (12334, 43096)
    """
    temperature, log_pressure = _points(temperature, p_vapour, 2)
    inverse = 1.0 / temperature
    t_ref = 1.0 / float(np.mean(inverse)) if t_ref is None else float(t_ref)
    if not 0.0 < t_ref < np.inf:
        raise ValueError(f"t_ref must be a positive temperature [K]; got {t_ref!r}.")
    centred = inverse - np.mean(inverse)
    slope = float(centred @ log_pressure / (centred @ centred))
    at_reference = float(np.mean(log_pressure)) + slope * (1.0 / t_ref - float(np.mean(inverse)))
    return {"p_ref": float(np.exp(at_reference)), "t_ref": t_ref, "enthalpy": -slope * GAS_CONSTANT}


def fit_antoine(temperature, p_vapour, *, form="ln_kPa"):
    r"""Constants of `antoine` from points of a vapour-pressure curve.

    Parameters
    ----------
    temperature : array-like of shape (n_points,)
        Temperatures, at least three different ones. [K]
    p_vapour : array-like of shape (n_points,)
        Vapour pressures there, absolute. [Pa]
    form : {"ln_kPa", "log10_mmHg"}, default="ln_kPa"
        In which form the constants are wanted, see `antoine`.

    Returns
    -------
    constants : dict
        ``a``, ``b``, ``c`` and ``form``, as `antoine` takes them.

    Raises
    ------
    ValueError
        If the points differ in number, are too few, a temperature or pressure is not positive, `form` is
        unknown, or no curve of this kind runs through the points with its pole below all of them.

    Notes
    -----
    Least squares of :math:`\ln p_v`. With t in degC, :math:`t \ln p_v = A t + (AC - B) - C \ln p_v` is linear
    in its three unknowns and gives the start; its residuals are those of the logarithm times t + C, so a few
    steps on the logarithm itself follow. For water from 0 to 150 degC
    the best curve is off by 0.5 % at worst.

    Examples
    --------
    >>> from sklvalve.mechanism import water_vapour_pressure
    >>> t = [280.0, 310.0, 340.0, 370.0, 400.0]
    >>> constants = fit_antoine(t, water_vapour_pressure(t))
    >>> round(float(antoine(373.1243, **constants)) / 1e3, 1)
    101.2
    """
    to_logarithm = _log_units(form)
    temperature, log_pressure = _points(temperature, p_vapour, 3)
    t = temperature - 273.15
    log = to_logarithm(log_pressure)
    # centred, so that the three columns do not run alike
    middle, spread = float(np.mean(t)), float(np.std(t))
    z = (t - middle) / spread
    design = np.column_stack([z, np.ones_like(z), -log])
    a, constant, c = np.linalg.lstsq(design, z * log, rcond=None)[0]
    if not np.all(z + c > 0.0):
        raise ValueError(
            "no Antoine curve has its pole below all the temperatures and passes these points: check "
            "them, or use fit_clausius_clapeyron."
        )

    def residual(theta):
        # the logarithm of the distance to the pole keeps the pole below the coldest point
        return theta[0] - theta[1] / (z - z.min() + np.exp(theta[2])) - log

    start = np.array([a, a * c - constant, np.log(c + z.min())])
    a, b, distance = least_squares(residual, start, method="lm", xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    c = np.exp(distance) - z.min()
    return {"a": float(a), "b": float(b * spread), "c": float(c * spread - middle), "form": form}


def _points(temperature, p_vapour, at_least):
    temperature, p_vapour = np.asarray(temperature, dtype=float), np.asarray(p_vapour, dtype=float)
    if temperature.ndim != 1 or temperature.shape != p_vapour.shape:
        raise ValueError(
            "temperature and p_vapour must be two rows of the same length; got shapes "
            f"{temperature.shape} and {p_vapour.shape}."
        )
    for name, values in (("temperature", temperature), ("p_vapour", p_vapour)):
        if not np.all((values > 0.0) & (values < np.inf)):
            raise ValueError(f"every {name} of the points must be a positive number: leave out the others.")
    different = len(np.unique(temperature))
    if different < at_least:
        raise ValueError(f"at least {at_least} different temperatures are needed; got {different}.")
    return temperature, np.log(p_vapour)


def _log_units(form):
    """From the natural logarithm of Pa to the logarithm that `form` means."""
    if form == "ln_kPa":
        return lambda log_pressure: log_pressure - np.log(1e3)
    if form == "log10_mmHg":
        return lambda log_pressure: (log_pressure - np.log(101325.0 / 760.0)) / np.log(10.0)
    raise ValueError(f"form must be 'log10_mmHg' or 'ln_kPa'; got {form!r}.")
