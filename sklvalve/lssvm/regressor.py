# SPDX-License-Identifier: BSD-3-Clause
"""The LS-SVM as a scikit-learn regressor."""

from numbers import Integral, Real
from typing import ClassVar

import numpy as np
from sklearn.base import BaseEstimator, MultiOutputMixin, RegressorMixin, _fit_context
from sklearn.utils import check_random_state
from sklearn.utils._param_validation import Interval, StrOptions
from sklearn.utils.validation import check_is_fitted, validate_data

from sklvalve.lssvm.choice import SOLVERS, Machine, memory_to_use, ridge_of
from sklvalve.lssvm.kernels import SHIFT_INVARIANT, kernel_between, kernel_length, kernel_product
from sklvalve.lssvm.products import KernelBlocks
from sklvalve.lssvm.products import product as product_of
from sklvalve.lssvm.threads import own_threads

# kernel values of a prediction from which on threads of one's own are worth their beginning
_MANY = 2**22


class LSSVMRegressor(MultiOutputMixin, RegressorMixin, BaseEstimator):
    r"""Least-squares support vector machine for regression.

    Fits :math:`f(x) = \sum_i \alpha_i k(x, x_i) + b` by one linear system. Kernel ridge regression is the
    same model without the bias; the bias makes the fit independent of an offset of y. Use it for smooth
    functions of a few columns, scaled for example by :class:`~sklearn.preprocessing.StandardScaler`: exact up
    to about 100,000 rows, spanned by few of them beyond.

    Parameters
    ----------
    kernel : {"rbf", "linear", "polynomial", "poly", "laplacian", "precomputed"} or callable, default="rbf"
        A callable takes two rows and returns one number. With "precomputed", X is the kernel matrix: of shape
        (n_samples, n_samples) in `fit`, where only its lower triangle is read, and of shape
        (n_queries, n_samples) in `predict`.
    C : float, default=100.0
        Weight of the squared errors against the size of the function; `1 / C` is the `alpha` of ridge
        regression. Near the variance of the signal over that of the noise: the default suits 10 % noise.
    gamma : float, default=None
        Scale of the kernels rbf :math:`e^{-\gamma |x-z|^2}`, laplacian :math:`e^{-\gamma |x-z|_1}` and
        polynomial :math:`(\gamma x^T z + c_0)^d`. None is one over the number of columns.
    degree : int, default=3
        Degree :math:`d` of the polynomial.
    coef0 : float, default=1
        Constant :math:`c_0` of the polynomial.
    kernel_params : dict, default=None
        Keywords for a callable kernel.
    bias : {"free", "regularized", "none"}, default="free"
        "free": :math:`b` costs nothing, equations 8 to 13 of the paper. "regularized": :math:`b^2 / 2` is
        added to the cost, which the literature calls the unbiased LS-SVM. "none": :math:`b = 0`, kernel ridge
        regression.
    solver : {"auto", "cholesky", "tiled", "pcg", "nystrom"}, default="auto"
        "cholesky" factors the matrix in place, "tiled" its lower half in tiles on several threads, "pcg"
        never stores it and takes conjugate gradients helped by a low rank of it; these three are exact.
        "nystrom" spans the function by `n_landmarks` of the rows. "auto" takes the first up to 8,000 rows,
        "pcg" up to 100,000, "tiled" where that stalls and memory allows, and "nystrom" beyond.
    n_landmarks : int, default=1000
        Rows that span the function with "nystrom".
    tol : float, default=1e-6
        Largest residual that counts as exact, relative to the largest target less its mean; "nystrom" stops
        at a hundred times of it, in the norm of its own equations.
    max_iter : int, default=100
        Most steps of conjugate gradients.
    max_memory : float, default=None
        Bytes by which the solver is chosen; None is 0.6 of what is free.
    n_jobs : int, default=None
        Threads of "tiled", "pcg" and "nystrom"; None is what BLAS would use.
    random_state : int, RandomState instance or None, default=None
        Of the landmarks, and of the low rank of "pcg", which changes nothing beyond `tol`.

    Attributes
    ----------
    dual_coef_ : ndarray of shape (n_fit,) or (n_fit, n_targets)
        Weights :math:`\alpha` of the rows in `X_fit_`; with a precomputed kernel, of all rows.
    intercept_ : float or ndarray of shape (n_targets,)
        Bias :math:`b`.
    X_fit_ : ndarray of shape (n_fit, n_features) or None
        Rows whose weight is not zero, or the landmarks; None with a precomputed kernel.
    offset_ : ndarray of shape (n_features,)
        Taken off all rows, so that small differences keep their digits; none with a precomputed kernel.
    solver_ : str
        The solver that gave the solution.
    n_iter_ : int
        Solutions that it made one after the other: 1 of a factorisation.
    residual_ : float
        Largest :math:`|f(x_i) + \alpha_i / (C s_i) - y_i|`, relative as under `tol`; of "cholesky" of some.
    n_features_in_ : int
        Number of columns seen in `fit`.
    feature_names_in_ : ndarray of shape (n_features_in_,)
        Names of the columns, where X had names.

    See Also
    --------
    sklearn.kernel_ridge.KernelRidge : The same without bias.
    sklearn.svm.SVR : Sparse solution, by another loss.

    Notes
    -----
    Minimises :math:`\frac12 |w|^2 + \frac{C}{2} \sum_i s_i \xi_i^2` with
    :math:`y_i = w^T \varphi(x_i) + b + \xi_i` and sample weights :math:`s_i`. The optimum solves

    .. math::

        \begin{bmatrix} 0 & 1^T \\ 1 & K + \mathrm{diag}(1 / (C s_i)) \end{bmatrix}
        \begin{bmatrix} b \\ \alpha \end{bmatrix} = \begin{bmatrix} 0 \\ y \end{bmatrix} ,

    by a Cholesky factorisation or by conjugate gradients. Where the matrix is not positive definite, or its
    factor does not solve the equations to a thousandth, a :class:`scipy.linalg.LinAlgWarning` tells that the
    least-squares solution was taken; so it does where the equations are met worse than `tol`.

    References
    ----------
    .. [1] J. A. K. Suykens et al., Least Squares Support Vector Machines, World Scientific, 2002.
    .. [2] H.-Q. Wang et al., An unbiased LSSVM model for classification and regression, Soft Computing, 2010.
    .. [3] M. Diaz et al., Robust, randomized preconditioning for kernel ridge regression, arXiv 2304.12465.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.lssvm import LSSVMRegressor
    >>> opening = np.linspace(0, 1, 21)[:, None]
    >>> kv = 50.0 ** (opening[:, 0] - 1)
    >>> model = LSSVMRegressor(C=1e6, gamma=2.0).fit(opening, kv)
    >>> model.predict([[0.525]]).round(3)
    array([0.156])
    """

    _parameter_constraints: ClassVar[dict] = {
        "kernel": [
            StrOptions({"rbf", "linear", "polynomial", "poly", "laplacian", "precomputed"}),
            callable,
        ],
        "C": [Interval(Real, 0, None, closed="neither")],
        "gamma": [Interval(Real, 0, None, closed="neither"), None],
        "degree": [Interval(Integral, 1, None, closed="left")],
        "coef0": [Interval(Real, None, None, closed="neither")],
        "kernel_params": [dict, None],
        "bias": [StrOptions({"free", "regularized", "none"})],
        "solver": [StrOptions({"auto", *SOLVERS})],
        "n_landmarks": [Interval(Integral, 1, None, closed="left")],
        "tol": [Interval(Real, 0, None, closed="neither")],
        "max_iter": [Interval(Integral, 1, None, closed="left")],
        "max_memory": [Interval(Real, 0, None, closed="neither"), None],
        "n_jobs": [Integral, None],
        "random_state": ["random_state"],
    }

    def __init__(
        self,
        kernel="rbf",
        *,
        C=100.0,
        gamma=None,
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
    ):
        self.kernel = kernel
        self.C = C
        self.gamma = gamma
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

    def __sklearn_tags__(self):
        tags = super().__sklearn_tags__()
        tags.input_tags.pairwise = self.kernel == "precomputed"
        return tags

    @_fit_context(prefer_skip_nested_validation=True)
    def fit(self, X, y, sample_weight=None):
        """Fit the model.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            Rows to learn from, or the kernel matrix of shape (n_samples, n_samples).
        y : array-like of shape (n_samples,) or (n_samples, n_targets)
            Targets.
        sample_weight : float or array-like of shape (n_samples,), default=None
            Non-negative. A row of weight k counts as k equal rows, one of weight 0 as absent.

        Returns
        -------
        self : LSSVMRegressor
            The fitted model.

        Raises
        ------
        ValueError
            If the data are not finite numbers, a kernel matrix is not square, weights are negative or all
            zero, 1 / C is infinite, or kernel values overflow.
        """
        X, y = validate_data(self, X, y, dtype=np.float64, multi_output=True, y_numeric=True)
        ridge = ridge_of(self.C, sample_weight, X)
        rows = np.isfinite(ridge)
        targets = y.astype(np.float64).reshape(len(y), -1)[rows]
        machine = self._machine(X, rows)
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            dual, self.solver_, landmarks = machine.solved(self.solver, targets, ridge[rows])
        self.n_iter_, self.residual_ = dual.n_iter + 1, dual.residual
        alpha = dual.alpha
        if landmarks is not None:
            self.X_fit_ = landmarks + self.offset_
        b = dual.b - self._offset(alpha)
        if self.kernel == "precomputed":
            kept, alpha = alpha, np.zeros((len(y), targets.shape[1]))
            alpha[rows] = kept
        self.dual_coef_ = alpha[:, 0] if y.ndim == 1 else alpha
        self.intercept_ = float(b[0]) if y.ndim == 1 else b
        return self

    def predict(self, X):
        """Predict the target.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            Rows, or their kernel values against the rows of the fit, of shape (n_samples, n_fit).

        Returns
        -------
        y : ndarray of shape (n_samples,) or (n_samples, n_targets)
            Predictions. Memory beyond them and X is bounded, whatever the number of rows.
        """
        check_is_fitted(self)
        X = validate_data(self, X, dtype=np.float64, reset=False)
        alpha = self.dual_coef_.reshape(len(self.dual_coef_), -1)
        if self.kernel == "precomputed":
            product = X @ alpha
        else:
            product = self._product(X - self.offset_, self.X_fit_ - self.offset_, alpha)
            product += self._offset(alpha)
        return (product[:, 0] if self.dual_coef_.ndim == 1 else product) + self.intercept_

    def _machine(self, X, rows):
        """What is to be solved, of the kept rows."""
        options = {
            name: getattr(self, name) for name in ("C", "bias", "tol", "max_iter", "n_landmarks", "n_jobs")
        }
        options["random_state"] = check_random_state(self.random_state)
        more = {"memory": memory_to_use(self.max_memory), "options": options}
        if self.kernel == "precomputed":
            if X.shape[0] != X.shape[1]:
                raise ValueError(f"A precomputed kernel matrix must be square, got shape {X.shape}.")
            self.X_fit_ = None
            matrix = X if rows.all() else X[np.ix_(rows, rows)]
            return Machine(None, None, matrix, length=None, **more)
        self.X_fit_ = X[rows]
        self.offset_ = self._centre()
        length = kernel_length(self.kernel, self.gamma, X.shape[1])
        return Machine(self._between(), self.X_fit_ - self.offset_, None, length=length, **more)

    def _product(self, A, B, alpha):
        if len(A) * len(B) < _MANY:
            return kernel_product(self._between(), A, B, alpha)
        with own_threads(self.n_jobs) as run:
            return product_of(run, KernelBlocks(self._between(), A, B), (len(A), len(B)), alpha)

    def _between(self):
        return kernel_between(
            self.kernel,
            gamma=self.gamma,
            degree=self.degree,
            coef0=self.coef0,
            kernel_params=self.kernel_params,
        )

    def _centre(self):
        kernel = self.kernel if isinstance(self.kernel, str) else None
        if kernel in SHIFT_INVARIANT or (kernel == "linear" and self.bias == "free"):
            return self.X_fit_.mean(axis=0)
        return np.zeros(self.X_fit_.shape[1])

    def _offset(self, alpha):
        """What `offset_` takes off the value of the linear kernel; others do not see it."""
        if self.kernel != "linear":
            return 0.0
        return self.offset_ @ ((self.X_fit_ - self.offset_).T @ alpha)
