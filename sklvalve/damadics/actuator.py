# SPDX-License-Identifier: BSD-3-Clause
"""Constants of the benchmark's actuators."""

from collections import namedtuple
from dataclasses import astuple, dataclass, fields, replace
from math import factorial

import numpy as np

from sklvalve.damadics import march
from sklvalve.damadics.checks import number

# constants that may be nothing, and those that are told by yes and no; all others are above nothing
_MAY_BE_ZERO = ("supply", "least_supply", "leak", "preload", "play", "slope", "plug", "bypass_kv")
_YES_OR_NO = ("stick_slip", "leakage_adds")


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
        Of each of two lags of the set-point [s]; one step, 0.0025 s, is next to none.
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

    Raises
    ------
    ValueError
        If a constant is no number that can be, or the stem would not be stable in steps of 0.0025 s.
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
        for name in (field.name for field in fields(self)):
            value = getattr(self, name)
            if name in _YES_OR_NO:
                if value not in (False, True):
                    raise ValueError(f"{name} must be True or False, got {value!r}.")
            else:
                number(name, value, 0.0, above=name not in _MAY_BE_ZERO)
        number("breakaway", self.breakaway, 1.0)
        number("setpoint_lag", self.setpoint_lag, march.STEP)
        # dry friction is taken in an implicit step, which is stable whatever the friction
        if not self.stick_slip and not _settles(self):
            raise ValueError(
                f"The stem must be stable in steps of {march.STEP} s, which it is not with "
                f"mass={self.mass!r}, spring={self.spring!r} and viscous={self.viscous!r}; the benchmark's "
                "viscous is 750 times its mass."
            )

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


def _settles(actuator):
    """Whether a free stem comes to rest: speed and position by Runge-Kutta, spring of the step before.

    Air and jet make the stem about as stiff again as its spring does.
    """
    rates = march.STEP * np.array([[-actuator.viscous / actuator.mass, 0.0], [1.0, 0.0]])
    powers = [np.linalg.matrix_power(rates, n) for n in range(5)]
    moves = sum(power / factorial(n) for n, power in enumerate(powers))
    pushes = march.STEP * sum(power / factorial(n + 1) for n, power in enumerate(powers[:4]))
    step = np.zeros((3, 3))
    step[:2, :2], step[2, 1] = moves, 1.0
    step[:2, 2] = pushes @ [-2.0 * actuator.spring / actuator.mass, 0.0]
    return np.isfinite(step).all() and np.abs(np.linalg.eigvals(step)).max() < 1.0


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
        For 1 and 2 no source has a tuned simulator: area, dead volume, relay and the leak of f9 and f10 are
        *proposed* in proportion to the diaphragm (1290 against 290 cm2), the spring for the same bench set of
        20 to 100 kPa, capacity and plug by what is known of the valves, the bypass in proportion to the
        capacity. The ranges are those of the plant's transmitters.

    Raises
    ------
    ValueError
        If there is no such actuator.

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
    if actuator not in tuple(known):
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
        leak=larger * base.leak,
        spring=larger * base.spring,
        bypass_kv=known[actuator]["kv"] / base.kv * base.bypass_kv,
        pressure_range=1e6,
        **known[actuator],
    )


def constants_of(actuator):
    """Constants of an `Actuator`, of one of the three by its number, or of the benchmark's own for None."""
    if isinstance(actuator, Actuator):
        return actuator
    return Actuator() if actuator is None else preset(actuator)
