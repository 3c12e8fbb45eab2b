# SPDX-License-Identifier: BSD-3-Clause
"""Capacity over opening as a table: the sheet's curve within its tolerance, or a curve learnt from data."""

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import nnls

from sklvalve.mechanism import relative_capacity
from sklvalve.simulation.parameters import Parameter

GRID = np.linspace(0.0, 1.0, 401)


# few, for a trim is smooth
_KNOTS = (0.02, 0.15, 0.29, 0.43, 0.57, 0.71, 0.86, 1.0)


class Deviation:
    """How far the trim of one valve lies from that of its type, within the tolerance of IEC 60534-2-4.

    Parameters
    ----------
    nominal : ndarray of shape (401,)
        Relative capacity over `GRID` [1].
    tolerance : Tolerance
    knots : sequence of float
        Openings between which the deviation is a natural cubic spline. At the last, full travel, there is
        none: what deviates there is the rated capacity.

    Attributes
    ----------
    parameters : tuple of Parameter
        Logarithm of the deviation at each knot but the last.
    """

    def __init__(self, nominal, tolerance, knots=_KNOTS):
        spline = CubicSpline(knots, np.eye(len(knots)), bc_type="natural")
        self._shapes = spline(np.clip(GRID, knots[0], knots[-1]))[:, :-1]
        phi = np.maximum(np.interp(knots[:-1], GRID, nominal), 1e-3)
        reach = tolerance.trim * phi**-0.2
        self.parameters = tuple(
            Parameter(f"trim_{i}", "1", -r, r, 0.0, spread=0.5 * r) for i, r in enumerate(reach)
        )

    def factor(self, values):
        """Capacity over `GRID`, of that of the type, for the values of the parameters [1]."""
        return np.exp(self._shapes @ np.array([values[p.name] for p in self.parameters]))


class SheetTrim:
    """The data sheet's characteristic, bent smoothly within the tolerance of IEC 60534-2-4.

    Parameters
    ----------
    valve : Valve
        Its characteristic, rangeability, shutoff and rated kv.
    tolerance : Tolerance
    kv_scale : float, default=None
        Order of the largest capacity, where the sheet has no rated one [m3/h].
    knots : sequence of float
        Of the `Deviation`.
    """

    known = True

    def __init__(self, valve, tolerance, kv_scale=None, knots=_KNOTS):
        self.nominal = relative_capacity(
            GRID,
            valve.characteristic,
            rangeability=valve.rangeability,
            shutoff=valve.shutoff or 0.0,
            warn=False,
        )
        self._deviation = Deviation(self.nominal, tolerance, knots)
        self.parameters = self._deviation.parameters
        self.rated = valve.kv_rated if kv_scale is None else kv_scale
        if valve.kv_rated is None:
            self.capacity = Parameter("capacity", "m3/h", 1e-6, 1e6, self.rated, log=True)
        else:
            low, high = self.rated * (1.0 - tolerance.capacity), self.rated * (1.0 + tolerance.capacity)
            self.capacity = Parameter(
                "capacity", "m3/h", low, high, self.rated, spread=0.5 * tolerance.capacity * self.rated
            )

    def table(self, values):
        """kv [m3/h] on `GRID` for the values of the parameters."""
        return values["capacity"] * self.nominal * self._deviation.factor(values)

    def all_parameters(self):
        """Capacity and the deviations of the trim."""
        return (self.capacity, *self.parameters)


class LearntTrim:
    """A characteristic that no sheet gives: a monotone curve through knots, its rises the parameters.

    Parameters
    ----------
    opening : ndarray of shape (n,)
        Openings that the recording visits [1]; the knots stand at their quantiles.
    kv_scale : float
        Order of the largest capacity [m3/h].
    n_knots : int, default=24
    knots : sequence of float, default=None
        Openings of the knots themselves.
    """

    known = False

    def __init__(self, opening, kv_scale, n_knots=24, knots=None):
        if knots is None:
            seen = opening[np.isfinite(opening)]
            span = np.linspace(seen.min(), seen.max(), n_knots)
            mixed = 0.5 * (span + np.quantile(seen, np.linspace(0.0, 1.0, n_knots)))
            # capacity may rise anywhere between shut and open, also where the recording has not been
            knots = np.unique(np.concatenate([[0.0], mixed.round(4), [1.0]]).clip(0.0, 1.0))
        self.knots = np.asarray(knots, dtype=float)
        rise = kv_scale / len(self.knots)
        self.rated = kv_scale
        self.parameters = tuple(
            # a rise between knots without data is drawn, weakly, to an even one
            Parameter(f"rise_{i}", "m3/h", 0.0, 20.0 * kv_scale, 0.0 if i == 0 else rise, spread=10.0 * rise)
            for i in range(len(self.knots))
        )

    def table(self, values):
        """kv [m3/h] on `GRID` for the values of the parameters; linear in them, so that fits converge."""
        heights = np.cumsum([values[p.name] for p in self.parameters])
        return np.interp(GRID, self.knots, heights)

    def first_values(self, opening, kv):
        """Values that come near capacities `kv` [m3/h] seen at openings, for fits to begin with."""
        seen = np.isfinite(opening) & np.isfinite(kv)
        shares = np.column_stack(
            [np.interp(opening[seen], self.knots, row) for row in np.tri(len(self.knots)).T]
        )
        weak = 1e-3 * np.sqrt(seen.sum()) * np.eye(len(self.knots))
        rises, _ = nnls(np.vstack([shares, weak]), np.concatenate([kv[seen], np.zeros(len(weak))]))
        return {p.name: float(rise) for p, rise in zip(self.parameters, rises, strict=True)}

    def all_parameters(self):
        """The rises from knot to knot."""
        return self.parameters
