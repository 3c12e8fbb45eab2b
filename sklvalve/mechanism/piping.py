# SPDX-License-Identifier: BSD-3-Clause
"""Reducers at the valve: how much of its capacity and of its pressure recovery they leave."""

import numpy as np

from sklvalve.mechanism._constants import N2, capacity_over_bore
from sklvalve.mechanism._liquid_inputs import complete, positive
from sklvalve.mechanism.validity import quiet, warn_rows


def fitting_loss(nominal_size, inlet_pipe, outlet_pipe):
    r"""Loss coefficients of short concentric reducers before and behind a valve.

    Parameters
    ----------
    nominal_size : float or array-like
        Bore of the valve's ends. [m]
    inlet_pipe, outlet_pipe : float or array-like
        Bore of the pipes before and behind it. [m]

    Returns
    -------
    zeta_sum : float or ndarray
        Sum of the losses and of the two Bernoulli coefficients; 0 where all sizes are equal, NaN where one
        is not positive. [1]
    zeta_inlet : float or ndarray
        The inlet's part of it. [1]

    Notes
    -----
    .. math:: \zeta_1 = \tfrac12 (1 - (d/D_1)^2)^2, \quad \zeta_2 = (1 - (d/D_2)^2)^2, \quad
              \zeta_{Bi} = 1 - (d/D_i)^4

    .. math:: \textstyle\sum\zeta = \zeta_1 + \zeta_2 + \zeta_{B1} - \zeta_{B2}, \qquad
              \zeta_i = \zeta_1 + \zeta_{B1}

    For abrupt concentric reducers close to the valve; measured coefficients are better where there are any.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    >>> zeta_sum, zeta_inlet = fitting_loss(0.050, 0.080, 0.100)
    >>> round(float(zeta_sum), 3), round(float(zeta_inlet), 3)
    (0.658, 1.033)
    """
    size = positive(nominal_size)
    with quiet():
        inlet = (size / positive(inlet_pipe)) ** 2
        outlet = (size / positive(outlet_pipe)) ** 2
        zeta_inlet = 0.5 * (1.0 - inlet) ** 2 + (1.0 - inlet**2)
        zeta_outlet = (1.0 - outlet) ** 2 - (1.0 - outlet**2)
        return zeta_inlet + zeta_outlet, zeta_inlet


def piping_factor(kv, nominal_size, zeta_sum, *, warn=True):
    r"""Piping geometry factor F_P: what the reducers leave of the capacity.

    Parameters
    ----------
    kv : float or array-like
        Flow coefficient of the valve without reducers, at the actual opening. [m3/h]
    nominal_size : float or array-like
        Bore of the valve's ends. [m]
    zeta_sum : float or array-like
        Sum of the loss coefficients, see `fitting_loss`. [1]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows without an answer.

    Returns
    -------
    fp : float or ndarray
        Factor on the flow coefficient. NaN where a negative `zeta_sum` outweighs the valve, or
        `nominal_size` is not positive. [1]

    Notes
    -----
    .. math:: F_P = \left(1 + \frac{\sum\zeta}{N_2} \left(\frac{K_v}{d^2}\right)^2\right)^{-1/2}

    with N2 = 0.0016 for m3/h and mm. With the flow coefficient given there is nothing to iterate.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    >>> round(float(piping_factor(70.9, 0.050, 0.658)), 3)
    0.867
    """
    size = positive(nominal_size)
    with quiet():
        fp = _one_over_root(np.asarray(zeta_sum, dtype=float) * _relative_size(kv, size))
    if warn:
        known = complete(kv, zeta_sum, size)
        senseless = np.asarray(nominal_size, dtype=float) <= 0.0
        warn_rows(senseless, "piping_factor", "have a nominal_size that is not positive and give NaN.")
        what = "have reducers that would give back more than the valve takes: NaN."
        warn_rows(np.isnan(fp) & known, "piping_factor", what)
    return fp


def combined_recovery_factor(kv, nominal_size, zeta_inlet, fl):
    r"""Pressure recovery factor F_LP of a valve with its inlet reducer.

    Parameters
    ----------
    kv, nominal_size
        As in `piping_factor`.
    zeta_inlet : float or array-like
        Loss coefficient of the inlet, see `fitting_loss`. [1]
    fl : float or array-like
        Pressure recovery factor of the valve alone. [1]

    Returns
    -------
    flp : float or ndarray
        Combined factor; call the liquid functions with ``kv * fp`` and ``fl=flp / fp``. NaN where `fl` or
        `nominal_size` is not positive. [1]

    Notes
    -----
    .. math:: F_{LP} = F_L \left(1 + \frac{F_L^2\,\zeta_i}{N_2} \left(\frac{K_v}{d^2}\right)^2\right)^{-1/2}

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    >>> round(float(combined_recovery_factor(70.9, 0.050, 1.033, 0.9)), 3)
    0.755
    """
    fl = positive(fl)
    with quiet():
        share = np.asarray(zeta_inlet, dtype=float) * _relative_size(kv, positive(nominal_size))
        return fl * _one_over_root(fl * fl * share)


def _relative_size(kv, nominal_size):
    return capacity_over_bore(kv, nominal_size) ** 2 / N2


def _one_over_root(excess):
    return 1.0 / np.sqrt(np.where(excess > -1.0, 1.0 + excess, np.nan))[()]
