# SPDX-License-Identifier: BSD-3-Clause
"""The valve in its plant: what is left of its characteristic when the plant takes part of the drop."""

import numpy as np

from sklvalve.mechanism.characteristic import opening_for_capacity, relative_capacity
from sklvalve.mechanism.validity import warn_rows

_ROUNDING = 4.0 * np.finfo(float).eps


def valve_authority(dp_open, dp_system):
    r"""Authority of a valve: its part of the drop of the whole system when it is fully open.

    Parameters
    ----------
    dp_open : float or array-like
        Pressure drop over the fully open valve, at the flow that passes then. [Pa]
    dp_system : float or array-like
        Pressure drop of valve and plant together: what stands over the valve when it is shut. [Pa]

    Returns
    -------
    authority : float or ndarray
        Between 0 and 1; NaN where the first drop is not positive or exceeds the second. [1]

    Notes
    -----
    .. math:: s = \Delta p_{open} / \Delta p_{system}

    Examples
    --------
    >>> float(valve_authority(0.6e5, 2.0e5))
    0.3
    """
    dp_open, dp_system = np.asarray(dp_open, dtype=float), np.asarray(dp_system, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where((dp_open > 0.0) & (dp_open <= dp_system), dp_open / dp_system, np.nan)[()]


def installed_characteristic(
    opening, characteristic, *, authority, rangeability=None, shutoff=0.0, leakage=0.0, warn=True
):
    r"""Flow at an opening, relative to the flow at the rated capacity, in a plant with a quadratic drop.

    Parameters
    ----------
    opening : float or array-like
        Relative travel, 0 shut, 1 open. [1]
    characteristic, rangeability, shutoff, leakage
        As in `relative_capacity`.
    authority : float or array-like
        Part of the valve in the drop of the system when open, see `valve_authority`. [1]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of openings outside [0, 1] and of authorities outside (0, 1].

    Returns
    -------
    relative_flow : float or ndarray
        Q / Q_max; NaN where the authority lies outside (0, 1]. [1]

    Raises
    ------
    ValueError
        As `relative_capacity`.

    See Also
    --------
    opening_for_installed : The exact inverse.

    Notes
    -----
    .. math:: \frac{Q}{Q_{max}} = \left[1 + s\left(\frac{1}{\varphi^2} - 1\right)\right]^{-1/2}

    Holds for a constant pressure over the whole system, a plant whose drop grows with the square of the flow,
    and a valve that is turbulent and not choked. With s = 1 it is the inherent characteristic itself.

    Examples
    --------
    In a plant that takes nine tenths of the drop, equal percentage becomes nearly linear:

    >>> half = installed_characteristic(0.5, "equal_percentage", authority=0.1, rangeability=50)
    >>> round(float(half), 3)
    0.412
    """
    phi = relative_capacity(
        opening, characteristic, rangeability=rangeability, shutoff=shutoff, leakage=leakage, warn=warn
    )
    return _installed(phi, _authority(authority, "installed_characteristic", warn))[()]


def opening_for_installed(
    relative_flow, characteristic, *, authority, rangeability=None, shutoff=0.0, leakage=0.0, warn=True
):
    r"""Opening that passes a given part of the largest flow: the inverse of `installed_characteristic`.

    Parameters
    ----------
    relative_flow : float or array-like
        Q / Q_max. [1]
    characteristic, authority, rangeability, shutoff, leakage
        As in `installed_characteristic`.
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows whose flow no opening gives.

    Returns
    -------
    opening : float or ndarray
        Opening in [0, 1]; NaN where no opening passes this flow. [1]

    Raises
    ------
    ValueError
        As `relative_capacity`.

    Notes
    -----
    .. math:: \varphi = q \sqrt{\frac{s}{1 - (1-s)\,q^2}}, \qquad q = Q/Q_{max}

    Near q = 1 and with a small authority the opening hangs on the last digits of the flow: the valve hardly
    matters there.

    Examples
    --------
    >>> round(float(opening_for_installed(0.412, "equal_percentage", authority=0.1, rangeability=50)), 2)
    0.5
    """
    q = np.asarray(relative_flow, dtype=float)
    s = _authority(authority, "opening_for_installed", warn)
    # as many factors as keep the digits where q is nearly 1
    rest = (1.0 - q) * (1.0 + q) + s * q * q
    phi = q * np.sqrt(s / np.where(rest > 0.0, rest, np.nan))
    # a small authority turns the rounding of the largest flow into a capacity that no opening has
    most = relative_capacity(1.0, characteristic, rangeability=rangeability, shutoff=shutoff, leakage=leakage)
    largest = _installed(most, s)
    phi = np.where(np.abs(q - largest) <= _ROUNDING * largest, most, phi)
    unlimited = ~(rest > 0.0) & ~np.isnan(q) & ~np.isnan(s)
    if warn:
        warn_rows(unlimited, "opening_for_installed", "ask for more than a valve without drop passes: NaN.")
    return opening_for_capacity(
        phi, characteristic, rangeability=rangeability, shutoff=shutoff, leakage=leakage, warn=warn
    )


def _installed(phi, s):
    # without 1 / phi, so that a shut valve needs no limit
    return phi / np.sqrt(phi * phi + s * (1.0 - phi) * (1.0 + phi))


def _authority(authority, name, warn):
    s = np.asarray(authority, dtype=float)
    inside = (s > 0.0) & (s <= 1.0)
    if warn:
        what = "have an authority outside (0, 1] and give NaN."
        warn_rows(~inside & ~np.isnan(s), name, what, stacklevel=4)
    return np.where(inside, s, np.nan)
