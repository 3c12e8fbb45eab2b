# SPDX-License-Identifier: BSD-3-Clause
"""Example IV of the benchmark: the valve fills a tank whose level a proportional controller holds."""

from collections import namedtuple
from dataclasses import astuple, dataclass, fields

import numpy as np
from numba import njit

from sklvalve.damadics.checks import number
from sklvalve.damadics.excitation import LIMITS
from sklvalve.damadics.flow import clip, mass_flow
from sklvalve.damadics.march import OUTPUT, STEP, advance, medium, record, strengths

# places in the array of what the tank and its controller carry from step to step
_LEVEL, _ERROR, _FLOW = range(3)


@dataclass(frozen=True)
class LevelLoop:
    """A pump, the valve, a tank with a hole in its bottom, and a controller of its level.

    Water falls from the pump's pressure by the flow, passes the valve, and rises to the tank:

    .. math:: p_1 = p_{pump} - r_1 F, \\quad p_2 = p_{back} + c (z + h) + r_2 F, \\quad
        A \\dot h = F / 3600 - a \\sqrt{2 g h},

    with the flow F [t/h] of the step before. A full command closes the valve, so that the controller acts
    directly: command = gain (h / span - setpoint), the error behind a first-order lag.

    Attributes
    ----------
    setpoint : float
        Of the level, as a share of the span [1].
    gain : float
        Of the controller [1].
    lag : float
        Of the controller's error [s]; one step, 0.0025 s, is next to none.
    span : float
        Of the level transmitter, and depth of the tank [m].
    level : float
        At the beginning [m].
    pump, back : float
        Pressure of the pump, and behind the valve but for the column of water [Pa].
    inlet_loss, outlet_loss : float
        Losses of the lines before and behind the valve [Pa/(t/h)].
    column, height : float
        Weight of the column of water [Pa/m], and height of the tank's bottom [m].
    area, hole : float
        Of the tank and of its hole [m2].
    celsius : float
        [degC]; no source gives it, 20 is that of example I.

    Raises
    ------
    ValueError
        If a number is none that can be.
    """

    setpoint: float = 0.5
    gain: float = 100.0
    lag: float = 0.5
    span: float = 2.0
    level: float = 0.9
    pump: float = 3.5e6
    back: float = 2.2e6
    inlet_loss: float = 1000.0
    outlet_loss: float = 100.0
    column: float = 1e4
    height: float = 5.0
    area: float = 20.0
    hole: float = 0.0013
    celsius: float = 20.0

    def __post_init__(self):
        for name in ("gain", "span", "pump", "area"):
            number(name, getattr(self, name), 0.0, above=True)
        for name in ("back", "inlet_loss", "outlet_loss", "column", "height", "hole"):
            number(name, getattr(self, name), 0.0)
        number("setpoint", self.setpoint, 0.0, 1.0)
        number("lag", self.lag, STEP)
        number("level", self.level, 0.0, self.span)
        number("celsius", self.celsius, *LIMITS["T1"])

    def require_fit(self, actuator):
        """ValueError where the pump's pressure lies beyond the transmitters of an `Actuator`."""
        if self.pump > actuator.pressure_range:
            raise ValueError(
                f"The pump of the loop gives {1e-6 * self.pump:g} MPa and the actuator's transmitters end at "
                f"{1e-6 * actuator.pressure_range:g} MPa; take actuator 3, to which the benchmark's loop "
                "belongs, or a LevelLoop with pressures of this one's."
            )

    def packed(self):
        """The same as numbers by name, for compiled code."""
        return LoopConstants(*map(float, astuple(self)))

    def at_rest(self):
        """Level [m], lagged error [1] and flow of the step before [t/h] in the beginning."""
        return np.array([self.level, 0.0, 0.0])


#: The fields of a `LevelLoop`, all floats.
LoopConstants = namedtuple("LoopConstants", [field.name for field in fields(LevelLoop)])  # type: ignore[misc]


@njit(cache=True, nogil=True)
def march_loop(first, noise, of_level, state, tank, loop, supply, par, profiles, every, out):
    """Go on from a state through some steps, the valve within its loop.

    Parameters
    ----------
    first : int
        Number of the first step since the beginning.
    noise, of_level : ndarray of shape (n,)
        Of the command within the positioner [1], and of the measured level [1].
    state : ndarray of shape (N_STATES,)
        Of the actuator; changed.
    tank : ndarray of shape (3,)
        What `LevelLoop.at_rest` gives; changed.
    loop : LoopConstants
    supply : float
        [Pa, gauge].
    par, profiles, every
        As `march.march` has them.
    out : ndarray of shape (rows or more, 12 + n_faults)
        Filled with what `march.COLUMNS` says, the level [m] and the measured level [1].
    """
    f, rows = np.zeros(20), 0
    follows = 1.0 - np.exp(-STEP / loop.lag)
    for i in range(len(noise)):
        step, level, before = first + i, tank[_LEVEL], tank[_FLOW]
        if len(profiles) > 0:
            strengths(step * STEP, profiles, f)
        measured = clip(level / loop.span + of_level[i], 0.0, 1.0)
        command = clip(loop.gain * tank[_ERROR], 0.0, 1.0)
        p1 = loop.pump - loop.inlet_loss * before
        p2 = loop.back + loop.column * (loop.height + level) + loop.outlet_loss * before
        p1, p2, celsius = medium(p1, p2, loop.celsius, f)
        now = advance(step, command + noise[i], p1, p2, celsius, supply, f, state, par)
        flow = mass_flow(now[1], p1, p2, celsius, f, par)
        if step % every == 0:
            record(out[rows], now, flow, state[OUTPUT], (command, p1, p2, celsius, supply), f, profiles)
            out[rows, -2], out[rows, -1] = level, measured
            rows += 1
        tank[_ERROR] += follows * (measured - loop.setpoint - tank[_ERROR])
        rises = (flow / 3600.0 - loop.hole * np.sqrt(2.0 * 9.81 * level)) / loop.area
        tank[_LEVEL] = clip(level + STEP * rises, 0.0, loop.span)
        tank[_FLOW] = flow
