# SPDX-License-Identifier: BSD-3-Clause
"""The catalogue: one effect, one file, one line here."""

from sklvalve.mismatch.effects.backlash import Backlash, LinkageBacklash
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.mismatch.effects.bypass_open import BypassOpen
from sklvalve.mismatch.effects.capacity_error import CapacityError
from sklvalve.mismatch.effects.choked_flow import ChokedFlow
from sklvalve.mismatch.effects.clogging import Clogging
from sklvalve.mismatch.effects.dead_time import DeadTime
from sklvalve.mismatch.effects.flow_meter_bias import FlowMeterBias
from sklvalve.mismatch.effects.flow_meter_gain import FlowMeterGain
from sklvalve.mismatch.effects.inlet_pressure_bias import InletPressureBias
from sklvalve.mismatch.effects.outlet_pressure_bias import OutletPressureBias
from sklvalve.mismatch.effects.piping_reducers import PipingReducers
from sklvalve.mismatch.effects.position_sensor_bias import PositionSensorBias, PositionSensorBiasInLoop
from sklvalve.mismatch.effects.positioner_deadband import MotorDeadband, PositionerDeadband
from sklvalve.mismatch.effects.seat_leakage import SeatLeakage
from sklvalve.mismatch.effects.slew_limit import MotorSpeed, SlewLimit
from sklvalve.mismatch.effects.stiction import Stiction
from sklvalve.mismatch.effects.supply_pressure_drop import SupplyPressureDrop
from sklvalve.mismatch.effects.wrong_characteristic import WrongCharacteristic

CATALOGUE = (
    Backlash(),
    LinkageBacklash(),
    Stiction(),
    PositionerDeadband(),
    MotorDeadband(),
    SupplyPressureDrop(),
    DeadTime(),
    SlewLimit(),
    MotorSpeed(),
    ChokedFlow(),
    SeatLeakage(),
    BypassOpen(),
    Clogging(),
    WrongCharacteristic(),
    PipingReducers(),
    PositionSensorBias(),
    PositionSensorBiasInLoop(),
    InletPressureBias(),
    OutletPressureBias(),
    FlowMeterGain(),
    CapacityError(),
    FlowMeterBias(),
)

__all__ = ["CATALOGUE", "Effect", "Quantity"]
