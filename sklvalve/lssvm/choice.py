# SPDX-License-Identifier: BSD-3-Clause
"""Which exact solver for how many rows, within how much memory, and what to do where it fails."""

import os
import warnings
from contextlib import nullcontext

import numpy as np
from scipy.linalg import LinAlgWarning
from scipy.linalg.blas import dsymm

from sklvalve.lssvm.dense import solve_lssvm
from sklvalve.lssvm.kernels import kernel_diagonal, lower_gram
from sklvalve.lssvm.large import rank_for, solve_pcg, solve_tiled, warn_of_residual
from sklvalve.lssvm.products import KernelBlocks, kernel_product
from sklvalve.lssvm.solvers import LAPACK_ROWS, relative, right_sides
from sklvalve.lssvm.threads import one_blas_thread

#: Solvers, "auto" aside.
SOLVERS = ("cholesky", "tiled", "pcg", "nystrom")
# beyond so many rows no exact solution is tried unless it is asked for
_EXACT_ROWS = 100_000
# so few rows are done before two threads have agreed on who does what, and much earlier on a busy machine
_ALONE = 1200
# of the memory that is free
_OF_FREE = 0.6
# rows whose equations are looked at after a factorisation that gave no reason to doubt it
_LOOKED_AT = 64


def memory_to_use(max_memory):
    """Bytes that a fit may take."""
    if max_memory is not None:
        return float(max_memory)
    try:
        return _OF_FREE * os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError, AttributeError):
        return 4e9


def solver_for(n, memory, *, matrix_given):
    """The solver that "auto" begins with.

    Parameters
    ----------
    n : int
        Rows.
    memory : float
        Bytes that may be taken.
    matrix_given : bool
        Whether the kernel matrix itself is given, so that it is there anyway.

    Returns
    -------
    name : str
        Of `SOLVERS`.
    """
    if n <= LAPACK_ROWS and 8.0 * n**2 <= memory:
        return "cholesky"
    if matrix_given:
        return "tiled"
    return "pcg" if n <= _EXACT_ROWS and _of_pcg(n) <= memory else "nystrom"


def _of_pcg(n):
    return 8.0 * n * (rank_for(n) + 40.0)


def _of_tiles(n):
    return 4.4 * n**2


class Machine:
    """One LS-SVM to be solved exactly: rows, kernel and what the equations are to meet.

    Parameters
    ----------
    between : callable or None
        Kernel matrix of the rows of two arrays; None where `matrix` is given.
    X : ndarray of shape (n, d) or None
    matrix : ndarray of shape (n, n) or None
    memory : float
        Bytes that may be taken.
    options : dict
        ``bias``, ``tol``, ``max_iter``, ``random_state``, ``n_jobs``.
    """

    def __init__(self, between, X, matrix, *, memory, options):
        self._between, self._X, self._matrix = between, X, matrix
        self._memory, self._options = memory, options
        self._n = len(X) if matrix is None else len(matrix)

    def solved(self, solver, y, ridge):
        """Dual solution by a solver, or by what takes its place, and the name of that.

        Parameters
        ----------
        solver : {"auto", "cholesky", "tiled", "pcg"}
        y : ndarray of shape (n, n_targets)
        ridge : ndarray of shape (n,)

        Returns
        -------
        dual : Dual
        solver : str
        """
        few = one_blas_thread() if self._n <= _ALONE else nullcontext()
        with few, np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            ways = {"cholesky": self._cholesky, "tiled": self._tiled, "pcg": self._pcg}
            if solver == "auto":
                solver = solver_for(self._n, self._memory, matrix_given=self._matrix is not None)
                ways["pcg"] = self._pcg_or_else
            return ways[solver](y, ridge)

    def _cholesky(self, y, ridge):
        found = solve_lssvm(self._gram, self._product, y, ridge, bias=self._options["bias"])
        if found.residual is None:
            some = np.unique(np.linspace(0, self._n - 1, _LOOKED_AT).astype(int))
            alpha, (shift, _) = found.alpha, right_sides(y, ridge, self._options["bias"])
            left = self._product_of(some, alpha) + ridge[some, None] * alpha[some] + found.b - y[some]
            found.residual = relative(left, y - shift)
        if found.residual > self._options["tol"] and not found.told:
            warn_of_residual(found.residual)
        return found, "cholesky"

    def _tiled(self, y, ridge):
        more = {k: self._options[k] for k in ("bias", "tol", "n_jobs")}
        dual = solve_tiled(self._blocks(), y, ridge, **more)
        if dual is not None:
            return dual, "tiled"
        if self._n > LAPACK_ROWS:
            raise ValueError(
                "The kernel matrix plus 1/C on its diagonal is not positive definite, or not finite: it is "
                "no kernel, X is too large for it, or C is; scale X, lower C, or merge repeated rows into "
                "one with their weight."
            )
        return self._cholesky(y, ridge)

    def _pcg(self, y, ridge):
        dual = self._by_gradients(y, ridge)
        if dual.residual > self._options["tol"]:
            warn_of_residual(dual.residual)
        return dual, "pcg"

    def _pcg_or_else(self, y, ridge):
        """Conjugate gradients, and a factorisation where they stall and there is room for it."""
        too_many = _of_tiles(self._n) > self._memory
        dual = self._by_gradients(y, ridge, patient=too_many)
        if dual.residual <= self._options["tol"]:
            return dual, "pcg"
        if too_many:
            why = f"a factorisation needs {_of_tiles(self._n) / 1e9:.1f} GB: raise max_memory"
        else:
            try:
                return self._tiled(y, ridge)
            except ValueError:
                why = "the matrix has no factor: merge repeated rows into one with their weight"
        warnings.warn(
            f"The LS-SVM equations are met only to {dual.residual:.1e} of the target after {dual.n_iter} "
            f"steps, and {why}, lower C, make the kernel smoother, or use solver='nystrom'.",
            LinAlgWarning,
            stacklevel=4,
        )
        return dual, "pcg"

    def _by_gradients(self, y, ridge, *, patient=True):
        names = ("bias", "tol", "max_iter", "random_state", "n_jobs")
        more = {k: self._options[k] for k in names}
        rank = max(1, int(self._memory / (8.0 * self._n)) - 40)
        return solve_pcg(
            self._between,
            self._blocks(),
            self._X,
            kernel_diagonal(self._between, self._X),
            y,
            ridge,
            rank=rank,
            patient=patient,
            **more,
        )

    def _gram(self):
        if self._matrix is not None:
            return np.array(self._matrix, order="F")
        return lower_gram(self._between, self._X)

    def _product(self, v):
        if self._matrix is not None:
            # of a given matrix only the lower triangle counts, which is the upper one of its transpose
            return dsymm(1.0, self._matrix.T, np.asfortranarray(v), lower=0)
        return kernel_product(self._between, self._X, self._X, v)

    def _product_of(self, rows, v):
        if self._matrix is None:
            return self._between(self._X[rows], self._X) @ v
        # of a given matrix only the lower triangle counts
        block = self._matrix[rows]
        later = np.arange(self._n) > rows[:, None]
        return np.where(later, self._matrix[:, rows].T, block) @ v

    def _blocks(self):
        if self._matrix is None:
            return KernelBlocks(self._between, self._X, self._X)
        return self._block_given

    def _block_given(self, rows, columns):
        block = self._matrix[rows, columns].copy()
        if rows == columns:
            block = np.tril(block)
            block += np.tril(block, -1).T
        return block
