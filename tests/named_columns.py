# SPDX-License-Identifier: BSD-3-Clause
"""Adapters that let scikit-learn's checks, which pass plain matrices, reach estimators of named signals.

`ValveSimulation` and `MissingPhysicsFinder` need signals by name and more rows than a check has. An adapter
is the class itself with one step before it: it validates the matrix as scikit-learn asks, and makes a
recording of it. The first column becomes the opening, which is also the command; y, where there is one, the
flow; both pressures are constant. All else is the class's own: parameters, copies, fitted state, what is
predicted.
"""

import numpy as np
from sklearn.utils.validation import check_is_fitted, validate_data

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.simulation import ValveSimulation

# as many rows as a diagnosis wants; those of a check are repeated until there are so many
_ROWS = 130


def signals_of(X, y=None, rows=1):
    """Signals by role, in SI, of a matrix; its rows repeated until there are `rows`."""
    times = -(-rows // len(X))
    opening = np.tile(0.5 + 0.45 * np.tanh(X[:, 0] / 10.0), times)
    signals = {"command": opening, "opening": opening, "p1": 0 * opening + 6e5, "p2": 0 * opening + 3e5}
    return signals if y is None else signals | {"flow": np.tile(y, times)}


class SimulationOfMatrix(ValveSimulation):
    """A simulation of a matrix."""

    def __sklearn_tags__(self):
        tags = super().__sklearn_tags__()
        # the flow of a check has nothing to do with a valve
        tags.regressor_tags.poor_score = True
        return tags

    def fit(self, X, y):
        X, y = validate_data(self, X, y, y_numeric=True, ensure_min_samples=2)
        return super().fit(signals_of(X, y.astype(float)))

    def predict(self, X):
        if isinstance(X, dict):
            return super().predict(X)
        check_is_fitted(self)
        return super().predict(signals_of(validate_data(self, X, reset=False)))

    def score(self, X, y, sample_weight=None):
        return super().score(signals_of(validate_data(self, X, reset=False)), y, sample_weight)


class FinderOfMatrix(MissingPhysicsFinder):
    """A finder of a matrix; it searches for no effect, so that a check takes a moment."""

    def fit(self, X, y):
        # repeated, one row would look like many
        X, y = validate_data(self, X, y, y_numeric=True, ensure_min_samples=2)
        return super().fit(signals_of(X, y.astype(float), _ROWS))

    def predict(self, X):
        check_is_fitted(self)
        return super().predict(signals_of(validate_data(self, X, reset=False)))
