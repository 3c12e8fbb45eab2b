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
from sklvalve.mechanism.installed import installed_characteristic, opening_for_installed, valve_authority
from sklvalve.mechanism.liquid import (
    choked_pressure_drop,
    critical_pressure_ratio_factor,
    liquid_flow,
    liquid_kv,
)
from sklvalve.mechanism.liquid_pressure import liquid_inlet_pressure, liquid_outlet_pressure
from sklvalve.mechanism.orifice import (
    area_from_kv,
    estimate_fl,
    orifice_area,
    orifice_flow,
    vena_contracta_pressure,
)
from sklvalve.mechanism.piping import combined_recovery_factor, fitting_loss, piping_factor
from sklvalve.mechanism.transformer import ValveMechanismTransformer
from sklvalve.mechanism.travel import at_travel
from sklvalve.mechanism.validity import ValidityWarning
from sklvalve.mechanism.water import water_density, water_kinematic_viscosity, water_vapour_pressure

__all__ = [
    "CHARACTERISTICS",
    "WATER_ANTOINE",
    "WATER_CLAUSIUS_CLAPEYRON",
    "Fluid",
    "ValidityWarning",
    "ValveMechanismTransformer",
    "antoine",
    "area_from_kv",
    "at_travel",
    "choked_pressure_drop",
    "clausius_clapeyron",
    "combined_recovery_factor",
    "critical_pressure_ratio_factor",
    "estimate_fl",
    "fitting_loss",
    "fluid_from",
    "installed_characteristic",
    "liquid_flow",
    "liquid_inlet_pressure",
    "liquid_kv",
    "liquid_outlet_pressure",
    "opening_for_capacity",
    "opening_for_installed",
    "orifice_area",
    "orifice_flow",
    "piping_factor",
    "relative_capacity",
    "valve_authority",
    "vena_contracta_pressure",
    "water_density",
    "water_kinematic_viscosity",
    "water_vapour_pressure",
]
