# SPDX-License-Identifier: BSD-3-Clause
"""A Gaussian process whose kernel is learnt from few rows, so that many can be afforded."""

import numpy as np
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, DotProduct, Matern, WhiteKernel


class GaussianProcess(RegressorMixin, BaseEstimator):
    """`GaussianProcessRegressor` with a length for every column, by marginal likelihood.

    Parameters
    ----------
    kernel : {"rbf", "matern", "rbf and linear", "matern and linear"}, default="rbf"
    learnt_from : int, default=100
        Rows from which the scales are learnt; the process itself takes all.
    """

    def __init__(self, kernel="rbf", learnt_from=100):
        self.kernel = kernel
        self.learnt_from = learnt_from

    def fit(self, X, y):
        """Learn the scales on rows spread evenly, then take all rows."""
        few = np.unique(np.linspace(0, len(X) - 1, self.learnt_from).round().astype(int))
        self.model_ = GaussianProcessRegressor(self._kernel(X.shape[1]), normalize_y=True)
        self.model_.fit(X[few], y[few])
        if len(few) < len(X):
            learnt = self.model_.kernel_
            self.model_ = GaussianProcessRegressor(learnt, optimizer=None, normalize_y=True).fit(X, y)
        return self

    def predict(self, X):
        """Mean."""
        return self.model_.predict(X)

    def _kernel(self, columns):
        lengths = {"length_scale": np.ones(columns), "length_scale_bounds": (1e-2, 1e4)}
        smooth = Matern(nu=2.5, **lengths) if self.kernel.startswith("matern") else RBF(**lengths)
        kernel = ConstantKernel(1.0, (1e-4, 1e6)) * smooth + WhiteKernel(1e-3, (1e-8, 1.0))
        if self.kernel.endswith("linear"):
            kernel += ConstantKernel(1.0, (1e-6, 1e4)) * DotProduct(1.0, (1e-3, 1e3))
        return kernel
