# SPDX-License-Identifier: BSD-3-Clause
"""What may change between a valve's history and a later recording without anything being wrong."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sklvalve.history.moving import open_to, reach_of
from sklvalve.simulation.parameters import Parameter, ParameterVector


@dataclass(frozen=True)
class Allowance:
    """Standard deviations of what changes without a fault between a history and a later recording.

    Season, supply and a sensor that was set to zero again change a little. More changes because a simulation
    is no valve: the time constants that fit it best hang on the programme. What they make of the signals does
    not: driven alike, a sound valve's stem comes out as before. The defaults are the scatter between two
    recordings of an hour each of the same sound valve, on valves of two simulated plants (:doc:`/history`).

    Parameters
    ----------
    capacity : float, default=0.001
        Capacity together with the meter's gain, relative [1].
    trim : float, default=0.002
        Capacity at each opening beside that at full travel, relative [1].
    unseen_drop : float, default=0.02
        The same where no pressure drop is recorded, and pump and line change with the programme: share of
        what is left open before any data [1].
    recovery : float, default=0.003
        F_L, relative [1].
    response : float, default=0.001
        Time constants, speeds, gains and friction of positioner, actuator and meter, and the knee of choking:
        by how much (rms) they may move stem and flow, share of travel and of the flow's span [1]. What moved
        nothing in the history stays as open as the data sheet leaves it.
    position_zero : float, default=0.001
        Zero of the position sensor, and of the stem under it [1 = travel].
    play : float, default=0.0006
        Play of the linkage, and of the plug [1 = travel].
    flow_zero : float, default=0.001
        Zero of the flow meter, share of its span [1].
    pressure_zero : float, default=0.0015
        Zero of a pressure sensor, share of its span [1].
    """

    capacity: float = 0.001
    trim: float = 0.002
    unseen_drop: float = 0.02
    recovery: float = 0.003
    response: float = 0.001
    position_zero: float = 0.001
    play: float = 0.0006
    flow_zero: float = 0.001
    pressure_zero: float = 0.0015

    def covariance(
        self, parameters: Sequence[Parameter], spans: Mapping[str, float], moves: np.ndarray
    ) -> np.ndarray:
        r"""Covariance of what may change of a calibration.

        .. math:: A^{-1} = \operatorname{diag}(a_i^{-2}) + M_{rr} / r^2

        with :math:`a_i` the spread of each parameter, r the `response`, and M the mean products of what the
        parameters of the response move the signals by: together they move them by about r in each direction.

        Parameters
        ----------
        parameters : sequence of Parameter
        spans : mapping of str to float
            Role -> span of it in the history [SI].
        moves : ndarray of shape (m, m)
            Mean over the rows of a history of products of what the scaled parameters move the signals by.

        Returns
        -------
        covariance : ndarray of shape (m, m)
            In scaled parameters.
        """
        spread = [self._named(p, spans) for p in parameters]
        of_response = np.array([a is None for a in spread])
        allowed = [open_to(p) if a is None else a for a, p in zip(spread, parameters, strict=True)]
        precision = np.diag((ParameterVector(parameters).scale / np.array(allowed)) ** 2)
        precision += np.where(np.outer(of_response, of_response), moves / self.response**2, 0.0)
        covariance = np.linalg.inv(precision)
        return 0.5 * (covariance + covariance.T)

    def _named(self, parameter: Parameter, spans: Mapping[str, float]) -> float | None:
        """Allowance of one parameter in the numbers that an optimiser moves; None of one of the response."""
        name = parameter.name
        known = {
            "position_zero": self.position_zero,
            "stem_zero": self.position_zero,
            "link_play": self.play,
            "plug_play": self.play,
            "flow_zero": self.flow_zero * spans.get("flow", 1.0),
            "dp_zero": self.pressure_zero * spans.get("p1", 1.0),
            "fl_scale": self.recovery,
            "fl_slope": self.recovery,
            "capacity": self.capacity * parameter.start,
            "given_gain": self.capacity,
        }
        if name in known:
            return known[name]
        if name.startswith("trim_"):
            return self.trim
        if name.startswith("rise_"):
            return self.unseen_drop * max(parameter.spread or 0.0, parameter.start)
        if "." in name:
            # an effect that is known already is a fault or a property, and none that changes for no reason:
            # it gets no more than a capacity does. That keeps what it was sharp; in a later recording it is
            # calibrated without a prior (`ValveHistory.prior_of`), so that its own change is told as such
            # and is not taken for another effect.
            return self.capacity * (1.0 if parameter.log else reach_of(parameter))
        return None
