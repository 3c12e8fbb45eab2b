# SPDX-License-Identifier: BSD-3-Clause
"""What flows through the plant: density, vapour pressure, least pressure in the jet, over temperature."""

import numpy as np

FLUIDS = ("water", "hot_water", "oil")
# what a data sheet says of the oil; its vapour pressure is next to nothing
OIL_DENSITY, OIL_EXPANSION, OIL_VAPOUR = 872.0, 7.4e-4, 20.0
_CRITICAL = 22.06e6


def water_density(celsius):
    """Of water at moderate pressure [kg/m3], a rational fit good to 0.05 % from 0 to 160 degC."""
    t = np.asarray(celsius, dtype=float)
    return 1000.0 * (1.0 - (t - 3.98) ** 2 * (t + 283.0) / (503570.0 * (t + 67.26)))


def water_vapour(celsius):
    """Vapour pressure of water [Pa], Antoine's equation with a set of constants on each side of 100 degC."""
    t = np.asarray(celsius, dtype=float)
    below = 8.07131 - 1730.63 / (233.426 + t)
    above = 8.14019 - 1810.94 / (244.485 + t)
    return 133.322 * 10.0 ** np.where(t < 100.0, below, above)


def properties(fluid, celsius):
    """Density [kg/m3], vapour pressure [Pa] and the least pressure in the jet [Pa], each over time."""
    if fluid == "oil":
        density = OIL_DENSITY * (1.0 - OIL_EXPANSION * (celsius - 20.0))
        vapour = np.full_like(celsius, OIL_VAPOUR)
    else:
        density, vapour = water_density(celsius), water_vapour(celsius)
    # a jet boils a little below its vapour pressure, the more so the nearer the critical point
    return density, vapour, vapour * (0.955 - 0.27 * np.sqrt(vapour / _CRITICAL))
