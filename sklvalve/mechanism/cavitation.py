# SPDX-License-Identifier: BSD-3-Clause
"""How near a liquid is to cavitation: cavitation index, pressure ratio and its incipient value."""

import numpy as np

from sklvalve.mechanism._liquid_inputs import Screen, positive
from sklvalve.mechanism.validity import quiet, warn_rows

_REFERENCE_PRESSURE = 6e5
_N34 = 1.0


def cavitation_index(p1, p2, p_vapour, *, warn=True):
    r"""Cavitation index sigma: how far from cavitation a valve works.

    Parameters
    ----------
    p1, p2 : float or array-like
        Pressures before and behind the valve, absolute. [Pa]
    p_vapour : float or array-like
        Vapour pressure at the inlet temperature. [Pa]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows without an answer.

    Returns
    -------
    sigma : float or ndarray
        Cavitation index; infinite without a pressure drop, 1 where the outlet is at vapour pressure. NaN
        where the liquid boils before the valve, or a pressure is below zero absolute. [1]

    Notes
    -----
    .. math:: \sigma = \frac{p_1 - p_v}{p_1 - p_2}

    One of several definitions in use: ISA-RP75.23 takes this one, others count the pressure behind the valve,
    :math:`(p_2 - p_v) / \Delta p = \sigma - 1`. For flow backwards the pressures swap roles.

    References
    ----------
    .. [1] ISA-RP75.23, Considerations for evaluating control valve cavitation.

    Examples
    --------
    >>> float(cavitation_index(1000e3, 800e3, 200e3))
    4.0
    """
    with quiet():
        return 1.0 / _ratio(p1, p2, p_vapour, "cavitation_index", warn)


def pressure_ratio_xf(p1, p2, p_vapour, *, warn=True):
    r"""Differential pressure ratio x_F of a liquid, one over the cavitation index.

    Parameters
    ----------
    p1, p2, p_vapour, warn
        As in `cavitation_index`.

    Returns
    -------
    xf : float or ndarray
        Ratio: 0 without a pressure drop, 1 where the outlet is at vapour pressure, above it flashing. NaN
        where the liquid boils before the valve, or a pressure is below zero absolute. [1]

    Notes
    -----
    .. math:: x_F = \frac{p_1 - p_2}{p_1 - p_v}

    References
    ----------
    .. [1] IEC 60534-8-4, Industrial-process control valves: prediction of noise from hydrodynamic flow.

    Examples
    --------
    >>> float(pressure_ratio_xf(1000e3, 800e3, 200e3))
    0.25
    """
    return _ratio(p1, p2, p_vapour, "pressure_ratio_xf", warn)


def incipient_xfz(kv, fl, fd, *, p1=None):
    r"""Differential pressure ratio at which cavitation begins, x_Fz, where no measured one is at hand.

    Parameters
    ----------
    kv : float or array-like
        Flow coefficient at the actual opening. [m3/h]
    fl : float or array-like
        Pressure recovery factor there. [1]
    fd : float or array-like
        Valve style modifier there. [1]
    p1 : float or array-like, default=None
        Pressure before the valve; None gives the value at 6 bar. [Pa]

    Returns
    -------
    xfz : float or ndarray
        Ratio x_F from which on cavitation can be heard; at most 0.9 at 6 bar. NaN where `fl`, `fd` or `p1` is
        not positive, or `kv` is negative. [1]

    Notes
    -----
    .. math:: x_{Fz} = \frac{0.9}{\sqrt{1 + 3 F_d \sqrt{K_v / (N_{34} F_L)}}}, \qquad
              x_{Fz}(p_1) = x_{Fz} \left(\frac{6\,\mathrm{bar}}{p_1}\right)^{0.125}

    with N34 = 1 for m3/h. An estimate for globe, ball and butterfly valves without special trim; a measured
    one, multiplied by the second factor, is better. Cavitation begins well before the flow is choked.

    References
    ----------
    .. [1] IEC 60534-8-4, Industrial-process control valves: prediction of noise from hydrodynamic flow.

    Examples
    --------
    >>> round(float(incipient_xfz(90.0, 0.92, 0.42)), 3)
    0.245
    >>> round(float(incipient_xfz(90.0, 0.92, 0.42, p1=10e5)), 3)
    0.23
    """
    kv, fl, fd = np.asarray(kv, dtype=float), positive(fl), positive(fd)
    with quiet():
        xfz = 0.9 / np.sqrt(1.0 + 3.0 * fd * np.sqrt(kv / (_N34 * fl)))
        if p1 is None:
            return xfz
        return xfz * (_REFERENCE_PRESSURE / positive(p1)) ** 0.125


def _ratio(p1, p2, p_vapour, where, warn):
    screen = Screen()
    p1, p2, p_vapour = screen.pressures(p1, p2, p_vapour)
    with quiet():
        above = np.maximum(p1, p2) - p_vapour
        ratio = np.abs(p1 - p2) / np.where(above > 0.0, above, np.nan)[()]
    if warn:
        what = "have liquid at or below its vapour pressure before the valve: NaN."
        warn_rows(above <= 0.0, where, what, stacklevel=4)
        screen.warn(where, ratio, stacklevel=5)
    return ratio
