# SPDX-License-Identifier: BSD-3-Clause
"""What physics says about a control valve: array functions in SI, and the transformer that binds them."""

from sklvalve.mechanism.characteristic import CHARACTERISTICS, opening_for_capacity, relative_capacity
from sklvalve.mechanism.fluid import (
    WATER_ANTOINE,
    WATER_CLAUSIUS_CLAPEYRON,
    Fluid,
    antoine,
    clausius_clapeyron,
    fluid_from,
)
from sklvalve.mechanism.liquid import (
    choked_pressure_drop,
    critical_pressure_ratio_factor,
    liquid_flow,
    liquid_inlet_pressure,
    liquid_kv,
    liquid_outlet_pressure,
)
from sklvalve.mechanism.validity import ValidityWarning
from sklvalve.mechanism.water import water_density, water_kinematic_viscosity, water_vapour_pressure

__all__ = [
    "CHARACTERISTICS",
    "WATER_ANTOINE",
    "WATER_CLAUSIUS_CLAPEYRON",
    "Fluid",
    "ValidityWarning",
    "antoine",
    "choked_pressure_drop",
    "clausius_clapeyron",
    "critical_pressure_ratio_factor",
    "fluid_from",
    "liquid_flow",
    "liquid_inlet_pressure",
    "liquid_kv",
    "liquid_outlet_pressure",
    "opening_for_capacity",
    "relative_capacity",
    "water_density",
    "water_kinematic_viscosity",
    "water_vapour_pressure",
]
