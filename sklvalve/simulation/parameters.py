# SPDX-License-Identifier: BSD-3-Clause
"""Parameters that a fit may move, and their way into the vector that an optimiser sees."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Parameter:
    """One number of the simulation that the data sheet leaves open, or that an effect brings.

    Parameters
    ----------
    name : str
        Key under which its value stands; an effect's parameter is ``effect.parameter``.
    unit : str
        SI unit, or ``"1"``.
    low, high : float
        What is physically possible; a fit stays inside.
    start : float
        Where a fit begins.
    spread : float or None
        Standard deviation of what is expected around `start` before any data; None where nothing is.
    log : bool
        Whether the optimiser moves its logarithm (rates, times, gains).
    """

    name: str
    unit: str
    low: float
    high: float
    start: float
    spread: float | None = None
    log: bool = False


class ParameterVector:
    """Parameters as one vector of numbers near one, with bounds and priors.

    Parameters
    ----------
    parameters : sequence of Parameter

    Examples
    --------
    >>> from sklvalve.simulation.parameters import Parameter, ParameterVector
    >>> vector = ParameterVector([Parameter("lag", "s", 0.05, 3.0, 0.5, log=True)])
    >>> vector.values(vector.pack({"lag": 2.0}))["lag"]
    2.0
    """

    def __init__(self, parameters):
        self.parameters = tuple(parameters)
        self.names = tuple(p.name for p in self.parameters)
        bounds = np.array([(p.low, p.high) for p in self.parameters], dtype=float).reshape(-1, 2)
        self._log = np.array([p.log for p in self.parameters], dtype=bool)
        bounds[self._log] = np.log(bounds[self._log])
        self.low, self.high = bounds[:, 0], bounds[:, 1]
        self.scale = np.array([self._scale(p) for p in self.parameters])
        self._begin = tuple((p.name, p.start) for p in self.parameters)
        self._known = [i for i, p in enumerate(self.parameters) if p.spread is not None]
        self._expected = self.pack({})[self._known]
        self._spread = np.array([self.parameters[i].spread for i in self._known])

    def __len__(self):
        return len(self.parameters)

    @staticmethod
    def _scale(parameter):
        if parameter.log:
            return 1.0
        if parameter.spread is not None:
            return parameter.spread
        width = parameter.high - parameter.low
        return width / 4.0 if np.isfinite(width) else max(abs(parameter.start), 1e-12)

    def pack(self, values):
        """Vector of a dict of values; a parameter that it lacks stands at its start."""
        raw = np.array([values.get(name, start) for name, start in self._begin], dtype=float)
        raw[self._log] = np.log(np.maximum(raw[self._log], 1e-300))
        return np.clip(raw, self.low, self.high)

    def values(self, vector):
        """Dict of the values that a vector stands for."""
        raw = np.array(vector, dtype=float)
        raw[self._log] = np.exp(raw[self._log])
        return dict(zip(self.names, raw.tolist(), strict=True))

    def prior_residuals(self, vector):
        """Distances from the starts in prior standard deviations, for the parameters that have a prior."""
        return (np.asarray(vector)[self._known] - self._expected) / self._spread
