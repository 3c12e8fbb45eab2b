# SPDX-License-Identifier: BSD-3-Clause
"""Constants of the benchmark's actuators."""

from collections import namedtuple
from dataclasses import astuple, dataclass, fields, replace

import numpy as np

from sklvalve.damadics import march


@dataclass(frozen=True)
class Actuator:
    """A pneumatic actuator with its positioner and its valve; the defaults are those of the benchmark.

    Attributes
    ----------
    effective_area : float
        Of the diaphragm [m2].
    dead_volume : float
        Of the chamber where the valve is open [m3].
    gas_constant, air_temperature : float
        [J/(kg K)], [K].
    polytropic : float
        Exponent of the air [1].
    atmosphere : float
        [Pa].
    nozzle : float
        Coefficient of the pneumatic relay [kg/(s sqrt(Pa))].
    supply : float
        [Pa, gauge].
    most_air : float
        That the chamber is taken to hold [kg].
    least_supply : float
        Below which there counts as none [Pa, gauge].
    leak : float
        Coefficient of a leak of strength one [kg/(s sqrt(Pa))].
    mass : float
        Of what moves [kg].
    spring : float
        Stiffness of spring and diaphragm [N/m].
    preload : float
        Compression of the spring where the valve is open [m].
    viscous : float
        Viscous friction [N s/m].
    stroke : float
        [m].
    play : float
        Width of the hysteresis between diaphragm and stem, as a share of the stroke [1].
    stick_slip : bool
        Whether that hysteresis is dry friction instead of play: half its width times the spring's stiffness
        [N], *proposed*, against which the stem sticks and slips. Faults f4 and f8 then add friction.
    breakaway : float
        Friction of the stem at rest, as a multiple of that of the moving one [1]; above one it jumps.
    gain : float
        Of the positioner [1].
    hold : float
        Time between two samples of the positioner [s].
    setpoint_lag : float
        Of each of two lags of the set-point [s].
    kv : float
        Capacity of the open valve [m3/h at 1 bar].
    slope : float
        Exponent of the equal-percentage trim [1].
    plug : float
        Diameter of the plug [m].
    bypass_kv : float
        Capacity of the open bypass [m3/h at 1 bar].
    leakage_adds : bool
        Whether fault f6 adds to the relative capacity, as in the library, or multiplies it, as a formula of
        the help text has it.
    pressure_range : float
        Of the transmitters of P1 and P2 [Pa].
    flow_range : float
        Of the flow meter [t/h].
    """

    effective_area: float = 0.0290
    dead_volume: float = 0.0055
    gas_constant: float = 287.0
    air_temperature: float = 293.0
    polytropic: float = 1.0
    atmosphere: float = 101325.0
    nozzle: float = 2.5e-6
    most_air: float = 0.1
    supply: float = 6e5
    least_supply: float = 1.2e5
    leak: float = 2e-7
    mass: float = 2.0
    spring: float = 60892.0
    preload: float = 0.009525
    viscous: float = 1500.0
    stroke: float = 0.0381
    play: float = 0.01
    stick_slip: bool = False
    breakaway: float = 1.0
    gain: float = 100.0
    hold: float = 0.035
    setpoint_lag: float = 0.3
    kv: float = 120.0
    slope: float = 5.0
    plug: float = 0.05
    bypass_kv: float = 19.75
    leakage_adds: bool = True
    pressure_range: float = 4e6
    flow_range: float = 40.0

    def __post_init__(self):
        if not self.breakaway >= 1.0:
            raise ValueError(f"breakaway must be 1 or more, got {self.breakaway!r}.")

    def packed(self):
        """The same as numbers by name, for compiled code."""
        return Constants(*map(float, astuple(self)))

    def at_rest(self):
        """State in which the benchmark begins: open, without pressure, of shape (march.N_STATES,)."""
        state = np.zeros(march.N_STATES)
        state[march.PRESSURE] = self.atmosphere
        state[march.GAS_MASS] = (
            self.atmosphere * self.dead_volume / (self.gas_constant * self.air_temperature)
        )
        return state


#: The fields of an `Actuator`, all floats: what compiled code takes as `par`.
Constants = namedtuple("Constants", [field.name for field in fields(Actuator)])  # type: ignore[misc]


def preset(actuator):
    """Constants of one of the three actuators of the sugar factory.

    Parameters
    ----------
    actuator : {1, 2, 3}
        1 is LC51_03 (thin juice into the evaporator), 2 FC57_03 (thick juice out of it), 3 LC74_20 (feed
        water of the boiler), which the benchmark simulates.

    Returns
    -------
    actuator : Actuator
        For 1 and 2 no source has a tuned simulator: area, dead volume and relay are *proposed* in proportion
        to the diaphragm (1290 against 290 cm2), the spring for the same bench set of 20 to 100 kPa, capacity
        and plug by what is known of the valves. The ranges are those of the plant's transmitters.

    Examples
    --------
    >>> round(preset(1).spring * preset(1).stroke / preset(1).effective_area / 1e3)
    80
    """
    known = {
        1: {"kv": 550.0, "plug": 0.2, "flow_range": 400.0},
        2: {"kv": 110.0, "plug": 0.1, "flow_range": 80.0},
        3: {},
    }
    if actuator not in known:
        raise ValueError(f"actuator must be 1, 2 or 3, got {actuator!r}.")
    if actuator == 3:
        return Actuator()
    base, area = Actuator(), 0.129
    larger = area / base.effective_area
    return replace(
        base,
        effective_area=area,
        dead_volume=larger * base.dead_volume,
        most_air=larger * base.most_air,
        nozzle=larger * base.nozzle,
        spring=larger * base.spring,
        pressure_range=1e6,
        **known[actuator],
    )
