# SPDX-License-Identifier: BSD-3-Clause
"""An LS-SVM whose function is spanned by few of the rows, for as many rows as there are.

The rows are read in passes, and never stored as kernel values. A system that a coarse copy of the data makes
is so near to the true one that a handful of passes is enough.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve, solve_triangular
from scipy.linalg.lapack import dpotrf

from sklvalve.lssvm.kernels import kernel_diagonal
from sklvalve.lssvm.passes import Passes
from sklvalve.lssvm.pivoted import pivoted_cholesky
from sklvalve.lssvm.threads import Turns, own_threads

# landmarks are sought among so many rows for each, and no more than that
_PER_LANDMARK, _MOST_SEARCHED = 20, 40_000
# cells, or drawn rows, of the coarse copy: its factor may cost what a few passes over all rows do
_MOST_CELLS, _FEWEST_PER_LANDMARK, _PASSES = 60_000, 5, 150
_DRAWN_PER_LANDMARK = 30
_BLOCK = 2**17
# what is added to the diagonal of a matrix of the landmarks, of its mean: the least that lets it be factored
_JITTERS = (1e-14, 1e-12, 1e-10, 1e-8)


@dataclass
class Nystrom:
    """A fitted function f(x) = sum over landmarks of alpha k(x, landmark) + b.

    Attributes
    ----------
    landmarks : ndarray of shape (m, d)
    alpha : ndarray of shape (m, n_targets)
    b : ndarray of shape (n_targets,)
    n_iter : int
        Passes over the rows, beyond the first.
    residual : float
        What is left of the equations in the norm that the coarse copy gives, relative to the targets.
    """

    landmarks: np.ndarray
    alpha: np.ndarray
    b: np.ndarray
    n_iter: int
    residual: float


def fit_nystrom(
    between, blocks, n_rows, *, C, bias, n_landmarks, length, tol, max_iter, random_state, n_jobs=None
):
    r"""Fit on landmarks by conjugate gradients.

    Parameters
    ----------
    between : callable
        ``between(A, B)`` is the kernel matrix of the rows of two arrays.
    blocks : iterable
        Of `passes.Passes`.
    n_rows : int
        About as many rows as there are.
    C : float
    bias : {"free", "regularized", "none"}
    n_landmarks : int
    length : float or None
        In which the kernel falls; None where it is no function of the distance.
    tol : float
        Of the residual.
    max_iter : int
    random_state : RandomState
    n_jobs : int, default=None

    Returns
    -------
    found : Nystrom

    Notes
    -----
    With :math:`K_{mm} = L L^T` the function is :math:`f = K_{nm} L^{-T} \theta + b`, and

    .. math:: \Bigl(\sum_i w_i z_i z_i^T + I / C\Bigr) \theta = \sum_i w_i z_i (y_i - b), \quad
        z = L^{-1} k_m(x)

    is well conditioned where the same equations for the weights themselves lose all digits. The coarse copy
    holds the weighted means of the rows in the cells of a grid.

    References
    ----------
    .. [1] A. Rudi, L. Carratino, L. Rosasco, FALKON: an optimal large scale kernel method, NIPS 2017.
    """
    many = max(_PASSES * n_rows // n_landmarks, _FEWEST_PER_LANDMARK * n_landmarks)
    passes = Passes(between, blocks)
    sample, n, copy = passes.looked_at(
        most=min(max(_PER_LANDMARK, _DRAWN_PER_LANDMARK) * n_landmarks, _MOST_SEARCHED),
        length=length,
        most_cells=min(many, _MOST_CELLS),
        random_state=random_state,
    )
    landmarks = _landmarks(between, sample[0], n_landmarks, random_state, n_jobs)
    L = _factor(between(landmarks, landmarks))
    with own_threads(n_jobs) as run:
        system = _System(run, between, passes, landmarks, L, C, bias)
        coarse = sample if copy is None else copy
        scale = n / coarse[2].sum() if copy is None else 1.0
        precondition, theta = system.solved_for(*coarse[:2], scale * coarse[2])
        residual = system.residual(theta)
        theta, n_iter, left = _iterated(system, precondition, theta, residual, tol, max_iter)
    alpha = solve_triangular(L, theta[:-1], lower=True, trans=1, check_finite=False)
    return Nystrom(landmarks, alpha, theta[-1], n_iter, left)


def _factor(own, jitters=_JITTERS):
    """Lower factor of a matrix of the landmarks, which is semidefinite but for rounding."""
    diagonal = np.einsum("ii->i", own)
    plain, size = diagonal.copy(), float(diagonal.mean())
    for jitter in jitters:
        diagonal[:] = plain + jitter * size
        factor, failed = dpotrf(own, lower=1, clean=1)
        if not failed and np.isfinite(factor).all():
            return factor
    raise ValueError(
        "The kernel matrix of the landmarks is not positive semidefinite: it is no kernel; use a kernel that "
        "is one, or solver='cholesky'."
    )


def _landmarks(between, X, many, random_state, n_jobs):
    X = np.unique(X, axis=0)
    X = X[random_state.permutation(len(X))[: _PER_LANDMARK * many]]
    diagonal = kernel_diagonal(between, X)
    _, pivots, _ = pivoted_cholesky(
        between, X, diagonal, rank=many, left=0.0, random_state=random_state, n_jobs=n_jobs
    )
    return X[pivots]


class _System:
    """Equations of the weights in the landmarks' own coordinates, the bias behind them."""

    def __init__(self, run, between, passes, landmarks, L, C, bias):
        self._run, self._between, self._passes = run, between, passes
        self._landmarks, self._L, self._bias = landmarks, L, bias
        self._penalty = np.full(len(L) + 1, 1.0 / C)
        # only a regularized bias costs anything; one that is none stays zero
        self._penalty[-1] = 1.0 / C if bias == "regularized" else 0.0

    def _inward(self, sums):
        sums[:-1] = solve_triangular(self._L, sums[:-1], lower=True, check_finite=False)
        return sums

    def _outward(self, theta):
        return solve_triangular(self._L, theta[:-1], lower=True, trans=1, check_finite=False), theta[-1]

    def _fixed(self, vector):
        if self._bias == "none":
            vector[-1] = 0.0
        return vector

    def residual(self, theta):
        """Right side less the product with an approximate solution, in one pass."""
        sums = self._sums(theta, with_targets=True)
        return self._fixed(self._inward(sums) - self._penalty[:, None] * theta)

    def apply(self, theta):
        """Product with the matrix of the equations, in one pass."""
        return self._fixed(
            self._penalty[:, None] * theta - self._inward(self._sums(theta, with_targets=False))
        )

    def _sums(self, theta, with_targets):
        return self._passes.sums(self._run, self._landmarks, *self._outward(theta), with_targets=with_targets)

    def solved_for(self, X, y, weight):
        """Inverse of the equations that some weighted rows make, and their solution."""
        m = len(self._L)
        matrix, right = np.zeros((m + 1, m + 1)), np.zeros((m + 1, y.shape[1]))
        step = max(32, 4 * _BLOCK // m)
        turns = Turns([slice(start, start + step) for start in range(0, len(X), step)])
        parts = [(np.zeros_like(matrix), np.zeros_like(right)) for _ in range(self._run.many)]

        def work(k):
            own, sums = parts[k]
            for rows in turns:
                root = np.sqrt(weight[rows])
                z = solve_triangular(
                    self._L, self._between(self._landmarks, X[rows]), lower=True, check_finite=False
                )
                z = np.vstack([z, np.ones(z.shape[1])]) * root
                own += z @ z.T
                sums += z @ (root[:, None] * y[rows])

        self._run(work)
        for own, sums in parts:
            matrix += own
            right += sums
        matrix[np.diag_indices_from(matrix)] += self._penalty
        if self._bias == "none":
            matrix[-1], matrix[:, -1], right[-1] = 0.0, 0.0, 0.0
            matrix[-1, -1] = 1.0
        # with a ridge below rounding the factor is one of a matrix nearby, good enough to lead the way
        inverse = _factor(matrix, (0.0, *_JITTERS)), True

        def precondition(vector):
            return cho_solve(inverse, vector, check_finite=False)

        return precondition, precondition(right)


def _iterated(system, precondition, theta, residual, tol, max_iter):
    """Preconditioned conjugate gradients for each target."""
    step = precondition(residual)
    slope = np.einsum("ij,ij->j", residual, step)
    # of the whole: the norm of the solution itself
    whole = np.maximum(np.einsum("ij,ij->j", theta, system.apply(theta)), np.finfo(float).tiny)
    n_iter = 0
    while n_iter < max_iter and np.sqrt((slope / whole).max()) > tol:
        along = system.apply(step)
        length = slope / np.maximum(np.einsum("ij,ij->j", step, along), np.finfo(float).tiny)
        theta = theta + length * step
        residual = residual - length * along
        better = precondition(residual)
        before, slope = slope, np.einsum("ij,ij->j", residual, better)
        step = better + slope / np.maximum(before, np.finfo(float).tiny) * step
        n_iter += 1
    return theta, n_iter, float(np.sqrt((slope / whole).max()))
