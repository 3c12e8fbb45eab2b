# SPDX-License-Identifier: BSD-3-Clause
"""Numbers of IEC 60534-2-1 for liquids, N1 exact, the others as the standard prints them; those of water.

N2, N4, N18 and N32 hold for flow coefficients and flows in m3/h, sizes in mm and viscosities in m2/s. From N1
would follow N2 = 1.6003e-3 and N4 = 7.074e-2; the published and reference cases are computed with the printed
figures, so those are kept.
"""

import numpy as np

REFERENCE_DENSITY = 999.1026
"""Density of water at 15 degC and 0.1 MPa (IAPWS): IEC 60534 takes densities relative to it. [kg/m3]"""

# Q = FLOW_CONSTANT Kv sqrt(dp / rho) in SI with Kv in m3/h; N1 = 0.1 itself holds for m3/h and kPa
FLOW_CONSTANT = 0.1 / 3600.0 * np.sqrt(REFERENCE_DENSITY / 1000.0)

N2 = 1.60e-3
N4 = 7.07e-2
N18 = 0.865
N32 = 140.0

MM = 1e3
HOUR = 3600.0

LAMINAR_REYNOLDS = 10.0
TURBULENT_REYNOLDS = 1e4

# C / d2 from which on a trim is full-size, and up to which the equations were fitted
FULL_SIZE = 0.016 * N18
WIDEST = 0.047 * N18

# of water, IAPWS
CRITICAL_TEMPERATURE = 647.096
CRITICAL_PRESSURE = 22.064e6
CRITICAL_DENSITY = 322.0
WATER_MOLAR_MASS = 0.018015268
# freezing at one atmosphere; a hair below the triple point, so that 0 degC is inside
FREEZING = 273.15
# liquid water does not exist below, and its formulas run away
COLDEST = 230.0
# up to here the four terms were compared with the full viscosity formulation (0.2 %)
VISCOSITY_LIMIT = 423.15


def capacity_over_bore(kv, nominal_size):
    """C / d2 of the standard, in m3/h and mm."""
    size = MM * np.asarray(nominal_size, dtype=float)
    return np.asarray(kv, dtype=float) / (size * size)
