# SPDX-License-Identifier: BSD-3-Clause
"""Kernels k(x, z) between the rows of two arrays, and the matrices made of them."""

from functools import partial

import numpy as np
from scipy.spatial.distance import cdist
from sklearn.metrics.pairwise import pairwise_kernels

from sklvalve.lssvm.solvers import raise_unless_finite

# Kernels that see differences of rows only, so that a common offset may be taken off for accuracy.
SHIFT_INVARIANT = frozenset({"rbf", "laplacian"})

#: Kernels that have a gamma.
WITH_GAMMA = ("rbf", "laplacian", "polynomial", "poly")

# Numbers in one block of kernel values: 8 MiB, small enough to stay near the processor.
BLOCK = 2**20
# of an exponent; beyond it less than eleven digits of a kernel value are left
_FAR = 1e5


def kernel_between(kernel, *, gamma=None, degree=3, coef0=1, kernel_params=None):
    """Return the function that gives the kernel matrix between the rows of two arrays.

    Parameters
    ----------
    kernel : {"rbf", "linear", "polynomial", "poly", "laplacian"} or callable
        A callable takes two rows and returns one number.
    gamma : float, default=None
        Scale of rbf, laplacian and polynomial; None is one over the number of columns.
    degree : int, default=3
        Of the polynomial.
    coef0 : float, default=1
        Of the polynomial.
    kernel_params : dict, default=None
        Keywords for a callable.

    Returns
    -------
    between : callable
        ``between(A, B)`` is an ndarray of shape (rows of A, rows of B).

    Examples
    --------
    >>> import numpy as np
    >>> kernel_between("linear")(np.eye(2), np.ones((1, 2)))
    array([[1.],
           [1.]])
    """
    if callable(kernel):
        return partial(pairwise_kernels, metric=kernel, **(kernel_params or {}))
    if kernel == "linear":
        return _linear
    if kernel == "rbf":
        return partial(_rbf, gamma=gamma)
    if kernel == "laplacian":
        return partial(_laplacian, gamma=gamma)
    if kernel in ("polynomial", "poly"):
        return partial(_polynomial, gamma=gamma, degree=degree, coef0=coef0)
    raise ValueError(
        f"kernel must be rbf, linear, polynomial, poly, laplacian or a callable of two rows, got {kernel!r}."
    )


def gamma_and_scale(kernel, gamma, n_features):
    """One gamma for all columns, and what each column is multiplied by for it; None where by nothing.

    Parameters
    ----------
    kernel : str or callable
    gamma : float, array-like of shape (n_features,) or None
        Several are one for each column.
    n_features : int

    Returns
    -------
    gamma : float or None
        None for a kernel that has none, too.
    scale : ndarray of shape (n_features,) or None

    Raises
    ------
    ValueError
        If there are several, and not one for each column, or not all positive and finite.
    """
    if kernel == "linear" or callable(kernel):
        return None, None
    if gamma is None or np.ndim(gamma) == 0:
        return gamma, None
    gammas = np.asarray(gamma, dtype=np.float64)
    if gammas.shape != (n_features,) or not (np.isfinite(gammas) & (gammas > 0.0)).all():
        raise ValueError(
            f"gamma must be one positive number, or one for each of the {n_features} columns of X; got "
            f"{gamma!r}."
        )
    return 1.0, gammas if kernel == "laplacian" else np.sqrt(gammas)


def kernel_length(kernel, gamma, n_features):
    """Distance over which a kernel falls; None where it is no function of the distance."""
    gamma = 1.0 / n_features if gamma is None else gamma
    if kernel == "rbf":
        return (2.0 * gamma) ** -0.5
    return 1.0 / gamma if kernel == "laplacian" else None


def gaussian_gamma(between, n_features):
    """Gamma of a gaussian kernel; None for every other."""
    if not (isinstance(between, partial) and between.func is _rbf):
        return None
    gamma = between.keywords["gamma"]
    return 1.0 / n_features if gamma is None else gamma


def loses_digits(exponents):
    """Whether squared distances must be taken from differences, by gamma times the squares of the rows.

    As a sum of squares and a product they are quick, and lose as many digits as rows are far from the middle
    in lengths of the kernel: one row that is far off would do that to all. A ValueError where they overflow.
    """
    raise_unless_finite(exponents)
    return len(exponents) > 0 and exponents.max() > _FAR


def kernel_diagonal(between, X):
    """Diagonal of the kernel matrix of the rows of X, of shape (n,)."""
    # small blocks: most of each is thrown away
    parts = [np.einsum("ii->i", between(rows, rows)) for rows in np.split(X, range(32, len(X), 32))]
    return np.concatenate(parts)


def lower_gram(between, X):
    """Lower triangle of the kernel matrix of the rows of X; what stands above the diagonal is undefined.

    Fortran order, as the factorisation wants it. Memory beyond the result stays at a few blocks.
    """
    n = X.shape[0]
    gram = np.empty((n, n), order="F")
    for rows in row_blocks(n, n):
        gram[rows.start :, rows] = between(X[rows], X[rows.start :]).T
    return gram


def row_blocks(n_rows, n_columns):
    """Slices that cover `n_rows` rows so that each block of the matrix has about `BLOCK` numbers."""
    step = max(1, BLOCK // max(1, n_columns))
    return [slice(start, min(start + step, n_rows)) for start in range(0, n_rows, step)]


def _linear(A, B):
    return A @ B.T


def _rbf(A, B, *, gamma):
    of_B = np.einsum("ij,ij->i", B, B)
    if loses_digits(_scale(gamma, A) * of_B):
        values = cdist(A, B, metric="sqeuclidean")
    else:
        values = A @ B.T
        values *= -2.0
        values += np.einsum("ij,ij->i", A, A)[:, None]
        values += of_B
        # rounding leaves squared distances of equal rows a little below zero; a row is quicker than a 0
        np.maximum(values, np.zeros(len(B)), out=values)
    values *= -_scale(gamma, A)
    return np.exp(values, out=values)


def _laplacian(A, B, *, gamma):
    values = cdist(A, B, metric="cityblock")
    values *= -_scale(gamma, A)
    return np.exp(values, out=values)


def _polynomial(A, B, *, gamma, degree, coef0):
    values = A @ B.T
    values *= _scale(gamma, A)
    values += coef0
    return np.power(values, degree, out=values)


def _scale(gamma, A):
    return 1.0 / A.shape[1] if gamma is None else gamma
