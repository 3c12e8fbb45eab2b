# SPDX-License-Identifier: BSD-3-Clause
"""Small mechanisms that stand for physics in the tests."""

import numpy as np
from sklearn.base import BaseEstimator


class Gain(BaseEstimator):
    """output = parameter * (2 + tanh(column / 10)), for any number of columns, as the check suite wants."""

    def __init__(self, column=0):
        self.column = column

    def _gain(self, X):
        values = X[self.column] if isinstance(self.column, str) else np.asarray(X)[:, self.column]
        return 2.0 + np.tanh(np.asarray(values, dtype=float) / 10)

    def forward(self, X, parameter):
        return parameter * self._gain(X)

    def invert(self, X, y):
        return y / self._gain(X)


class SensitiveGain(Gain):
    def sensitivity(self, X, parameter):
        return self._gain(X) + 0 * parameter


class Orifice(BaseEstimator):
    """flow = parameter * sqrt(p1 - p2) of named columns; knows nothing without a pressure drop."""

    def __init__(self, p1="p1", p2="p2"):
        self.p1 = p1
        self.p2 = p2

    def fit(self, X, y=None):
        X[[self.p1, self.p2]]
        return self

    def sensitivity(self, X, parameter):
        return np.sqrt(np.maximum(X[self.p1].to_numpy() - X[self.p2].to_numpy(), 0.0))

    def forward(self, X, parameter):
        return parameter * self.sensitivity(X, parameter)

    def invert(self, X, y):
        root = self.sensitivity(X, None)
        return np.where(root > 0, y / np.where(root > 0, root, 1.0), np.nan)


class Plain:
    """Neither an estimator nor fitted: forward and invert are enough."""

    def forward(self, X, parameter):
        return parameter + np.asarray(X)[:, 0]

    def invert(self, X, y):
        return y - np.asarray(X)[:, 0]
