# SPDX-License-Identifier: BSD-3-Clause
"""Errors of an LS-SVM on rows that it is not fitted to, for a whole path of C, from one decomposition."""

import numpy as np
from scipy.linalg import eigh, lu_factor, lu_solve
from scipy.linalg.lapack import dpotri

from sklvalve.lssvm.kernels import kernel_diagonal, lower_gram
from sklvalve.lssvm.pivoted import pivoted_cholesky
from sklvalve.lssvm.solvers import cholesky, raise_unless_finite

# up to so many rows the whole matrix is decomposed; beyond, a low rank of it, where that is good enough
_WHOLE, _RANK = 1000, 2000
# what a low rank leaves of the diagonal, against the ridge 1 / C: so much moves no score by 1e-3
_GOOD_ENOUGH = 3e-4


class LeftOut:
    r"""Errors on rows that are left out, for any C.

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

    Notes
    -----
    With :math:`H = K + \mathrm{diag}(1 / (C w))` and

    .. math:: P = H^{-1} - \frac{H^{-1} 1 1^T H^{-1}}{q + 1^T H^{-1} 1}, \quad \alpha = P y

    with q = 0 for a free bias and 1 for a regularized one (and without the second term for none), a machine
    that is fitted without the rows B errs there by :math:`P_{BB}^{-1} \alpha_B`, exactly.

    References
    ----------
    .. [1] G. C. Cawley, N. L. C. Talbot, Fast exact leave-one-out cross-validation of sparse least-squares
       support vector machines, Neural Networks 17 (2004) 1467.
    """

    def __init__(self, between, X, weight, *, largest_C, bias="free", blocks=None, random_state, n_jobs=None):
        self._root, self._bias = np.sqrt(weight), bias
        self._blocks = None if blocks is None else [_placed(*block, len(X)) for block in blocks]
        self._between, self._X = between, X
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
            rank=min(_RANK, n // 2),
            left=left * n * 0.2,
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
            return self._by_inverse(C, y)
        return self._errors(_Spectral(self._vectors, self._values, C, self._root), y)

    def _errors(self, inverse, y):
        # digits of an offset that the bias takes up are digits lost
        y = y - y.mean(axis=0) if self._bias == "free" else y
        of_y, of_ones = inverse @ y, inverse @ np.ones((len(y), 1))
        size = of_ones.sum() + {"free": 0.0, "regularized": 1.0, "none": np.inf}[self._bias]
        alpha = of_y - of_ones * (of_y.sum(axis=0) / size)
        if self._blocks is None:
            return alpha / (inverse.diagonal() - of_ones[:, 0] ** 2 / size)[:, None]
        errors = np.full(y.shape, np.nan)
        for block, out, own in self._blocks:
            ones = of_ones[out]
            part = inverse.block(out) - ones @ ones.T / size
            errors[block] = lu_solve(lu_factor(part, check_finite=False), alpha[out], check_finite=False)[own]
        return errors

    def _whole(self):
        gram = self._weighted_gram()
        raise_unless_finite(gram.diagonal())
        return eigh(gram, lower=True, overwrite_a=True, check_finite=False, driver="evd")

    def _weighted_gram(self):
        gram = lower_gram(self._between, self._X)
        gram *= self._root[:, None]
        gram *= self._root
        return gram

    def _by_inverse(self, C, y):
        """By a factorisation for this C alone."""
        gram = self._weighted_gram()
        gram[np.diag_indices_from(gram)] += 1.0 / C
        if not cholesky(gram):
            raise ValueError(
                f"The kernel matrix plus 1/C on its diagonal is not positive definite for C = {C:g}: it is "
                "no kernel, or C is too large for it; leave out the largest values of C."
            )
        inverse = np.tril(dpotri(gram, lower=1, overwrite_c=1)[0])
        inverse += np.tril(inverse, -1).T
        inverse *= self._root[:, None]
        inverse *= self._root
        return self._errors(_Dense(inverse), y)


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


class _Dense:
    def __init__(self, inverse):
        self._inverse = inverse

    def __matmul__(self, right):
        return self._inverse @ right

    def diagonal(self):
        return self._inverse.diagonal()

    def block(self, rows):
        return self._inverse[np.ix_(rows, rows)]


def _of_low_rank(F):
    """Eigenvalues and eigenvectors of F F^T, those that are not lost in rounding."""
    if F.shape[1] == 0:
        return np.zeros(0), F
    values, inner = eigh(F.T @ F, check_finite=False)
    kept = values > len(values) * np.finfo(float).eps * values.max()
    values, inner = values[kept], inner[:, kept]
    return values, F @ (inner / np.sqrt(values))


def _placed(rows, out, n):
    """Rows, the rows left out with them, and where they stand among those."""
    if len(out) >= n - 1:
        raise ValueError("a block that is left out with its gap leaves no row to fit; use more blocks")
    place = np.full(n, -1)
    place[out] = np.arange(len(out))
    return rows, out, place[rows]


def score_of(errors, weight):
    """Root of the weighted mean square of errors of shape (n, n_targets)."""
    return float(np.sqrt(np.average(np.mean(errors**2, axis=1), weights=weight)))
