# SPDX-License-Identifier: BSD-3-Clause
"""What may change between a valve's history and a later recording without anything being wrong."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sklvalve.simulation.parameters import Parameter


@dataclass(frozen=True)
class Allowance:
    """Standard deviations of what changes without a fault: season, supply, a sensor set to zero again.

    Parameters
    ----------
    capacity : float, default=0.002
        Capacity together with the meter's gain, relative [1].
    trim : float, default=0.001
        Capacity at each opening beside that at full travel, relative [1].
    recovery : float, default=0.005
        F_L, relative [1].
    response : float, default=0.05
        Time constants, speeds and gains of positioner, actuator and meter, relative [1].
    position_zero : float, default=0.0005
        Zero of the position sensor, and of the stem under it [1 = travel].
    flow_zero : float, default=0.001
        Zero of the flow meter, share of its span [1].
    pressure_zero : float, default=0.0005
        Zero of a pressure sensor, share of its span [1].
    """

    capacity: float = 0.002
    trim: float = 0.001
    recovery: float = 0.005
    response: float = 0.05
    position_zero: float = 0.0005
    flow_zero: float = 0.001
    pressure_zero: float = 0.0005

    def of(self, parameter: Parameter, spans: Mapping[str, float]) -> float:
        """Allowance of one parameter of a calibration, in the numbers that an optimiser moves.

        Parameters
        ----------
        parameter : Parameter
        spans : mapping of str to float
            Role -> span of it in the history [SI].

        Returns
        -------
        spread : float
            Standard deviation; of the logarithm where the parameter moves by that.
        """
        name = parameter.name
        known = {
            "position_zero": self.position_zero,
            "stem_zero": self.position_zero,
            "flow_zero": self.flow_zero * spans.get("flow", 1.0),
            "dp_zero": self.pressure_zero * spans.get("p1", 1.0),
            "fl_scale": self.recovery,
            "fl_slope": self.recovery,
            "capacity": self.capacity * parameter.start,
        }
        if name in known:
            return known[name]
        if name.startswith("trim_"):
            return self.trim
        if name.startswith("rise_"):
            return self.trim * max(parameter.spread or 0.0, parameter.start)
        # what else there is may change by a tenth of what the sheet leaves open
        return self.response if parameter.log else 0.1 * _reach(parameter)


def _reach(parameter: Parameter) -> float:
    if parameter.spread is not None:
        return parameter.spread
    width = parameter.high - parameter.low
    return 0.25 * width if np.isfinite(width) else max(abs(parameter.start), 1e-12)
