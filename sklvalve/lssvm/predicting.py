# SPDX-License-Identifier: BSD-3-Clause
"""What a fitted LS-SVM tells: predictions, their spread, and the same function of fewer rows."""

import numpy as np
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.utils.validation import check_is_fitted, validate_data

from sklvalve.lssvm import device
from sklvalve.lssvm.kernels import WITH_GAMMA, gamma_and_scale, kernel_between
from sklvalve.lssvm.products import KernelBlocks, product, raise_of_overflow
from sklvalve.lssvm.rows import Coordinates
from sklvalve.lssvm.spread import quantile, root_v
from sklvalve.lssvm.threads import in_this_thread, own_threads

# kernel values of a prediction from which on threads of one's own are worth their beginning
_MANY = 2**22
# and up to which one block is all there is
_FEW = 2**17


class Predicting:
    """Methods of a fitted :class:`~sklvalve.lssvm.LSSVMRegressor` that change nothing of it."""

    def predict(self, X, return_std=False):
        r"""Predict the target.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            Rows, or their kernel values against the rows of the fit, of shape (n_samples, n_fit).
        return_std : bool, default=False
            Tell the standard deviation too; the model must be fitted with `uncertainty`.

        Returns
        -------
        y : ndarray of shape (n_samples,) or (n_samples, n_targets)
            Predictions. Memory beyond them and X is bounded, whatever the number of rows.
        std : ndarray of the same shape
            Standard deviation of a new target of weight one about its prediction, noise included, as the
            gaussian process has it whose mean the LS-SVM is; its noise is set by the errors on left-out rows.

        Raises
        ------
        ValueError
            If X has other columns than in `fit`, or is not finite, if a prediction overflows, or if the
            spread is not known.
        """
        check_is_fitted(self, "dual_coef_")
        if device.is_elsewhere(X) or device.is_elsewhere(self.dual_coef_):
            if return_std:
                raise ValueError("return_std needs rows in numpy arrays; X is on a device.")
            return device.predicted(self, X)
        X = validate_data(self, X, dtype=(np.float64, np.float32), reset=False)
        if self._kernel_["kernel"] == "precomputed":
            with np.errstate(over="ignore", invalid="ignore"):
                found = np.asarray(X, dtype=np.float64) @ self._alpha() + self.intercept_
            return self._as_targets(_finite(found))
        Z = self._coordinates()(X)
        found = self._as_targets(_finite(self._function(Z)))
        if not return_std:
            return found
        return found, self._as_targets(self._root_v(Z) * self._spread_["sigma"])

    @property
    def gamma_(self):
        """The gamma of the fit, as a number; None of a kernel that has none."""
        if self._kernel_["kernel"] not in WITH_GAMMA:
            return None
        gamma = self._kernel_["gamma"]
        return 1.0 / self.n_features_in_ if gamma is None else gamma

    def predict_interval(self, X, coverage=0.95):
        """Intervals that hold a new target as often as asked.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
        coverage : float, default=0.95
            In (0, 1).

        Returns
        -------
        low, high : ndarray of shape (n_samples,) or (n_samples, n_targets)
            Infinite where there were too few rows for such a coverage.

        Raises
        ------
        ValueError
            If the model was not fitted with `uncertainty`, or the coverage is no share.

        Notes
        -----
        Conformal: the quantile of the errors on rows left out, each over its own standard deviation, times
        the standard deviation here. That holds where new rows are like those of the fit and independent. In
        a time series neighbouring rows say the same: leaving out one of them tells too little, and the
        intervals are too narrow.

        References
        ----------
        .. [1] Barber et al., Predictive inference with the jackknife+, Annals of Statistics 49 (2021).
        .. [2] Vovk, V., A. Gammerman, G. Shafer, Algorithmic learning in a random world, Springer, 2005.
        """
        if not 0.0 < coverage < 1.0:
            raise ValueError(f"coverage must lie between 0 and 1, got {coverage!r}.")
        check_is_fitted(self)
        X = validate_data(self, X, dtype=(np.float64, np.float32), reset=False)
        Z = self._coordinates()(X)
        middle, wide = _finite(self._function(Z)), self._root_v(Z) * quantile(self._spread_, coverage)
        return self._as_targets(middle - wide), self._as_targets(middle + wide)

    def pruned(self, n_landmarks):
        """The same function, nearly, of fewer rows: quicker, and smaller in a file.

        Parameters
        ----------
        n_landmarks : int
            Rows that are kept, chosen among those of the fit.

        Returns
        -------
        pruned : LSSVMRegressor
            A fitted one, that is as near as such a function can be to this one's predictions of the rows of
            the fit. As these are without noise, it is fitted to them with a thousand times the C.
        """
        check_is_fitted(self)
        if not isinstance(self.X_fit_, np.ndarray):
            raise ValueError(
                "There are no rows to choose from: the kernel is precomputed, or the rows lie elsewhere than "
                "in numpy arrays."
            )
        more = {"solver": "nystrom", "uncertainty": False, "robust_passes": 0}
        more |= self._kernel_ | {"C": min(1e3 * self._kernel_["C"], 1e300)}
        fewer = clone(self).set_params(n_landmarks=int(n_landmarks), **more)
        Z = self._coordinates()(self.X_fit_)
        fewer.fit(self.X_fit_, self._as_targets(self._function(Z))).set_params(
            C=self._kernel_["C"], gamma=self.gamma
        )
        for name in ("n_features_in_", "feature_names_in_"):
            if hasattr(self, name):
                setattr(fewer, name, getattr(self, name))
        return fewer

    def _function(self, Z):
        """The fitted function of rows in the coordinates of the kernel, of shape (n, n_targets)."""
        # what overflows is seen in the result
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self._values(Z)

    def _values(self, Z):
        alpha = self._alpha()
        if self._kernel_["kernel"] == "linear":
            # the slope first: so no digits are lost in products of rows, and few are needed
            return Z @ (self._right_.T @ alpha) + (self.intercept_ + self._of_offset(alpha))
        blocks, shape = KernelBlocks(self._between(), Z, None, self._right_), (len(Z), len(alpha))
        if len(Z) * len(alpha) < _FEW:
            return blocks(slice(None), slice(None)) @ alpha + self.intercept_
        if len(Z) * len(alpha) < _MANY:
            return product(in_this_thread, blocks, shape, alpha) + self.intercept_
        with own_threads(self.n_jobs) as run:
            return product(run, blocks, shape, alpha) + self.intercept_

    def _alpha(self):
        return self.dual_coef_.reshape(len(self.dual_coef_), -1)

    def _as_targets(self, values):
        return values[:, 0] if self.dual_coef_.ndim == 1 else values

    def _root_v(self, Z):
        if getattr(self, "_spread_", None) is None:
            raise NotFittedError(
                "Standard deviations and intervals are not known: fit with uncertainty=True."
            )
        fitted = {name: self._kernel_[name] for name in ("C", "bias")}
        return root_v(self._spread_, self._between(), Z, **fitted)[:, None]

    def _coordinates(self):
        return Coordinates(self.offset_, self._gamma_and_scale()[1])

    def _between(self):
        more = {name: self._kernel_[name] for name in ("degree", "coef0", "kernel_params")}
        return kernel_between(self._kernel_["kernel"], gamma=self._gamma_and_scale()[0], **more)

    def _gamma_and_scale(self):
        return gamma_and_scale(self._kernel_["kernel"], self._kernel_["gamma"], self.n_features_in_)

    def _of_offset(self, alpha):
        """What `offset_` takes off the value of the linear kernel; others do not see it."""
        if self._kernel_["kernel"] != "linear":
            return 0.0
        return self.offset_ @ (self._right_.T @ alpha)


def _finite(values):
    lost = ~np.isfinite(values).all(axis=1)
    if lost.any():
        raise_of_overflow(np.count_nonzero(lost))
    return values
