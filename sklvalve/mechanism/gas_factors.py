# SPDX-License-Identifier: BSD-3-Clause
"""Factors of a gas in a control valve: heat capacities, reducers, expansion, and where the flow chokes."""

import numpy as np

from sklvalve.mechanism._constants import N2, capacity_over_bore
from sklvalve.mechanism.validity import warn_rows

# x_T belongs to the choked flow, where Y is 2/3, and the inlet's loss lowers pressure and density at once
_N5 = 9.0 / 8.0 * N2


def specific_heat_ratio_factor(gamma):
    r"""Specific heat ratio factor F_gamma.

    Parameters
    ----------
    gamma : float or array-like
        Ratio of the heat capacities of the gas. [1]

    Returns
    -------
    f_gamma : float or ndarray
        Factor on x_T, which is measured with air. [1]

    Notes
    -----
    .. math:: F_\gamma = \gamma / 1.4

    For ideal gases with :math:`1.08 < \gamma < 1.65`.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    >>> round(float(specific_heat_ratio_factor(1.3)), 3)
    0.929
    """
    return np.asarray(gamma, dtype=float) / 1.4


def combined_drop_ratio_factor(kv, nominal_size, zeta_sum, zeta_inlet, xt, *, warn=True):
    r"""Pressure drop ratio factor x_TP of a valve with its reducers.

    Parameters
    ----------
    kv : float or array-like
        Flow coefficient of the valve without reducers, at the actual opening. [m3/h]
    nominal_size : float or array-like
        Bore of the valve's ends. [m]
    zeta_sum, zeta_inlet : float or array-like
        Loss coefficients of the reducers, see `fitting_loss`. [1]
    xt : float or array-like
        Pressure drop ratio factor of the valve alone at its actual travel. [1]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows without an answer.

    Returns
    -------
    xtp : float or ndarray
        Combined factor; NaN where a negative `zeta_sum` outweighs the valve. [1]

    Notes
    -----
    .. math:: x_{TP} = \frac{x_T}{F_P^2}
              \left(1 + \frac{x_T\,\zeta_i}{N_5} \left(\frac{K_v}{d^2}\right)^2\right)^{-1}

    with N5 = 0.0018 for m3/h and mm, which is 9/8 of N2.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    Worked example 3 of the standard:

    >>> from sklvalve.mechanism import fitting_loss
    >>> zeta_sum, zeta_inlet = fitting_loss(0.050, 0.080, 0.100)
    >>> round(float(combined_drop_ratio_factor(70.9, 0.050, zeta_sum, zeta_inlet, 0.6)), 3)
    0.625
    """
    kv, zeta_sum, zeta_inlet, xt = (np.asarray(v, dtype=float) for v in (kv, zeta_sum, zeta_inlet, xt))
    with np.errstate(all="ignore"):
        shares = fitting_share(nominal_size, zeta_sum), inlet_share(nominal_size, zeta_inlet, xt)
        _, xtp = between_reducers(kv, xt, *shares)
        known = ~np.isnan(kv + shares[0] + shares[1])
    if warn:
        what = "have reducers that would give back more than the valve takes: NaN."
        warn_rows(np.isnan(xtp) & known, "combined_drop_ratio_factor", what)
    return xtp[()]


def choked_drop_ratio(gamma, xt):
    r"""Ratio of pressure drop to inlet pressure from which on the flow of a gas no longer grows.

    Parameters
    ----------
    gamma : float or array-like
        Ratio of the heat capacities of the gas. [1]
    xt : float or array-like
        Pressure drop ratio factor of the valve at its actual travel; with reducers x_TP, see
        `combined_drop_ratio_factor`. [1]

    Returns
    -------
    x_choked : float or ndarray
        Choked pressure drop ratio; at 1 or more the flow never chokes. [1]

    Notes
    -----
    .. math:: x_{choked} = F_\gamma x_{TP}

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    The outlet pressure at which choking sets in [kPa]:

    >>> round(100.0 * (1.0 - float(choked_drop_ratio(1.3, 1.0))), 3)
    7.143
    """
    with np.errstate(all="ignore"):
        return specific_heat_ratio_factor(gamma) * np.asarray(xt, dtype=float)


def expansion_factor(x, x_choked):
    r"""Expansion factor Y of a gas in turbulent flow.

    Parameters
    ----------
    x : float or array-like
        Ratio of the pressure drop to the pressure before the valve. [1]
    x_choked : float or array-like
        The ratio at which the flow chokes, see `choked_drop_ratio`. [1]

    Returns
    -------
    y : float or ndarray
        1 without a drop, 2/3 from the onset of choking on; NaN for a negative ratio. [1]

    Notes
    -----
    .. math:: Y = 1 - \frac{\min(x,\, x_{choked})}{3\, x_{choked}}

    With reducers the choked ratio is that of x_TP, in this equation too. At the onset of choking
    :math:`\sqrt{x}\,Y` has its maximum, so the flow enters choking without a kink.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    >>> expansion_factor([0.0, 0.3, 0.9], 0.6).round(4)
    array([1.    , 0.8333, 0.6667])
    """
    x, x_choked = np.asarray(x, dtype=float), np.asarray(x_choked, dtype=float)
    with np.errstate(all="ignore"):
        factor = 1.0 - np.minimum(x, x_choked) / (3.0 * x_choked)
    return np.where((x >= 0.0) & (x_choked > 0.0), factor, np.nan)[()]


def between_reducers(kv, xt, fittings, inlet):
    """Effective flow coefficient kv F_P, and x_TP, from the shares of the reducers."""
    square = kv * kv
    loss = positive(1.0 + fittings * square)
    return kv / np.sqrt(loss), xt * loss / positive(1.0 + inlet * square)


def positive(values):
    """The values as floats, NaN where they are not positive."""
    values = np.asarray(values, dtype=float)
    return np.where(values > 0.0, values, np.nan)[()]


def fitting_share(nominal_size, zeta_sum):
    """What the reducers take of each square of kv: F_P**-2 = 1 + kv**2 share. [h2/m6]"""
    return np.asarray(zeta_sum, dtype=float) / N2 * capacity_over_bore(1.0, nominal_size) ** 2


def inlet_share(nominal_size, zeta_inlet, xt):
    """The same for the inlet's part of x_TP. [h2/m6]"""
    loss = np.asarray(xt, dtype=float) * np.asarray(zeta_inlet, dtype=float) / _N5
    return loss * capacity_over_bore(1.0, nominal_size) ** 2
