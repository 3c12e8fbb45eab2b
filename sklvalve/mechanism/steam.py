# SPDX-License-Identifier: BSD-3-Clause
"""Saturated steam: density and viscosity from temperature."""

import numpy as np

from sklvalve.mechanism._constants import CRITICAL_DENSITY, CRITICAL_TEMPERATURE, WATER_MOLAR_MASS
from sklvalve.mechanism.water import saturation_tau

STEAM_MOLAR_MASS = WATER_MOLAR_MASS
"""Molar mass of water, IAPWS. [kg/mol]"""

# powers of 1/T and of the density in the residual part of the viscosity, and their factors
_VISCOSITY_TERMS = (
    (0, 0, 0.520094),
    (1, 0, 0.0850895),
    (2, 0, -1.08374),
    (3, 0, -0.289555),
    (0, 1, 0.222531),
    (1, 1, 0.999115),
    (2, 1, 1.88797),
    (3, 1, 1.26613),
    (5, 1, 0.120573),
    (0, 2, -0.281378),
    (1, 2, -0.906851),
    (2, 2, -0.772479),
    (3, 2, -0.489837),
    (4, 2, -0.257040),
    (0, 3, 0.161913),
    (1, 3, 0.257399),
    (0, 4, -0.0325372),
    (3, 4, 0.0698452),
    (4, 5, 0.00872102),
    (3, 6, -0.00435673),
    (5, 6, -0.000593264),
)


def steam_density(temperature, *, warn=True):
    r"""Density of saturated steam, for the gas equations of a valve in steam service.

    Parameters
    ----------
    temperature : float or array-like
        Temperature; from a pressure by `water_saturation_temperature`. [K]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of temperatures outside 273.15 to 647.096 K.

    Returns
    -------
    density : float or ndarray
        Density of the vapour that boils off; NaN below 230 K and above the critical temperature. [kg/m3]

    Notes
    -----
    With :math:`\tau = 1 - T/T_c`

    .. math:: \ln\frac{\rho}{\rho_c} = c_1 \tau^{2/6} + c_2 \tau^{4/6} + c_3 \tau^{8/6} + c_4 \tau^{18/6}
              + c_5 \tau^{37/6} + c_6 \tau^{71/6}

    Dry and saturated; superheated steam of the same pressure is lighter (by 6 % for 20 K at 10 bar).

    References
    ----------
    .. [1] IAPWS SR1-86(1992), Saturation properties of ordinary water substance.

    Examples
    --------
    >>> round(float(steam_density(373.1243)), 6)
    0.597586
    """
    _, tau = saturation_tau(temperature, "steam_density", warn)
    third = np.cbrt(tau)
    sixth = np.sqrt(third)
    tau3 = tau**3
    tau6 = tau3 * tau3
    series = third * (-2.03150240 - 2.68302940 * third - 5.38626492 * tau)
    series = series - 17.2991605 * tau3 - 44.7586581 * tau6 * sixth
    series = series - 63.9201063 * tau6 * tau3 * tau**2 * third * third * sixth
    return CRITICAL_DENSITY * np.exp(series)


def steam_kinematic_viscosity(temperature, *, warn=True):
    r"""Kinematic viscosity of saturated steam.

    Parameters
    ----------
    temperature : float or array-like
        Temperature. [K]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of temperatures outside 273.15 to 647.096 K.

    Returns
    -------
    kinematic_viscosity : float or ndarray
        Dynamic viscosity over density; NaN below 230 K and above the critical temperature. [m2/s]

    Notes
    -----
    .. math:: \eta = \eta_0(T)\, \exp\Bigl[\bar\rho \sum_{ij} H_{ij}\, (1/\bar T - 1)^i (\bar\rho - 1)^j\Bigr]

    with :math:`\bar T = T/T_c` and :math:`\bar\rho = \rho/\rho_c`. The critical enhancement, which matters
    within a degree of the critical point, is left out.

    References
    ----------
    .. [1] IAPWS R12-08, Viscosity of ordinary water substance.

    Examples
    --------
    >>> round(float(steam_kinematic_viscosity(373.1243)) * 1e6, 2)
    20.47
    """
    temperature, _ = saturation_tau(temperature, "steam_kinematic_viscosity", warn)
    density = steam_density(temperature, warn=False)
    return _dynamic_viscosity(temperature, density) / density


def _dynamic_viscosity(temperature, density):
    inverse = CRITICAL_TEMPERATURE / temperature
    dilute = 1.67752 + inverse * (2.20462 + inverse * (0.6366564 - 0.241605 * inverse))
    dense = density / CRITICAL_DENSITY
    residual = sum(factor * (inverse - 1.0) ** i * (dense - 1.0) ** j for i, j, factor in _VISCOSITY_TERMS)
    return 1e-4 / np.sqrt(inverse) / dilute * np.exp(dense * residual)
