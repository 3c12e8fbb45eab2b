# SPDX-License-Identifier: BSD-3-Clause
"""What a flow simulated by the user says of the trim."""

import numpy as np
from sklearn.isotonic import IsotonicRegression

from sklvalve.simulation.tolerance import Tolerance
from sklvalve.simulation.trim import GRID, Deviation

# the share of the capacity's variance that the opening alone must explain
_FOLLOWS = 0.98
_SHUT = 1e-6


class NoOpening(Exception):
    """An effect asks for the capacity at an opening, and nothing tells it."""


class GivenTrim:
    """Capacity over opening as a given simulation has it, where it follows the opening at all.

    Parameters
    ----------
    rated : float
        Order of the largest capacity [m3/h].
    curve : array-like of shape (401,), default=None
        Capacity [m3/h] over the grid of openings; None where the simulated flow does not follow an opening.
    tolerance : Tolerance, default=None
        How far the valve's own trim may lie from the simulated one.
    """

    known = True

    def __init__(self, rated, curve=None, tolerance=None):
        self.rated = float(rated)
        self.curve = None if curve is None else np.asarray(curve, dtype=float)
        if self.curve is not None:
            nominal = self.curve / max(float(np.max(self.curve)), _SHUT)
            self._deviation = Deviation(nominal, tolerance or Tolerance())

    @classmethod
    def of(cls, kv, recording, valve, tolerance=None):
        """Trim that the capacity behind a simulated flow shows [m3/h], NaN where no drop drives it."""
        known = kv[np.isfinite(kv)]
        largest = float(np.quantile(np.abs(known), 0.99)) if len(known) else 1.0
        return cls(valve.kv_rated or max(largest, _SHUT), _curve(recording.get("opening"), kv), tolerance)

    @property
    def nominal(self):
        """Relative capacity over the grid of openings [1]."""
        return self.at(GRID) / self.rated

    def at(self, opening):
        """Capacity at an opening [m3/h]."""
        if self.curve is None:
            raise NoOpening
        return np.interp(opening, GRID, self.curve)

    def all_parameters(self):
        """Deviations of the trim; none where the simulated flow does not follow the opening."""
        return () if self.curve is None else self._deviation.parameters

    def factor(self, opening, values):
        """Capacity at an opening, of that simulated, as the deviations have it [1]."""
        if self.curve is None or "trim_0" not in values:
            return 1.0
        return np.interp(opening, GRID, self._deviation.factor(values))


def _curve(opening, kv):
    if opening is None:
        return None
    both = np.isfinite(opening) & np.isfinite(kv)
    if both.sum() < 20 or np.var(kv[both]) <= 0.0:
        return None
    fitted = IsotonicRegression(out_of_bounds="clip").fit(opening[both], kv[both])
    left = kv[both] - fitted.predict(opening[both])
    if 1.0 - np.var(left) / np.var(kv[both]) < _FOLLOWS:
        return None
    # a monotone fit is made of steps: over a twentieth of travel it has slopes again
    width = len(GRID) // 20
    stepped = np.pad(fitted.predict(GRID), width, mode="edge")
    kernel = np.hanning(2 * width + 3)[1:-1]
    return np.convolve(stepped, kernel / kernel.sum(), mode="valid")
