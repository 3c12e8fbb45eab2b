# SPDX-License-Identifier: BSD-3-Clause
"""How far a healthy valve may lie from its data sheet: within this, a deviation is calibration."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Tolerance:
    """What a data sheet leaves open; beyond it, or where it changes within a recording, physics is missing.

    Parameters
    ----------
    capacity : float, default=0.10
        Rated capacity together with the meter's gain, relative [1].
    trim : float, default=0.10
        Deviation of the trim's capacity, relative, times (1/phi)^0.2 as IEC 60534-2-4 has it [1].
    recovery : float, default=0.10
        F_L, relative [1].
    response : float, default=3.0
        Time constants of positioner and actuator, and of the meters [s].
    declared : float, default=0.25
        Stroke time, dead time and dead band where the sheet declares them, relative [1].
    static_error : float, default=0.01
        Width of the static error of positioner and friction together [1 = travel].
    play : float, default=0.01
        Play of the linkage, and of the plug; against a history none, for that has told it [1 = travel].
    position_zero : float, default=0.01
        Zero of the position sensor [1 = travel].
    flow_zero : float, default=0.005
        Zero of the flow meter, share of its span [1].
    pressure_zero : float, default=0.0025
        Zero of a pressure sensor, share of its span [1].
    flow_effect : float, default=0.005
        An effect counts from this change of flow on, rms where it acts, share of span [1].
    opening_effect : float, default=0.005
        An effect counts from this change of opening on, rms where it acts [1 = travel].
    """

    capacity: float = 0.10
    trim: float = 0.10
    recovery: float = 0.10
    response: float = 3.0
    declared: float = 0.25
    static_error: float = 0.01
    play: float = 0.01
    position_zero: float = 0.01
    flow_zero: float = 0.005
    pressure_zero: float = 0.0025
    flow_effect: float = 0.005
    opening_effect: float = 0.005

    def counts(self, channel: str) -> float:
        """Change of `"opening"` or `"flow"` from which on an effect counts, share of span [1]."""
        return self.opening_effect if channel == "opening" else self.flow_effect
