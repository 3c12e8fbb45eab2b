# SPDX-License-Identifier: BSD-3-Clause
"""The LS-SVM that chooses C and gamma itself."""

from numbers import Integral
from typing import ClassVar

import numpy as np
from sklearn.base import BaseEstimator, MultiOutputMixin, RegressorMixin, _fit_context
from sklearn.model_selection import check_cv
from sklearn.utils._param_validation import Interval, StrOptions
from sklearn.utils.validation import _check_sample_weight, check_is_fitted, validate_data

from sklvalve._refits import whole_or_nothing
from sklvalve.lssvm.left_out import score_of
from sklvalve.lssvm.regressor import LSSVMRegressor
from sklvalve.lssvm.rows import middle_of, unit_of
from sklvalve.lssvm.search import Search

# parameters of the final fit that are no choice
_PASSED_ON = (
    "degree", "coef0", "kernel_params", "bias", "solver", "n_landmarks", "tol", "max_iter", "max_memory",
    "n_jobs", "random_state", "robust_passes", "uncertainty",
)  # fmt: skip


class LSSVMRegressorCV(MultiOutputMixin, RegressorMixin, BaseEstimator):
    r"""LS-SVM with C and gamma chosen by what it errs on rows left out, in closed form.

    One decomposition of the kernel matrix gives the errors on left-out rows for the whole path of C; so the
    search costs little more than a few fits.

    Parameters
    ----------
    kernel : {"rbf", "linear", "polynomial", "poly", "laplacian"} or callable, default="rbf"
    Cs : array-like of shape (n_Cs,), default=None
        Values of C to choose from; None is fifteen from 0.1 to 1e6.
    gammas : array-like of shape (n_gammas,), default=None
        Values of gamma to choose from; None is one over the number of columns times 1/16 to 16, for the
        kernels that have one.
    per_feature : bool, default=False
        From the best of `gammas` on, find one for each column, on at most 600 rows.
    cv : int, splitter of scikit-learn or iterable of (train, test), default=None
        None leaves out one row at a time. A number leaves out as many contiguous blocks of rows: for a time
        series, whose neighbouring rows say the same.
    gap : int, default=0
        Rows on either side of each row of a block that are left out with it and do not count.
    degree, coef0, kernel_params, bias, solver, n_landmarks, tol, max_iter, max_memory, n_jobs, random_state,
    robust_passes, uncertainty
        As in :class:`LSSVMRegressor`, of the final fit.

    Attributes
    ----------
    best_C_, best_gamma_ : float
        Chosen values; `best_gamma_` is an ndarray of shape (n_features,) with `per_feature`, and None for a
        kernel without gamma.
    best_score_ : float
        Root of the mean square of the errors on left-out rows, weighted, over all targets: smaller is better.
        There is no ``scoring``; for another score take `GridSearchCV` of scikit-learn.
    loo_residuals_ : ndarray of shape (n_samples,) or (n_samples, n_targets)
        Errors on the rows left out, target less prediction, with the chosen values; NaN where no block holds
        a row, and where its weight is zero.
    scores_ : ndarray of shape (n_gammas, n_Cs)
        Scores of all pairs, on at most 2,000 rows; NaN where C is too large for the kernel. The best five of
        C are compared again on all rows.
    estimator_ : LSSVMRegressor
        Fitted to all rows; its ``solver_``, ``gamma_``, ``residual_`` and ``n_iter_`` say how.
    dual_coef_, intercept_, X_fit_
        Of `estimator_`.
    n_features_in_ : int
    feature_names_in_ : ndarray of shape (`n_features_in_`,)

    See Also
    --------
    LSSVMRegressor : With C and gamma given.
    sklearn.linear_model.RidgeCV : The same for linear functions.

    References
    ----------
    .. [1] Cawley, G. C., N. L. C. Talbot, Neural Networks 17 (2004) 1467.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.lssvm import LSSVMRegressorCV
    >>> opening = np.linspace(0, 1, 41)[:, None]
    >>> kv = 50.0 ** (opening[:, 0] - 1) + 0.002 * np.cos(900 * opening[:, 0])
    >>> model = LSSVMRegressorCV().fit(opening, kv)
    >>> model.best_C_ > 10.0, model.loo_residuals_.shape
    (True, (41,))
    """

    _parameter_constraints: ClassVar[dict] = {
        "kernel": [StrOptions({"rbf", "linear", "polynomial", "poly", "laplacian"}), callable],
        "Cs": ["array-like", None],
        "gammas": ["array-like", None],
        "per_feature": ["boolean"],
        "cv": ["cv_object"],
        "gap": [Interval(Integral, 0, None, closed="left")],
        **{name: LSSVMRegressor._parameter_constraints[name] for name in _PASSED_ON},
    }

    def __init__(
        self,
        kernel="rbf",
        *,
        Cs=None,
        gammas=None,
        cv=None,
        per_feature=False,
        gap=0,
        degree=3,
        coef0=1,
        kernel_params=None,
        bias="free",
        solver="auto",
        n_landmarks=1000,
        tol=1e-6,
        max_iter=100,
        max_memory=None,
        n_jobs=None,
        random_state=None,
        robust_passes=0,
        uncertainty=False,
    ):
        self.kernel = kernel
        self.Cs = Cs
        self.gammas = gammas
        self.cv = cv
        self.per_feature = per_feature
        self.gap = gap
        self.degree = degree
        self.coef0 = coef0
        self.kernel_params = kernel_params
        self.bias = bias
        self.solver = solver
        self.n_landmarks = n_landmarks
        self.tol = tol
        self.max_iter = max_iter
        self.max_memory = max_memory
        self.n_jobs = n_jobs
        self.random_state = random_state
        self.robust_passes = robust_passes
        self.uncertainty = uncertainty

    @_fit_context(prefer_skip_nested_validation=True)
    @whole_or_nothing
    def fit(self, X, y, sample_weight=None):
        """Choose C and gamma, and fit to all rows.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
        y : array-like of shape (n_samples,) or (n_samples, n_targets)
        sample_weight : float or array-like of shape (n_samples,), default=None
            Non-negative; an error counts by its row's weight as well.

        Returns
        -------
        self : LSSVMRegressorCV

        Raises
        ------
        ValueError
            If the data are not finite numbers, too few to leave any out, or if no value of C is possible.
        """
        X, y = validate_data(
            self, X, y, dtype=np.float64, multi_output=True, y_numeric=True, ensure_min_samples=2
        )
        weight = np.ones(len(X)) if sample_weight is None else sample_weight
        weight = _check_sample_weight(weight, X, dtype=np.float64, ensure_non_negative=True)
        rows = weight > 0.0
        if rows.sum() < 2:
            raise ValueError(
                "Fewer than two rows have a positive weight; give at least two, to leave one out."
            )
        Cs, gammas = self._paths(X.shape[1])
        targets = y.astype(np.float64).reshape(len(y), -1)
        options = {name: getattr(self, name) for name in ("kernel", *_PASSED_ON)}
        centred = X[rows] - middle_of(X[rows], self.kernel, self.bias)
        unit = unit_of(targets[rows])
        search = Search(centred, targets[rows] / unit, weight[rows], self._blocks(X, y, rows), Cs, options)
        self.scores_ = search.grid(gammas)
        if not np.isfinite(self.scores_).any():
            raise ValueError(
                "No pair of C and gamma gives finite errors on left-out rows; scale X, or lower Cs."
            )
        i, j = np.unravel_index(np.nanargmin(self.scores_), self.scores_.shape)
        self.best_gamma_, C = gammas[i], float(Cs[j])
        if self.per_feature and self.best_gamma_ is not None and X.shape[1] > 1:
            self.best_gamma_, C = search.by_column(self.best_gamma_)
        errors = np.full(targets.shape, np.nan)
        errors[rows], self.best_C_ = search.errors(self.best_gamma_, C)
        errors *= unit
        self.scores_ *= unit
        known = np.isfinite(errors[:, 0])
        self.best_score_ = score_of(errors[known], weight[known])
        self.loo_residuals_ = errors[:, 0] if y.ndim == 1 else errors
        self.estimator_ = LSSVMRegressor(C=self.best_C_, gamma=self.best_gamma_, **options)
        self.estimator_.fit(X, y, sample_weight)
        self.n_iter_ = self.estimator_.n_iter_
        return self

    def predict(self, X, return_std=False):
        """Predict the target, as :meth:`LSSVMRegressor.predict`."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=np.float64, reset=False)
        return self.estimator_.predict(X, return_std=return_std)

    def predict_interval(self, X, coverage=0.95):
        """Intervals that hold a new target, as :meth:`LSSVMRegressor.predict_interval`."""
        check_is_fitted(self)
        X = validate_data(self, X, dtype=np.float64, reset=False)
        return self.estimator_.predict_interval(X, coverage)

    @property
    def dual_coef_(self):
        """Weights of the rows in `X_fit_`."""
        return self.estimator_.dual_coef_

    @property
    def intercept_(self):
        """Bias."""
        return self.estimator_.intercept_

    @property
    def X_fit_(self):
        """Rows that span the function."""
        return self.estimator_.X_fit_

    def _paths(self, n_features):
        Cs = _path("Cs", np.logspace(-1.0, 6.0, 15) if self.Cs is None else self.Cs)
        if callable(self.kernel) or self.kernel == "linear":
            return Cs, [None]
        gammas = 4.0 ** np.arange(-2, 3) / n_features if self.gammas is None else self.gammas
        return Cs, [float(g) for g in _path("gammas", gammas)]

    def _blocks(self, X, y, kept):
        """Rows of each block and those left out with them, by place among the kept; None for single rows."""
        if self.cv is None:
            return None
        place, n = np.cumsum(kept) - 1, len(X)
        blocks = []
        for train, test in check_cv(self.cv).split(X, y):
            out = np.ones(n, dtype=bool)
            out[train] = False
            for shift in range(1, self.gap + 1):
                out[np.maximum(np.asarray(test) - shift, 0)] = True
                out[np.minimum(np.asarray(test) + shift, n - 1)] = True
            rows = np.asarray(test)[kept[test]]
            blocks.append((place[rows], place[out & kept]))
        return [block for block in blocks if len(block[0])]


def _path(name, values):
    values = np.asarray(values, dtype=np.float64)
    if values.ndim != 1 or not len(values) or not (np.isfinite(values) & (values > 0.0)).all():
        raise ValueError(f"{name} must hold positive finite numbers in one row, got {values.tolist()}.")
    return values
