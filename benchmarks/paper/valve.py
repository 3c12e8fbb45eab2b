# SPDX-License-Identifier: BSD-3-Clause
"""What an engineer knows of the valve before any data, as the mechanism of a hybrid; and that by itself.

The sheet says turbulent flow by IEC 60534-2-1 through an equal-percentage trim of rangeability 50, as most
sheets do. The simulated valve has an exponent of 5, which is a rangeability of 148, and closes down near its
seat; it chokes by tables of its own and has a density of its own. None of that is known here.
"""

import numpy as np
from sklearn.base import BaseEstimator, RegressorMixin, clone

from sklvalve.mechanism import ValveMechanismTransformer, relative_capacity, water_density

RANGEABILITY = 50.0
#: Of a medium whose temperature is not among the columns [K].
USUAL_TEMPERATURE = 333.15


def counted_by_mass(kelvin):
    """Density that makes volume flow [m3/s] of the mechanism mass flow [t/s]: q rho / 1000 by q(1e6/rho)."""
    return 1e6 / water_density(kelvin, warn=False)


class SheetValve(BaseEstimator):
    r"""Mass flow or outlet pressure by the sheet; what it leaves open is the capacity of the open valve.

    Parameters
    ----------
    columns : tuple of str
        What the columns of X are: ``opening`` [1], ``p1``, ``p2`` [Pa], ``temperature`` [K], ``flow`` [t/s].
    output : {"flow", "outlet_pressure"}, default="flow"

    Notes
    -----
    The unknown parameter P of the paper's equation 15 is the capacity :math:`K_{v,100}` in
    :math:`K_v = P R^{h-1}`: one number if the sheet's trim were right, a function of the opening h where it
    is not.
    """

    def __init__(self, columns, output="flow"):
        self.columns = columns
        self.output = output

    def fit(self, X, y=None):
        """Bind the columns; nothing is learnt."""
        places = {name: self.columns.index(name) for name in self.columns}
        known = "temperature" in places
        self.valve_ = ValveMechanismTransformer(
            **{"p2": None} | places,
            density=counted_by_mass if known else float(counted_by_mass(USUAL_TEMPERATURE)),
            output=self.output,
            warn=False,
        ).fit(X)
        return self

    def forward(self, X, parameter):
        """Flow [t/s] or outlet pressure [Pa] for capacities of the open valve [m3/h]."""
        return self.valve_.forward(X, parameter * self._trim(X))

    def invert(self, X, y):
        """Capacities of the open valve [m3/h] that give the flow [t/s] or the outlet pressure [Pa]."""
        return self.valve_.invert(X, y) / self._trim(X)

    def sensitivity(self, X, parameter):
        """Derivative of `forward` by the parameter."""
        return self.valve_.sensitivity(X, parameter * self._trim(X)) * self._trim(X)

    def _trim(self, X):
        opening = np.clip(X[:, self.columns.index("opening")], 0.0, 1.0)
        return relative_capacity(opening, "equal_percentage", rangeability=RANGEABILITY)


class MechanismAlone(RegressorMixin, BaseEstimator):
    """A mechanism with one parameter for all rows, the median of what they ask for."""

    def __init__(self, mechanism):
        self.mechanism = mechanism

    def fit(self, X, y):
        """Find the parameter."""
        self.mechanism_ = clone(self.mechanism, safe=False)
        if hasattr(self.mechanism_, "fit"):
            self.mechanism_.fit(X)
        self.parameter_ = float(np.nanmedian(self.mechanism_.invert(X, y)))
        return self

    def predict(self, X):
        """Output of the mechanism."""
        return self.mechanism_.forward(X, np.full(len(X), self.parameter_))
