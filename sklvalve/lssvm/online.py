# SPDX-License-Identifier: BSD-3-Clause
"""An LS-SVM to which rows are added as they come, and which forgets them but for what they say.

What is kept are the sums of the equations of some landmarks. New rows that these do not span become landmarks
themselves. For the rows before such a one, its coordinate is taken to be zero; its square is at most what
those rows lacked then, and that was little, for they had been spanned.
"""

import numpy as np
from scipy.linalg import cho_solve

from sklvalve.lssvm.kernels import kernel_diagonal
from sklvalve.lssvm.nystrom import inward, normal_equations, outward, penalized, penalty_of
from sklvalve.lssvm.pivoted import pivoted_cholesky
from sklvalve.lssvm.solvers import factor_of
from sklvalve.lssvm.threads import own_threads

# of the ridge 1 / (C w): what may lack of a row that counts as spanned, and as well spanned; for the latter
# not more than half of the landmarks that are left are given away, for rows that are yet to come
_SPANNED, _WELL_SPANNED = 1e-2, 1e-4


def nothing_seen(n_features, n_targets):
    """Sums over no rows, of no landmarks.

    Returns
    -------
    state : dict of ndarray
        ``landmarks`` of shape (m, n_features), ``L`` the lower factor of their kernel matrix, ``matrix`` and
        ``right`` of `nystrom.normal_equations`.
    """
    return {
        "landmarks": np.zeros((0, n_features)),
        "L": np.zeros((0, 0)),
        "matrix": np.zeros((1, 1)),
        "right": np.zeros((1, n_targets)),
    }


def with_rows(state, between, X, y, weight, *, C, n_landmarks, random_state, n_jobs=None):
    """Sums with some more rows, and a share of them.

    Parameters
    ----------
    state : dict
        Of `nothing_seen`, or of this function.
    between : callable
    X, y, weight : ndarray of shape (n, d), (n, n_targets) and (n,)
        In the coordinates of the kernel.
    C : float
    n_landmarks : int
        At most.
    random_state : RandomState
    n_jobs : int, default=None

    Returns
    -------
    state : dict
        A new one.
    lacking : float
        What the landmarks do not span of these rows, of all that there is to be spanned.
    """
    known = weight > 0.0
    X, y, weight = X[known], y[known], weight[known]
    if not len(X):
        return state, 0.0
    ridge = len(X) / (C * weight.max())
    state, lacking = _with_landmarks(state, between, X, ridge, n_landmarks, random_state, n_jobs)
    with own_threads(n_jobs) as run:
        matrix, right = normal_equations(run, between, state["landmarks"], state["L"], X, y, weight)
    return state | {"matrix": state["matrix"] + matrix, "right": state["right"] + right}, lacking


def solution_of(state, *, C, bias):
    """Weights of the landmarks, biases, and what is left of the equations, relative to their right side.

    Returns
    -------
    alpha : ndarray of shape (m, n_targets)
    b : ndarray of shape (n_targets,)
    residual : float
    """
    matrix, right = state["matrix"].copy(), state["right"].copy()
    inverse = penalized(matrix, right, penalty_of(len(state["L"]), C, bias), bias)
    theta = cho_solve(inverse, right, check_finite=False)
    left = np.abs(right - matrix @ theta).max()
    return *outward(state["L"], theta), float(left / max(np.abs(right).max(), np.finfo(float).tiny))


def _with_landmarks(state, between, X, ridge, n_landmarks, random_state, n_jobs):
    """State with landmarks among the rows of X where those that are there do not span them."""
    landmarks, L = state["landmarks"], state["L"]
    many, whole = len(landmarks), kernel_diagonal(between, X)

    def rest_between(A, B):
        values = between(A, B)
        if many:
            values -= inward(between, landmarks, L, A)[:-1].T @ inward(between, landmarks, L, B)[:-1]
        return values

    lacks = whole.copy()
    if many:
        lacks -= np.square(inward(between, landmarks, L, X)[:-1]).sum(axis=0)
    lacks, free = np.maximum(lacks, 0.0), n_landmarks - many
    for rank, share in (((free + 1) // 2, _WELL_SPANNED), (free, _SPANNED)):
        left = share * ridge
        more = {"random_state": random_state, "n_jobs": n_jobs}
        _, pivots, rest = pivoted_cholesky(rest_between, X, lacks, rank=rank, left=left, **more)
        if rest <= _SPANNED * ridge:
            break
    if not many and not len(pivots):
        # one at least, however little it is worth
        pivots = np.argmax(lacks)[None]
    if len(pivots):
        new = X[pivots]
        corner = np.zeros((many + len(new),) * 2)
        corner[:many, :many] = L
        if many:
            corner[many:, :many] = inward(between, landmarks, L, new)[:-1].T
        corner[many:, many:] = factor_of(rest_between(new, new))
        state = state | {
            "landmarks": np.concatenate([landmarks, new]),
            "L": corner,
            "matrix": _padded(state["matrix"], many, len(new)),
            "right": np.insert(state["right"], many, np.zeros((len(new), 1)), axis=0),
        }
    return state, float(rest / whole.sum()) if rest > _SPANNED * ridge else 0.0


def _padded(matrix, at, many):
    """A matrix with zero rows and columns put in before the last one."""
    wide = np.zeros((len(matrix) + many,) * 2)
    old = np.r_[0:at, at + many]
    wide[np.ix_(old, old)] = matrix
    return wide
