# SPDX-License-Identifier: BSD-3-Clause
"""Parameters that a fit may move, and their way into the vector that an optimiser sees."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

# a distance from a joint prior is counted in so many equal parts
_PARTS = 16


@dataclass(frozen=True, eq=False)
class JointPrior:
    """What is expected of several parameters together before a recording is seen: a Gaussian.

    Parameters
    ----------
    names : tuple of str
    mean : ndarray of shape (m,)
        In the numbers that an optimiser moves: of rates, times and gains the logarithm.
    covariance : ndarray of shape (m, m)
    """

    names: tuple[str, ...]
    mean: np.ndarray
    covariance: np.ndarray

    @cached_property
    def _at(self):
        return {name: i for i, name in enumerate(self.names)}

    def of(self, names):
        """Mean of some parameters, and the root of the inverse of their covariance, the others unknown.

        Parameters
        ----------
        names : sequence of str

        Returns
        -------
        mean : ndarray of shape (k,)
        root : ndarray of shape (k, k)
            ``root @ (z - mean)`` has unit variance.
        """
        at = [self._at[name] for name in names]
        covariance = self.covariance[np.ix_(at, at)]
        size = np.sqrt(np.diag(covariance))
        lower = np.linalg.cholesky(covariance / np.outer(size, size))
        return self.mean[at], np.linalg.solve(lower, np.diag(1.0 / size))


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
    joint : JointPrior or None
        What is expected of it together with others; it goes before `spread`, which then only scales.
    """

    name: str
    unit: str
    low: float
    high: float
    start: float
    spread: float | None = None
    log: bool = False
    joint: JointPrior | None = None


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
        alone = [i for i, p in enumerate(self.parameters) if p.spread is not None and p.joint is None]
        self._known, self._expected = alone, self.pack({})[alone]
        self._spread = np.array([self.parameters[i].spread for i in alone])
        self._jointly = self._joint_priors()

    def __len__(self):
        return len(self.parameters)

    def _joint_priors(self):
        """Of every joint prior where its parameters stand, their mean, and the root that whitens them."""
        members = {}
        for i, p in enumerate(self.parameters):
            if p.joint is not None:
                members.setdefault(id(p.joint), (p.joint, []))[1].append(i)
        return [(at, *joint.of([self.names[i] for i in at])) for joint, at in members.values()]

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

    def scattered(self, many, random, spreads):
        """Vectors from all over what the parameters may be [many, n].

        Parameters
        ----------
        many : int
        random : numpy.random.Generator
        spreads : float
            How far from what is expected beforehand they lie at most, in its standard deviations. What is
            expected of several parameters together they are drawn from.

        Returns
        -------
        vectors : ndarray of shape (many, n)
        """
        expected = self.pack({})
        reach = np.array([np.inf if p.spread is None else spreads * p.spread for p in self.parameters])
        low, high = np.maximum(self.low, expected - reach), np.minimum(self.high, expected + reach)
        vectors = random.uniform(low, high, (many, len(self)))
        for at, mean, root in self._jointly:
            drawn = random.standard_normal((many, len(at)))
            vectors[:, at] = np.clip(mean + np.linalg.solve(root, drawn.T).T, self.low[at], self.high[at])
        return vectors

    def prior_residuals(self, vector):
        """Distances from what is expected in prior standard deviations, for parameters that have a prior."""
        vector = np.asarray(vector)
        alone = (vector[self._known] - self._expected) / self._spread
        # in parts, so that the robust cost of errors, linear beyond three, is a Gaussian's up to twelve
        jointly = [
            np.tile(root @ (vector[at] - mean) / np.sqrt(_PARTS), _PARTS) for at, mean, root in self._jointly
        ]
        return np.concatenate([alone, *jointly])
