# SPDX-License-Identifier: BSD-3-Clause
"""Errors of an LS-SVM on rows that it is not fitted to, for a whole path of C, from one decomposition."""

import numpy as np
from scipy.linalg import eigh

from sklvalve.lssvm.held_out import DenseInverse, HeldOutErrors, checked_blocks
from sklvalve.lssvm.kernels import kernel_diagonal, lower_gram
from sklvalve.lssvm.pivoted import pivoted_cholesky
from sklvalve.lssvm.solvers import raise_unless_finite

# up to so many rows the whole matrix is decomposed; beyond, a low rank of it, where that is good enough
_WHOLE, _RANK, _SHARE = 1000, 2500, 0.6
# what a low rank leaves of the diagonal, against the ridge 1 / C: so much moves no score by 1e-3
_GOOD_ENOUGH = 2e-4


class LeftOut:
    """Errors on rows that are left out, for any C.

    Parameters
    ----------
    between : callable
        ``between(A, B)`` is the kernel matrix of the rows of two arrays.
    X : ndarray of shape (n, d)
    weight : ndarray of shape (n,)
        Positive.
    largest_C : float
        Of the path: it says how good a low rank is wanted. For a C for which it is too poor, the whole
        matrix is inverted.
    bias : {"free", "regularized", "none"}, default="free"
    blocks : sequence of (ndarray of int, ndarray of int), default=None
        Rows to err on, and the rows that are left out with them, the former among these; each row by itself
        unless given.
    random_state : RandomState
    n_jobs : int, default=None

    Attributes
    ----------
    method : {"eigenvalues", "low rank"}
    """

    def __init__(self, between, X, weight, *, largest_C, bias="free", blocks=None, random_state, n_jobs=None):
        self._root, self._bias = np.sqrt(weight), bias
        self._between, self._X, self._blocks = between, X, checked_blocks(blocks, len(X))
        n = len(X)
        if n <= _WHOLE:
            self.method = "eigenvalues"
            self._values, self._vectors = self._whole()
            self._largest = np.inf
            return
        self.method = "low rank"
        diagonal = kernel_diagonal(between, X) * weight
        left = _GOOD_ENOUGH / largest_C
        # scaled by the roots of the weights, so that the ridge is the same everywhere
        F, _, rest = pivoted_cholesky(
            _Weighted(between, X.shape[1]),
            np.column_stack([X, self._root]),
            diagonal,
            rank=min(_RANK, int(_SHARE * n)),
            left=0.8 * left * n,
            random_state=random_state,
            n_jobs=n_jobs,
        )
        self._largest = left * n / rest * largest_C if rest > 0.0 else np.inf
        self._values, self._vectors = _of_low_rank(F)

    def errors(self, C, y):
        """Errors on the rows left out, target less prediction.

        Parameters
        ----------
        C : float
        y : ndarray of shape (n, n_targets)

        Returns
        -------
        errors : ndarray of shape (n, n_targets)
            NaN in rows that belong to no block.
        """
        if self._largest < C:
            inverse = self._inverse(C)
        else:
            inverse = _Spectral(self._vectors, self._values, C, self._root)
        return HeldOutErrors(inverse, len(y), bias=self._bias, blocks=self._blocks)(y)

    def _whole(self):
        gram = self._weighted_gram()
        raise_unless_finite(gram.diagonal())
        return eigh(gram, lower=True, overwrite_a=True, check_finite=False, driver="evd")

    def _weighted_gram(self):
        gram = lower_gram(self._between, self._X)
        gram *= self._root[:, None]
        gram *= self._root
        return gram

    def _inverse(self, C):
        """By a factorisation for this C alone."""
        gram = self._weighted_gram()
        gram[np.diag_indices_from(gram)] += 1.0 / C
        try:
            return DenseInverse(gram, self._root)
        except ValueError as error:
            raise ValueError(
                f"The kernel matrix plus 1/C on its diagonal is not positive definite for C = {C:g}: it is "
                "no kernel, or C is too large for it; leave out the largest values of C."
            ) from error


class _Weighted:
    """A kernel between rows times the roots of their weights, which stand in the last column."""

    def __init__(self, between, d):
        self._between, self._d = between, d

    def __call__(self, A, B):
        values = self._between(A[:, : self._d], B[:, : self._d])
        values *= A[:, self._d, None]
        values *= B[:, self._d]
        return values


class _Spectral:
    r"""Inverse of K + diag(1 / (C w)) from :math:`W^{1/2} K W^{1/2} = Q \Lambda Q^T`, all of it or most."""

    def __init__(self, vectors, values, C, root):
        self._vectors, self._root = vectors, root
        self._all = vectors.shape[1] == len(root)
        inside = np.maximum(values, 0.0) + 1.0 / C
        # directions that a low rank has not keep the ridge alone
        self._rest = 0.0 if self._all else C
        self._inner = 1.0 / inside - self._rest

    def __matmul__(self, right):
        scaled = self._root[:, None] * right
        made = self._vectors @ (self._inner[:, None] * (self._vectors.T @ scaled))
        if not self._all:
            made += self._rest * scaled
        return self._root[:, None] * made

    def diagonal(self):
        made = np.einsum("ij,ij,j->i", self._vectors, self._vectors, self._inner) + self._rest
        return self._root**2 * made

    def block(self, rows):
        part = self._vectors[rows]
        made = (part * self._inner) @ part.T
        made[np.diag_indices_from(made)] += self._rest
        return self._root[rows, None] * made * self._root[rows]


def _of_low_rank(F):
    """Eigenvalues and eigenvectors of F F^T, those that are not lost in rounding."""
    if F.shape[1] == 0:
        return np.zeros(0), F
    values, inner = eigh(F.T @ F, overwrite_a=True, check_finite=False, driver="evd")
    kept = values > len(values) * np.finfo(float).eps * values.max()
    values, inner = values[kept], inner[:, kept]
    return values, F @ (inner / np.sqrt(values))


def score_of(errors, weight):
    """Root of the weighted mean square of errors of shape (n, n_targets)."""
    return float(np.sqrt(np.average(np.mean(errors**2, axis=1), weights=weight)))
