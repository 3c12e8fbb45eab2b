# SPDX-License-Identifier: BSD-3-Clause
"""An LS-SVM whose function is spanned by few of the rows, for as many rows as there are.

The rows are read in passes, and never stored as kernel values. A system that a coarse copy of the data makes
is so near to the true one that a handful of passes is enough.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve, solve_triangular

from sklvalve.lssvm.cells import SIDE
from sklvalve.lssvm.conjugate import gradient_steps
from sklvalve.lssvm.kernels import kernel_diagonal
from sklvalve.lssvm.pivoted import pivoted_cholesky
from sklvalve.lssvm.solvers import JITTERS, factor_of
from sklvalve.lssvm.threads import Turns, own_threads

# landmarks are sought among so many rows for each, and no more than that
_PER_LANDMARK, _MOST_SEARCHED = 20, 40_000
# cells, or drawn rows, of the coarse copy: its factor may cost what a few passes over all rows do
_MOST_CELLS, _FEWEST_PER_LANDMARK, _PASSES = 60_000, 5, 150
_DRAWN_PER_LANDMARK = 30
_BLOCK = 2**17


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
    uneven : float
        The heaviest weight over the middle one.
    """

    landmarks: np.ndarray
    alpha: np.ndarray
    b: np.ndarray
    n_iter: int
    residual: float
    uneven: float


def fit_nystrom(passes, *, C, bias, n_landmarks, length, tol, max_iter, random_state, n_jobs=None):
    r"""Fit on landmarks by conjugate gradients.

    Parameters
    ----------
    passes : passes.Passes
        Or what makes its sums elsewhere.
    C : float
    bias : {"free", "regularized", "none"}
    n_landmarks : int
        At most; repeated rows are no landmarks.
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
    .. [1] Rudi, A., L. Carratino, L. Rosasco, FALKON: an optimal large scale kernel method, NIPS 2017.
    """
    look = passes.look(
        most=min(_DRAWN_PER_LANDMARK * n_landmarks, _MOST_SEARCHED),
        side=None if length is None else SIDE * length,
        most_cells=_MOST_CELLS,
        seed=random_state.randint(2**31 - 1),
    )
    sample, between = look.sample(), passes.between
    n_landmarks = min(n_landmarks, look.rows)
    copy = look.copy(max(_PASSES * look.rows // n_landmarks, _FEWEST_PER_LANDMARK * n_landmarks))
    landmarks = chosen_landmarks(between, sample[0], n_landmarks, random_state, n_jobs)
    L = factor_of(between(landmarks, landmarks))
    coarse = sample if copy is None else copy
    scale = look.weight / coarse[2].sum() if copy is None else 1.0
    with own_threads(n_jobs) as run:
        system = _System(run, passes, landmarks, L, C, bias)
        precondition, theta = system.solved_for(*coarse[:2], scale * coarse[2])
        theta, n_iter, left = _iterated(system, precondition, theta, tol, max_iter)
    return Nystrom(landmarks, *outward(L, theta), n_iter, left, look.heaviest / np.median(sample[2]))


def chosen_landmarks(between, X, many, random_state, n_jobs=None):
    """At most so many different rows that span what the kernel makes of all, in the coordinates of it."""
    X = np.unique(X, axis=0)
    X = X[random_state.permutation(len(X))[: _PER_LANDMARK * many]]
    diagonal = kernel_diagonal(between, X)
    _, pivots, _ = pivoted_cholesky(
        between, X, diagonal, rank=many, left=0.0, random_state=random_state, n_jobs=n_jobs
    )
    # one at least, also where the kernel is zero
    return X[pivots] if len(pivots) else X[:1]


def normal_equations(run, between, landmarks, L, X, y, weight):
    """Sums of weight z z^T and of weight z y over some rows, with z = L^-1 k of the landmarks and a one.

    Parameters
    ----------
    run : callable
        Of `threads.own_threads`.
    between : callable
    landmarks : ndarray of shape (m, d)
    L : ndarray of shape (m, m)
        Lower factor of the kernel matrix of the landmarks.
    X, y, weight : ndarray of shape (n, d), (n, n_targets) and (n,)

    Returns
    -------
    matrix : ndarray of shape (m + 1, m + 1)
    right : ndarray of shape (m + 1, n_targets)
    """
    m = len(L)
    parts = [(np.zeros((m + 1, m + 1)), np.zeros((m + 1, y.shape[1]))) for _ in range(run.many)]
    turns = Turns(row_spans(len(X), m))

    def work(k):
        own, sums = parts[k]
        for rows in turns:
            root = np.sqrt(weight[rows])
            z = inward(between, landmarks, L, X[rows]) * root
            own += z @ z.T
            sums += z @ (root[:, None] * y[rows])

    run(work)
    return tuple(np.sum(column, axis=0) for column in zip(*parts, strict=True))


def row_spans(n, m):
    """Slices of n rows that are worth one product with so many landmarks."""
    step = max(32, 4 * _BLOCK // max(1, m))
    return [slice(start, min(start + step, n)) for start in range(0, n, step)]


def inward(between, landmarks, L, X):
    """Coordinates z of some rows, a one behind them, of shape (m + 1, n)."""
    z = solve_triangular(L, between(landmarks, X), lower=True, check_finite=False)
    return np.vstack([z, np.ones(z.shape[1])])


def outward(L, theta):
    """Weights of the landmarks, and the bias, from the solution in their own coordinates."""
    return solve_triangular(L, theta[:-1], lower=True, trans=1, check_finite=False), theta[-1]


def penalty_of(m, C, bias):
    """What the weights cost in their own coordinates; only a regularized bias costs anything."""
    return np.append(np.full(m, 1.0 / C), 1.0 / C if bias == "regularized" else 0.0)


def penalized(matrix, right, penalty, bias):
    """Factor of equations with their penalty, as `cho_solve` takes it; a bias of none stays zero."""
    matrix[np.diag_indices_from(matrix)] += penalty
    if bias == "none":
        matrix[-1], matrix[:, -1], right[-1] = 0.0, 0.0, 0.0
        matrix[-1, -1] = 1.0
    # with a ridge below rounding the factor is one of a matrix nearby, good enough to lead the way
    return factor_of(matrix, (0.0, *JITTERS)), True


class _System:
    """Equations of the weights in the landmarks' own coordinates, the bias behind them."""

    def __init__(self, run, passes, landmarks, L, C, bias):
        self._run, self._passes = run, passes
        self._landmarks, self._L, self._bias = landmarks, L, bias
        self._penalty = penalty_of(len(L), C, bias)

    def residual(self, theta):
        """Right side less the product with an approximate solution, in one pass."""
        return self._fixed(self._sums(theta, with_targets=True) - self._penalty[:, None] * theta)

    def apply(self, theta):
        """Product with the matrix of the equations, in one pass."""
        return self._fixed(self._penalty[:, None] * theta - self._sums(theta, with_targets=False))

    def solved_for(self, X, y, weight):
        """Inverse of the equations that some weighted rows make, and their solution."""
        between = self._passes.between
        matrix, right = normal_equations(self._run, between, self._landmarks, self._L, X, y, weight)
        inverse = penalized(matrix, right, self._penalty, self._bias)

        def precondition(vector):
            return cho_solve(inverse, vector, check_finite=False)

        return precondition, precondition(right)

    def _sums(self, theta, with_targets):
        function = outward(self._L, theta)
        sums = self._passes.sums(self._run, self._landmarks, *function, with_targets=with_targets)
        sums[:-1] = solve_triangular(self._L, sums[:-1], lower=True, check_finite=False)
        return sums

    def _fixed(self, vector):
        if self._bias == "none":
            vector[-1] = 0.0
        return vector


def _iterated(system, precondition, theta, tol, max_iter):
    """Conjugate gradients until little is left of every target, in the norm of the preconditioner."""
    residual = system.residual(theta)
    # of the whole: the norm of the solution itself
    whole = np.maximum(np.einsum("ij,ij->j", theta, system.apply(theta)), np.finfo(float).tiny)
    best, least = theta, np.inf
    for n_iter, (found, _, slope) in enumerate(gradient_steps(system.apply, precondition, theta, residual)):
        left = float(np.sqrt((slope / whole).max()))
        if left < least:
            best, least = found, left
        if not left > tol or n_iter == max_iter:
            return best, n_iter, least
