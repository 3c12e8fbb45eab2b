# SPDX-License-Identifier: BSD-3-Clause
"""The same machine on arrays of another library, where they lie: on a GPU for one.

Whatever follows the array API will do, scikit-learn's `array_api_dispatch` switched on. The equations are
solved by one factorisation in the memory of the device, and once more for what is left of them. It must hold
the kernel matrix and its factor, and nothing else of that size; beside a precomputed one that as well.
"""

import warnings
from contextlib import contextmanager
from functools import partial

import numpy as np
from scipy.linalg import LinAlgWarning
from sklearn import get_config
from sklearn.utils._array_api import get_namespace
from sklearn.utils.validation import _check_sample_weight, validate_data

from sklvalve.lssvm.products import raise_of_overflow
from sklvalve.lssvm.rows import kernel_moves_along, raise_unless_usable, raise_unless_weighed

# numbers of one block of kernel values of a prediction
_BLOCK = 2**25
_REFINEMENTS = 3
# parameters some of whose values only numpy arrays go with
_WANTS_NUMPY = ("kernel", "solver", "robust_passes", "uncertainty")


def is_elsewhere(X):
    """Whether X is an array of another library, to be left where it is."""
    if not get_config().get("array_api_dispatch") or isinstance(X, np.ndarray):
        return False
    if not (hasattr(X, "__array_namespace__") or type(X).__module__.startswith(("torch", "cupy"))):
        return False
    return get_namespace(X)[1]


def can_fit(estimator):
    """Whether a machine of such parameters can be fitted elsewhere than in numpy arrays."""
    return all(_is_possible(estimator, name) for name in _WANTS_NUMPY)


def _is_possible(estimator, name):
    value = getattr(estimator, name)
    if name == "kernel":
        return not callable(value)
    return value in ("auto", "cholesky") if name == "solver" else not value


def fitted(estimator, X, y, sample_weight):
    """`LSSVMRegressor.fit` on the device of X.

    Returns
    -------
    estimator : LSSVMRegressor
        Whose arrays lie where X does.

    Raises
    ------
    ValueError
        If the kernel is a callable, an option needs rows in numpy arrays, or the data are not finite.
    MemoryError
        If the memory of the device does not hold the kernel matrix and its factor.
    """
    # only newer releases of scikit-learn have these, and numpy arrays do not need them
    from sklearn.utils._array_api import _max_precision_float_dtype, move_to

    xp, _ = get_namespace(X)
    raise_unless_usable(estimator.C)
    for name in _WANTS_NUMPY:
        if not _is_possible(estimator, name):
            raise ValueError(
                f"{name}={getattr(estimator, name)!r} needs rows in numpy arrays; move X and y there."
            )
    y, sample_weight = move_to(y, sample_weight, xp=xp, device=X.device)
    X, y = validate_data(estimator, X, y, dtype=(xp.float64, xp.float32), multi_output=True, y_numeric=True)
    # in double, as with numpy arrays, wherever the device has it
    X = xp.astype(X, _max_precision_float_dtype(xp, X.device), copy=False)
    targets = xp.reshape(xp.astype(y, X.dtype), (y.shape[0], -1))
    weight = _weight(xp, X, sample_weight)
    kept = xp.nonzero(weight > 0)[0]
    raise_unless_weighed(kept.shape[0] > 0)
    all_rows = X
    X, targets, weight = (xp.take(column, kept, axis=0) for column in (X, targets, weight))
    estimator._begin_anew(lambda: [_moments(xp, X, weight)])
    estimator._seen_ = estimator._spread_ = estimator.X_fit_ = None
    with _memory_in_words(X.shape[0], xp.finfo(X.dtype).bits // 8):
        given = estimator.kernel == "precomputed"
        gram = xp.take(X, kept, axis=1) if given else _own_kernel(estimator, xp, X)
        alpha, b, residual = _solved(xp, gram, targets, 1.0 / (estimator.C * weight), estimator)
        if given:
            here = xp.arange(all_rows.shape[0], device=X.device)[:, None] == kept[None, :]
            alpha = xp.astype(here, alpha.dtype) @ alpha
    estimator.dual_coef_ = alpha[:, 0] if y.ndim == 1 else alpha
    estimator.intercept_ = float(b[0]) if y.ndim == 1 else b
    estimator.solver_, estimator.n_iter_, estimator.residual_ = "cholesky", 1, residual
    return estimator


def predicted(estimator, X):
    """`LSSVMRegressor.predict` on the device of X, in blocks."""
    from sklearn.utils._array_api import check_same_namespace

    check_same_namespace(X, estimator, attribute="dual_coef_", method="predict")
    xp, _ = get_namespace(X)
    X = validate_data(estimator, X, dtype=(xp.float64, xp.float32), reset=False)
    alpha = estimator.dual_coef_
    X, alpha = xp.astype(X, alpha.dtype, copy=False), xp.reshape(alpha, (alpha.shape[0], -1))
    parts = []
    for block in _blocks(X.shape[0], alpha.shape[0]):
        values = X[block, :]
        if estimator._kernel_["kernel"] != "precomputed":
            values = _kernel(estimator, xp, values, estimator._right_)
        parts.append(values @ alpha + estimator.intercept_)
    found = xp.concat(parts)
    overflown = xp.any(~xp.isfinite(found), axis=1)
    if bool(xp.any(overflown)):
        raise_of_overflow(int(xp.count_nonzero(overflown)))
    return found[:, 0] if estimator.dual_coef_.ndim == 1 else found


@contextmanager
def _memory_in_words(rows, itemsize):
    """Says in a sentence what a fit of so many rows needs where the device has too little memory."""
    try:
        yield
    except (RuntimeError, MemoryError) as error:
        if "OutOfMemory" not in type(error).__name__:
            raise
        raise MemoryError(
            f"An exact fit of {rows} rows needs some {2.0 * itemsize * rows**2 / 2**30:.3g} GiB where the "
            "arrays lie, for the kernel matrix and its factor; give fewer rows, or numpy arrays, which need "
            "no matrix."
        ) from error


def _blocks(rows, columns):
    """Slices of the rows of a matrix, none with more numbers than a block holds."""
    step = max(1, _BLOCK // columns)
    return [slice(start, min(start + step, rows)) for start in range(0, rows, step)]


def _own_kernel(estimator, xp, X):
    estimator.X_fit_ = X
    moved = kernel_moves_along(estimator.kernel, estimator.bias)
    estimator.offset_ = xp.mean(X, axis=0) if moved else xp.zeros_like(X[0, :])
    rows, gamma = _moved(estimator, xp, X)
    if estimator.kernel == "rbf":
        squares = xp.sum(rows * rows, axis=1)[:, None]
        rows = xp.concat([rows, xp.ones_like(squares), -gamma * squares], axis=1)
    estimator._right_ = rows
    return _matrix(xp, X, lambda some: _kernel(estimator, xp, some, rows))


def _matrix(xp, X, kernel):
    """Kernel values of all rows with all, in blocks; written where they will lie, if the library can."""
    n = X.shape[0]
    gram = xp.empty((n, n), dtype=X.dtype, device=X.device)
    try:
        for block in _blocks(n, n):
            gram[block, :] = kernel(X[block, :])
    except TypeError:  # arrays that cannot be changed
        return xp.concat([kernel(X[block, :]) for block in _blocks(n, n)])
    return gram


def _moved(estimator, xp, X):
    """Rows in the coordinates of the kernel, and the one gamma that is left."""
    gamma, scale = estimator._gamma_and_scale()
    X = X - estimator.offset_
    if scale is not None:
        X = X * xp.asarray(scale, dtype=X.dtype, device=X.device)
    return X, 1.0 / X.shape[1] if gamma is None else gamma


def _kernel(estimator, xp, X, right):
    """Kernel values of rows with what `_own_kernel` keeps of those of the fit."""
    (A, gamma), fitted = _moved(estimator, xp, X), estimator._kernel_
    if fitted["kernel"] == "laplacian":
        total = 0.0
        for k in range(A.shape[1]):
            total = total + xp.abs(A[:, k, None] - right[None, :, k])
        return xp.exp(-gamma * total)
    if fitted["kernel"] == "rbf":
        squares = -gamma * xp.sum(A * A, axis=1)[:, None]
        exponent = xp.concat([2.0 * gamma * A, squares, xp.ones_like(squares)], axis=1) @ right.T
        # rounding leaves squared distances of equal rows a little below zero
        return xp.exp(xp.where(exponent < 0.0, exponent, xp.zeros_like(exponent)))
    product = A @ right.T
    if fitted["kernel"] == "linear":
        return product
    return (gamma * product + fitted["coef0"]) ** fitted["degree"]


def _solved(xp, gram, y, ridge, estimator):
    """Dual weights, biases, and the worst residual relative to the target."""
    n = y.shape[0]
    matrix, free = _with_ridge(xp, gram, ridge), estimator.bias == "free"
    shift = xp.mean(y, axis=0) if free else xp.zeros_like(y[0, :])
    right = xp.concat([y - shift, xp.ones_like(y[:, :1])], axis=1)
    try:
        solve = _solver_of(xp, matrix)
        x = solve(right)
    except (RuntimeError, np.linalg.LinAlgError) as error:
        if "LinAlg" not in type(error).__name__:  # torch's own derives from RuntimeError
            raise
        raise ValueError(
            "The kernel matrix plus 1/C on its diagonal is not positive definite: it is no kernel, or C is "
            "too large for it; lower C, or fit numpy arrays, which takes the least-squares solution."
        ) from error
    size = xp.max(xp.abs(right), axis=0)
    size = xp.where(size > 0.0, size, xp.ones_like(size))
    worst = _worst(xp, right - matrix @ x, size)
    for _ in range(_REFINEMENTS):
        better = x + solve(right - matrix @ x)
        now = _worst(xp, right - matrix @ better, size)
        if not now < worst:
            break
        x, worst = better, now
    if not np.isfinite(worst):
        raise ValueError(
            "The kernel matrix or its solution is not finite: X or y is too large for this kernel; scale it."
        )
    if worst > max(estimator.tol, float(xp.finfo(gram.dtype).eps) * n):
        warnings.warn(
            f"The LS-SVM equations are met only to {worst:.1e} of the target: lower C, or use double "
            "precision.",
            LinAlgWarning,
            stacklevel=4,
        )
    alpha, ones = x[:, :-1], x[:, -1:]
    if estimator.bias == "none":
        return alpha, shift, worst
    b = xp.sum(alpha, axis=0) / (xp.sum(ones) + (0.0 if free else 1.0))
    return alpha - ones * b, b + shift, worst


def _with_ridge(xp, gram, ridge):
    """The matrix with a ridge on its diagonal; it is changed where it lies, if the library can."""
    flat = xp.reshape(gram, (-1,))
    try:
        flat[:: gram.shape[0] + 1] += ridge
    except TypeError:  # arrays that cannot be changed
        return gram + xp.eye(gram.shape[0], dtype=gram.dtype, device=gram.device) * ridge[:, None]
    return xp.reshape(flat, gram.shape)


def _solver_of(xp, matrix):
    factor = xp.linalg.cholesky(matrix)
    if not bool(xp.all(xp.isfinite(xp.linalg.diagonal(factor)))):  # cupy's way of saying so
        raise np.linalg.LinAlgError("The matrix is not positive definite.")
    lower, upper = _triangular(xp)
    if lower is None:
        return lambda right: xp.linalg.solve(matrix, right)
    return lambda right: upper(factor.T, lower(factor, right))


def _triangular(xp):
    """Solutions of lower and upper triangular systems, which the standard lacks; None where xp has none."""
    if hasattr(xp.linalg, "solve_triangular"):
        solve = xp.linalg.solve_triangular
        return partial(solve, upper=False), partial(solve, upper=True)
    if "cupy" in xp.__name__:
        from cupyx.scipy.linalg import solve_triangular

        return partial(solve_triangular, lower=True), partial(solve_triangular, lower=False)
    return None, None


def _worst(xp, left, size):
    return float(xp.max(xp.abs(left) / size))


def _moments(xp, X, weight):
    """As `rows.moments`, of rows that all count."""
    total = xp.sum(weight)
    mean = xp.sum(weight * xp.mean(X, axis=1)) / total
    square = xp.sum(weight * xp.mean((X - mean) ** 2, axis=1)) / total
    return np.array([float(total), float(mean), float(square)])


def _weight(xp, X, sample_weight):
    if sample_weight is None:
        return xp.ones(X.shape[0], dtype=X.dtype, device=X.device)
    weight = _check_sample_weight(sample_weight, X, dtype=X.dtype)
    if bool(xp.any(weight < 0)):
        raise ValueError("Negative values in data passed to `sample_weight`.")
    return weight
