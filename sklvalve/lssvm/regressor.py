# SPDX-License-Identifier: BSD-3-Clause
"""The LS-SVM as a scikit-learn regressor."""

from numbers import Integral, Real
from typing import ClassVar

import numpy as np
from sklearn.base import BaseEstimator, MultiOutputMixin, RegressorMixin, _fit_context
from sklearn.utils._param_validation import Interval, StrOptions
from sklearn.utils.metaestimators import available_if
from sklearn.utils.validation import validate_data

from sklvalve._refits import whole_or_nothing
from sklvalve.lssvm import device
from sklvalve.lssvm.choice import SOLVERS
from sklvalve.lssvm.distributed import is_dask
from sklvalve.lssvm.fitting import Fitting
from sklvalve.lssvm.predicting import Predicting


def _may_come(*without):
    """Whether rows may come in parts: a kernel matrix has none, and some parameters need all rows at once."""

    def check(estimator):
        if isinstance(estimator.kernel, str) and estimator.kernel == "precomputed":
            raise AttributeError("A precomputed kernel has no rows that could come in parts; use fit.")
        for name in without:
            if getattr(estimator, name):
                raise AttributeError(
                    f"{name}={getattr(estimator, name)!r} needs all rows at once; use fit, or leave it out."
                )
        return True

    return check


class LSSVMRegressor(Fitting, Predicting, MultiOutputMixin, RegressorMixin, BaseEstimator):
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
        regression. A larger C follows the targets more closely. Begin with the variance of the signal over
        that of the noise: the default suits noise of 10 % of the signal's standard deviation.
    gamma : float, array-like of shape (n_features,) or "scale", default=None
        Scale of the kernels rbf :math:`e^{-\gamma |x-z|^2}`, laplacian :math:`e^{-\gamma |x-z|_1}` and
        polynomial :math:`(\gamma x^T z + c_0)^d`; several are one for each column, within the sum. None is
        one over the number of columns; "scale" is that over the variance of all numbers of X, as in
        :class:`~sklearn.svm.SVR`. Of rows that come in parts it is that of all blocks of `fit_blocks`, and of
        the first call of `partial_fit`.
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
        Landmarks: rows at which the kernels of "nystrom" are centred, whose sum is the function.
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
    robust_passes : int, default=0
        Times that the fit is made again with less weight on rows that are far from it: a few where some
        targets are wrong.
    uncertainty : bool, default=False
        Get ready for `predict(..., return_std=True)` and `predict_interval`: exact up to `n_landmarks` rows,
        on so many landmarks beyond.

    Attributes
    ----------
    dual_coef_ : ndarray of shape (n_fit,) or (n_fit, n_targets)
        Weights :math:`\alpha` of the rows in `X_fit_`; with a precomputed kernel, of all rows.
    intercept_ : float or ndarray of shape (n_targets,)
        Bias :math:`b`.
    X_fit_ : ndarray of shape (n_fit, n_features) or None
        Rows whose weight is not zero, or the landmarks; rows that repeat each other are one where C is above
        1e8. None with a precomputed kernel.
    offset_ : ndarray of shape (n_features,)
        Taken off all rows, so that small differences keep their digits; none with a precomputed kernel.
    gamma_ : float, array-like of shape (n_features,) or None
        The gamma of the fit, as a number also where the parameter is None or "scale"; None of a kernel that
        has none.
    solver_ : str
        The solver that gave the solution; "online" after `partial_fit`.
    n_iter_ : int
        Solutions that it made one after the other, with the one to begin with: 1 of a factorisation.
    robust_weight_ : ndarray of shape (n_samples,)
        What `robust_passes` leave of the weight of each row.
    loo_residuals_ : ndarray of shape (n_samples,) or (n_samples, n_targets)
        With `uncertainty`: target less prediction of each row by a machine that has not seen it; NaN of rows
        without weight.
    residual_ : float
        How well the equations are solved, to be compared with `tol`; no error of prediction. It is the
        largest :math:`|f(x_i) + \alpha_i / (C s_i) - y_i|` over the largest target less its mean.
        "cholesky" looks at some rows; "nystrom" and "online" at their own equations.
    n_features_in_ : int
        Number of columns seen in `fit`.
    feature_names_in_ : ndarray of shape (`n_features_in_`,)
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
    .. [1] Suykens et al., Least Squares Support Vector Machines, World Scientific, 2002.
    .. [2] H.-Q. Wang et al., An unbiased LSSVM model for classification and regression, Soft Computing, 2010.
    .. [3] Diaz et al., Robust, randomized preconditioning for kernel ridge regression, arXiv 2304.12465.

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
        "gamma": [Interval(Real, 0, None, closed="neither"), StrOptions({"scale"}), "array-like", None],
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
        "robust_passes": [Interval(Integral, 0, None, closed="left")],
        "uncertainty": ["boolean"],
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
        robust_passes=0,
        uncertainty=False,
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
        self.robust_passes = robust_passes
        self.uncertainty = uncertainty

    def __sklearn_tags__(self):
        tags = super().__sklearn_tags__()
        tags.input_tags.pairwise = self.kernel == "precomputed"
        tags.array_api_support = device.can_fit(self)
        return tags

    @_fit_context(prefer_skip_nested_validation=True)
    @whole_or_nothing
    def fit(self, X, y, sample_weight=None):
        """Fit the model.

        Parameters
        ----------
        X : array-like, or Dask array or data frame, of shape (n_samples, n_features)
            Rows to learn from, or the kernel matrix of shape (n_samples, n_samples). An array that is mapped
            into memory is read in blocks by "nystrom", and so are the parts of a Dask collection, on whatever
            scheduler or cluster Dask is set to; keep them in its memory by `persist` if they fit. Where
            `array_api_dispatch` of scikit-learn is on, arrays of other libraries stay on their device.
        y : array-like of shape (n_samples,) or (n_samples, n_targets)
            Targets; a Dask collection divided as X if that is one.
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
        if is_dask(X):
            return self._fit_dask(X, y, sample_weight)
        if device.is_elsewhere(X):
            return device.fitted(self, X, y, sample_weight)
        X, y = validate_data(self, X, y, dtype=(np.float64, np.float32), multi_output=True, y_numeric=True)
        return self._fit_arrays(X, y, sample_weight)

    @available_if(_may_come("robust_passes"))
    @_fit_context(prefer_skip_nested_validation=True)
    @whole_or_nothing
    def fit_blocks(self, blocks):
        """Fit to rows that come in blocks and never all at once, by the solver "nystrom".

        Parameters
        ----------
        blocks : iterable or callable
            Of blocks ``(X, y)`` or ``(X, y, sample_weight)``, the same each time it is iterated over, some
            ten times; or a function that returns a new iterator.

        Returns
        -------
        self : LSSVMRegressor

        Raises
        ------
        ValueError
            If the blocks can be read only once, or one is no block, not finite, or unlike the first.
        """
        return self._fit_given(blocks)

    @available_if(_may_come("robust_passes", "uncertainty"))
    @_fit_context(prefer_skip_nested_validation=True)
    @whole_or_nothing
    def partial_fit(self, X, y, sample_weight=None):
        """Add rows to what was learnt; the rows themselves are not kept.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
        y : array-like of shape (n_samples,) or (n_samples, n_targets)
        sample_weight : float or array-like of shape (n_samples,), default=None

        Returns
        -------
        self : LSSVMRegressor
            Fitted to the rows of all calls since the first, or since the last `fit`, whose rows it does not
            know. The function is spanned by at most `n_landmarks` of them, chosen as they come.

        Raises
        ------
        ValueError
            If rows are unlike those before, or not finite.

        Warns
        -----
        UserWarning
            If there are `n_landmarks` already and they do not span the new rows.
        """
        if device.is_elsewhere(X):
            raise ValueError("partial_fit needs rows in numpy arrays; move X and y there.")
        return self._fit_more(X, y, sample_weight)
