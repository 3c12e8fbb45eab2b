# SPDX-License-Identifier: BSD-3-Clause
"""The whole system of an LS-SVM by conjugate gradients, with a kernel matrix that is never stored."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve

from sklvalve.lssvm.solvers import factor_of, relative

# steps after which it is asked whether the rest is worth waiting for
_LOOK_AFTER = 8


class LowRankPreconditioner:
    r"""Inverse of F F^T + diag(ridge) by the identity of Woodbury.

    Parameters
    ----------
    F : ndarray of shape (n, r)
        Overwritten.
    ridge : ndarray of shape (n,)
    """

    def __init__(self, F, ridge):
        self._scale = 1.0 / np.sqrt(ridge)
        F *= self._scale[:, None]
        inner = F.T @ F
        inner[np.diag_indices_from(inner)] += 1.0
        self._scaled, self._inner = F, (factor_of(inner), True)

    def __call__(self, v):
        v = self._scale[:, None] * v
        v -= self._scaled @ cho_solve(self._inner, self._scaled.T @ v, check_finite=False)
        return self._scale[:, None] * v


@dataclass
class Solved:
    """Solution of some right sides, what is left of each equation, and steps taken.

    Attributes
    ----------
    x, residual : ndarray of shape (n, m)
    n_iter : int
    """

    x: np.ndarray
    residual: np.ndarray
    n_iter: int


def gradient_steps(apply, precondition, x, residual):
    """Preconditioned conjugate gradients, for each of some right sides, without an end.

    Parameters
    ----------
    apply : callable
        Product of a symmetric positive definite matrix with an array of shape (n, m).
    precondition : callable
        As good as its inverse.
    x, residual : ndarray of shape (n, m)
        Solution to begin with, and right side less the product with it.

    Yields
    ------
    x, residual : ndarray of shape (n, m)
        As they are to begin with, and after each step.
    slope : ndarray of shape (m,)
        Squared norm of the residual in the preconditioner.
    """
    step = precondition(residual)
    slope = np.einsum("ij,ij->j", residual, step)
    while True:
        yield x, residual, slope
        along = apply(step)
        length = slope / np.maximum(np.einsum("ij,ij->j", step, along), np.finfo(float).tiny)
        x = x + length * step
        residual = residual - length * along
        better = precondition(residual)
        before, slope = slope, np.einsum("ij,ij->j", residual, better)
        step = better + slope / np.maximum(before, np.finfo(float).tiny) * step


def conjugate_gradients(apply, precondition, right, *, tol, max_iter, patient=True):
    """Solve a symmetric positive definite system for some right sides at once.

    Parameters
    ----------
    apply, precondition : callable
        As in `gradient_steps`.
    right : ndarray of shape (n, m)
    tol : float
        Largest residual of any equation, relative to the largest entry of its right side.
    max_iter : int
    patient : bool, default=True
        Otherwise it is given up where the first steps say that so many will not do.

    Returns
    -------
    solved : Solved
    """
    start = np.zeros_like(right)
    best, lowest = start, np.inf
    for n_iter, (x, residual, slope) in enumerate(gradient_steps(apply, precondition, start, right)):
        now = relative(residual, right)
        if now < lowest:
            best, lowest = x, now
        if lowest <= tol or n_iter == max_iter or not np.isfinite(slope).all():
            break
        if n_iter == _LOOK_AFTER and not patient and _hopeless(lowest, tol, n_iter, max_iter):
            break
    # what was added up step by step drifts from the truth
    return Solved(best, right - apply(best), n_iter)


def _hopeless(lowest, tol, steps, most):
    """Whether at the pace so far, from a residual of one on, the tolerance is out of reach."""
    return -np.log(lowest) * (most - steps) < steps * np.log(lowest / tol)
