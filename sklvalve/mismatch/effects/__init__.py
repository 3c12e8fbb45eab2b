# SPDX-License-Identifier: BSD-3-Clause
"""The catalogue: one effect, one file, one line here."""

from sklvalve.mismatch.effects._late import Blocked, MeterFailed
from sklvalve.mismatch.effects.actuator_lag import ActuatorLag, RestrictedAir
from sklvalve.mismatch.effects.actuator_leak import ActuatorLeak, DiaphragmLeak
from sklvalve.mismatch.effects.backlash import Backlash, LinkageBacklash
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.mismatch.effects.bypass_open import BypassOpen
from sklvalve.mismatch.effects.capacity_error import CapacityError
from sklvalve.mismatch.effects.cavitation import Cavitation
from sklvalve.mismatch.effects.choked_flow import ChokedFlow
from sklvalve.mismatch.effects.clogging import Clogging, ClosingBlocked
from sklvalve.mismatch.effects.dead_time import DeadTime
from sklvalve.mismatch.effects.density_change import DensityChange, ThermalDensity
from sklvalve.mismatch.effects.erosion import Erosion
from sklvalve.mismatch.effects.external_leakage import ExternalLeakage, OutletLeakage
from sklvalve.mismatch.effects.flashing import Flashing
from sklvalve.mismatch.effects.flow_inertia import FlowInertia
from sklvalve.mismatch.effects.flow_meter_bias import FlowMeterBias
from sklvalve.mismatch.effects.flow_meter_drift import FlowMeterDrift, FlowMeterSpanDrift
from sklvalve.mismatch.effects.flow_meter_gain import FlowMeterGain
from sklvalve.mismatch.effects.friction import Friction, FrictionByHunting, FrictionBySlips
from sklvalve.mismatch.effects.gas_expansion import GasExpansion
from sklvalve.mismatch.effects.inlet_pressure_bias import InletPressureBias
from sklvalve.mismatch.effects.line_loss import LineLoss
from sklvalve.mismatch.effects.outlet_pressure_bias import OutletPressureBias
from sklvalve.mismatch.effects.piping_reducers import PipingReducers
from sklvalve.mismatch.effects.position_sensor_bias import PositionSensorBias, PositionSensorBiasInLoop
from sklvalve.mismatch.effects.position_sensor_gain import PositionSensorGain, PositionSensorGainInLoop
from sklvalve.mismatch.effects.positioner_characteriser import PositionerCharacteriser
from sklvalve.mismatch.effects.positioner_deadband import MotorDeadband, PositionerDeadband
from sklvalve.mismatch.effects.positioner_feedback_fault import (
    FeedbackByHunting,
    FeedbackPlay,
    PositionerFeedbackFault,
)
from sklvalve.mismatch.effects.presliding import Presliding
from sklvalve.mismatch.effects.rod_bend import RodBend, RodBendByHunting, RodBendShut
from sklvalve.mismatch.effects.seat_leakage import SeatLeakage
from sklvalve.mismatch.effects.sedimentation import Sedimentation
from sklvalve.mismatch.effects.sensor_lag import SensorLag
from sklvalve.mismatch.effects.slew_limit import MotorSpeed, SlewLimit
from sklvalve.mismatch.effects.spring_fault import SpringFault
from sklvalve.mismatch.effects.stem_load import StemLoad
from sklvalve.mismatch.effects.stiction import Stiction, StictionByHunting, StictionBySlips
from sklvalve.mismatch.effects.stuck_valve import StuckValve
from sklvalve.mismatch.effects.supply_pressure_drop import SupplyPressureDrop
from sklvalve.mismatch.effects.tight_shutoff import FullOpening, TightShutoff
from sklvalve.mismatch.effects.transducer_fault import TransducerFault, TransducerOutput
from sklvalve.mismatch.effects.two_phase import TwoPhase
from sklvalve.mismatch.effects.viscosity_change import ViscosityChange
from sklvalve.mismatch.effects.viscous_flow import ViscousFlow
from sklvalve.mismatch.effects.wrong_characteristic import WrongCharacteristic

#: Every form of every effect that a search takes up, as instances of `Effect`.
CATALOGUE = (
    Backlash(),
    LinkageBacklash(),
    Stiction(),
    Friction(),
    Presliding(),
    RodBend(),
    RodBendShut(),
    PositionerDeadband(),
    MotorDeadband(),
    SupplyPressureDrop(),
    ActuatorLeak(),
    DiaphragmLeak(),
    SpringFault(),
    StemLoad(),
    ActuatorLag(),
    RestrictedAir(),
    TransducerFault(),
    TransducerOutput(),
    PositionerFeedbackFault(),
    FeedbackPlay(),
    PositionerCharacteriser(),
    TightShutoff(),
    FullOpening(),
    StuckValve(),
    DeadTime(),
    SlewLimit(),
    MotorSpeed(),
    ChokedFlow(),
    Cavitation(),
    Flashing(),
    ViscousFlow(),
    ViscosityChange(),
    GasExpansion(),
    TwoPhase(),
    SeatLeakage(),
    BypassOpen(),
    ExternalLeakage(),
    OutletLeakage(),
    Clogging(),
    ClosingBlocked(),
    Sedimentation(),
    Erosion(),
    WrongCharacteristic(),
    PipingReducers(),
    LineLoss(),
    FlowInertia(),
    PositionSensorBias(),
    PositionSensorBiasInLoop(),
    PositionSensorGain(),
    PositionSensorGainInLoop(),
    InletPressureBias(),
    OutletPressureBias(),
    FlowMeterGain(),
    CapacityError(),
    DensityChange(),
    ThermalDensity(),
    FlowMeterBias(),
    FlowMeterDrift(),
    FlowMeterSpanDrift(),
    SensorLag(),
)

#: Forms told from events in the recording, which no search takes up.
EVENTS = (
    StictionBySlips(),
    FrictionBySlips(),
    StictionByHunting(),
    FrictionByHunting(),
    FeedbackByHunting(),
    RodBendByHunting(),
)

#: Forms that only an event at the end of a recording is told by, which no search takes up.
LATE = (Blocked(), MeterFailed())

__all__ = ["CATALOGUE", "EVENTS", "LATE", "Effect", "Quantity", "Shown"]
