# SPDX-License-Identifier: BSD-3-Clause
"""What physics says about a control valve: array functions in SI, and the transformer that binds them."""

from sklvalve.mechanism.cavitation import cavitation_index, incipient_xfz, pressure_ratio_xf
from sklvalve.mechanism.characteristic import CHARACTERISTICS, opening_for_capacity, relative_capacity
from sklvalve.mechanism.fluid import Fluid, fluid_from
from sklvalve.mechanism.gas import gas_flow, gas_kv
from sklvalve.mechanism.gas_factors import (
    choked_drop_ratio,
    combined_drop_ratio_factor,
    expansion_factor,
    specific_heat_ratio_factor,
)
from sklvalve.mechanism.gas_pressure import gas_inlet_pressure, gas_outlet_pressure
from sklvalve.mechanism.gas_states import GAS_STATES, gas_state
from sklvalve.mechanism.gas_units import (
    GAS_CONSTANT,
    GAS_FLOW_BASES,
    gas_density,
    gas_mass_flow,
    gas_volume_flow,
)
from sklvalve.mechanism.installed import installed_characteristic, opening_for_installed, valve_authority
from sklvalve.mechanism.juice import juice_density, juice_kinematic_viscosity, juice_vapour_pressure
from sklvalve.mechanism.liquid import (
    choked_pressure_drop,
    critical_pressure_ratio_factor,
    liquid_flow,
    liquid_kv,
)
from sklvalve.mechanism.liquid_pressure import liquid_inlet_pressure, liquid_outlet_pressure
from sklvalve.mechanism.opening import opening_for_flow, opening_for_gas_flow
from sklvalve.mechanism.orifice import (
    area_from_kv,
    estimate_fl,
    orifice_area,
    orifice_flow,
    vena_contracta_pressure,
)
from sklvalve.mechanism.piping import combined_recovery_factor, fitting_loss, piping_factor
from sklvalve.mechanism.rating import rate_liquid
from sklvalve.mechanism.states import LIQUID_STATES, liquid_state
from sklvalve.mechanism.steam import STEAM_MOLAR_MASS, steam_density, steam_kinematic_viscosity
from sklvalve.mechanism.transformer import ValveMechanismTransformer
from sklvalve.mechanism.travel import at_travel
from sklvalve.mechanism.trim import trim_parameter
from sklvalve.mechanism.validity import ValidityWarning
from sklvalve.mechanism.vapour_pressure import (
    WATER_ANTOINE,
    WATER_CLAUSIUS_CLAPEYRON,
    antoine,
    clausius_clapeyron,
    fit_antoine,
    fit_clausius_clapeyron,
)
from sklvalve.mechanism.viscosity import (
    nonturbulent_flow_ratio,
    nonturbulent_kv,
    reynolds_factor,
    valve_reynolds_number,
)
from sklvalve.mechanism.water import (
    water_density,
    water_kinematic_viscosity,
    water_saturation_temperature,
    water_vapour_pressure,
)

__all__ = [
    "CHARACTERISTICS",
    "GAS_CONSTANT",
    "GAS_FLOW_BASES",
    "GAS_STATES",
    "LIQUID_STATES",
    "STEAM_MOLAR_MASS",
    "WATER_ANTOINE",
    "WATER_CLAUSIUS_CLAPEYRON",
    "Fluid",
    "ValidityWarning",
    "ValveMechanismTransformer",
    "antoine",
    "area_from_kv",
    "at_travel",
    "cavitation_index",
    "choked_drop_ratio",
    "choked_pressure_drop",
    "clausius_clapeyron",
    "combined_drop_ratio_factor",
    "combined_recovery_factor",
    "critical_pressure_ratio_factor",
    "estimate_fl",
    "expansion_factor",
    "fit_antoine",
    "fit_clausius_clapeyron",
    "fitting_loss",
    "fluid_from",
    "gas_density",
    "gas_flow",
    "gas_inlet_pressure",
    "gas_kv",
    "gas_mass_flow",
    "gas_outlet_pressure",
    "gas_state",
    "gas_volume_flow",
    "incipient_xfz",
    "installed_characteristic",
    "juice_density",
    "juice_kinematic_viscosity",
    "juice_vapour_pressure",
    "liquid_flow",
    "liquid_inlet_pressure",
    "liquid_kv",
    "liquid_outlet_pressure",
    "liquid_state",
    "nonturbulent_flow_ratio",
    "nonturbulent_kv",
    "opening_for_capacity",
    "opening_for_flow",
    "opening_for_gas_flow",
    "opening_for_installed",
    "orifice_area",
    "orifice_flow",
    "piping_factor",
    "pressure_ratio_xf",
    "rate_liquid",
    "relative_capacity",
    "reynolds_factor",
    "specific_heat_ratio_factor",
    "steam_density",
    "steam_kinematic_viscosity",
    "trim_parameter",
    "valve_authority",
    "valve_reynolds_number",
    "vena_contracta_pressure",
    "water_density",
    "water_kinematic_viscosity",
    "water_saturation_temperature",
    "water_vapour_pressure",
]
