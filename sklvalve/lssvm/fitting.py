# SPDX-License-Identifier: BSD-3-Clause
"""How an LS-SVM is fitted, by where its rows are: in arrays, in blocks, on a cluster, or yet to come."""

import warnings

import numpy as np
from sklearn.utils import check_random_state
from sklearn.utils.validation import validate_data

from sklvalve._refits import whole_or_nothing
from sklvalve.lssvm.choice import Machine, memory_to_use, solver_for
from sklvalve.lssvm.distributed import DaskPasses, moments_of_parts, parts_of
from sklvalve.lssvm.kernels import WITH_GAMMA, kernel_length
from sklvalve.lssvm.large import warn_of_residual
from sklvalve.lssvm.nystrom import chosen_landmarks, fit_nystrom
from sklvalve.lssvm.online import nothing_seen, solution_of, with_rows
from sklvalve.lssvm.passes import Passes
from sklvalve.lssvm.products import as_right
from sklvalve.lssvm.robust import trust
from sklvalve.lssvm.rows import (
    ArrayBlocks,
    GivenBlocks,
    Move,
    MovedBlocks,
    as_columns,
    begin,
    merged,
    middle_of,
    raise_unless_usable,
    raise_unless_weighed,
    unit_of,
    weight_of,
)
from sklvalve.lssvm.scale import gamma_of_scale, moments
from sklvalve.lssvm.solvers import raise_unless_finite
from sklvalve.lssvm.spread import fit_spread

# the approximation's own error is far above this, whatever the tolerance of an exact solution
_NYSTROM_TOLERANCE = 100.0
# of what there is to be spanned; less than this is no loss
_LACKING = 1e-4
# weights that span more than this hide the light rows from the norm in which landmarks are fitted
_UNEVEN = 1e5
# where C is larger, rows that repeat each other spoil the equations and are made one
_MERGED = 1e8
# parameters that say which function was fitted, and how far it may be from new targets
_OF_THE_FUNCTION = ("kernel", "gamma", "degree", "coef0", "kernel_params", "bias", "C")


class Fitting:
    """The ways of `fit`, `fit_blocks` and `partial_fit` of :class:`~sklvalve.lssvm.LSSVMRegressor`."""

    @whole_or_nothing
    def with_solution(self, X_fit, dual_coef, intercept):
        """Take a solution that is known already, from plain data for example, in place of a fit.

        Parameters
        ----------
        X_fit : array-like of shape (n_fit, n_features)
        dual_coef : array-like of shape (n_fit,) or (n_fit, n_targets)
        intercept : float or array-like of shape (n_targets,)
            `X_fit_`, `dual_coef_` and `intercept_` of a machine of the same kernel and bias.

        Returns
        -------
        self : LSSVMRegressor

        Raises
        ------
        ValueError
            If there are not as many weights as rows, or gamma is "scale".
        """
        X_fit, dual_coef = np.asarray(X_fit, dtype=np.float64), np.asarray(dual_coef, dtype=np.float64)
        if X_fit.ndim != 2 or len(X_fit) != len(dual_coef):
            raise ValueError(
                f"X_fit and dual_coef must have as many rows, got {X_fit.shape} and {dual_coef.shape}."
            )
        if self._scales():
            raise ValueError("gamma='scale' needs the rows of a fit; set gamma to the number that it gave.")
        self._begin_anew()
        self.n_features_in_, self.offset_ = X_fit.shape[1], middle_of(X_fit, self.kernel, self.bias)
        alpha = as_columns(dual_coef)
        self._store(alpha, np.zeros(alpha.shape[1]), self._coordinates()(X_fit), dual_coef.ndim == 1)
        self.X_fit_ = X_fit
        self.intercept_ = float(intercept) if dual_coef.ndim == 1 else np.asarray(intercept, dtype=np.float64)
        return self

    def _fit_arrays(self, X, y, sample_weight):
        if self.kernel == "precomputed":
            self._refuse("A precomputed kernel", "uncertainty")
        weight = weight_of(self.C, sample_weight, X)
        raise_unless_weighed(weight.any())
        self._begin_anew(lambda: [moments(rows, w) for rows, _, w in ArrayBlocks(X, X, weight)])
        targets, single, counts = as_columns(y), y.ndim == 1, weight
        self._fit_weighted(X, targets, counts, single)
        for _ in range(self.robust_passes):
            trusted = self._trusted(X, targets, counts, weight)
            counts = weight * trusted
            self._fit_weighted(X, targets, counts, single)
            self.robust_weight_ = trusted
        if self.uncertainty:
            self._learn_spread(ArrayBlocks(X, targets, counts), single)
        return self

    def _fit_given(self, blocks):
        raise_unless_usable(self.C)
        given = GivenBlocks(blocks, self)
        self._begin_anew(lambda: [moments(rows, w) for rows, _, w in given])
        move = self._move_by(given)
        self._by_landmarks(Passes(self._between(), MovedBlocks(given, move)), move, given.single)
        if self.uncertainty:
            self._learn_spread(given, given.single)
        return self

    def _fit_dask(self, X, y, sample_weight):
        self._refuse("A Dask collection", "robust_passes", "uncertainty")
        raise_unless_usable(self.C)
        parts, lengths = parts_of(X, y, sample_weight)
        head = X.get_partition(0) if hasattr(X, "get_partition") else X.blocks[0]
        validate_data(self, head.compute(), dtype=np.float64, ensure_min_samples=0)
        self._begin_anew(lambda: moments_of_parts(parts))
        move = self._move_by(part.compute() for part in parts)
        return self._by_landmarks(DaskPasses(self._between(), parts, lengths, move), move, y.ndim == 1)

    def _fit_more(self, X, y, sample_weight):
        seen = getattr(self, "_seen_", None)
        X, y = validate_data(
            self, X, y, dtype=np.float64, multi_output=True, y_numeric=True, reset=seen is None
        )
        weight, single = weight_of(self.C, sample_weight, X), y.ndim == 1
        if seen is None:
            self._begin_anew(lambda: [moments(X, weight)])
            move = self._move_by([(X, as_columns(y), weight)])
            seen = nothing_seen(X.shape[1], len(move.shift)) | {"shift": move.shift, "unit": move.unit}
        elif (y.ndim == 1) != (self.dual_coef_.ndim == 1) or as_columns(y).shape[1] != len(seen["shift"]):
            raise ValueError(
                f"y has the shape {y.shape}, before it had {len(seen['shift'])} target(s) a row."
            )
        move = Move(self._coordinates(), seen["shift"], seen["unit"])
        more = {name: getattr(self, name) for name in ("C", "n_landmarks", "n_jobs")}
        more["random_state"] = check_random_state(self.random_state)
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            seen, lacking = with_rows(seen, self._between(), *move((X, as_columns(y), weight)), **more)
        if lacking > _LACKING:
            warnings.warn(
                f"The {len(seen['landmarks'])} landmarks leave {lacking:.1e} of the kernel of the new rows "
                "unspanned; raise n_landmarks and begin anew with rows of all kinds, or use fit.",
                UserWarning,
                stacklevel=5,
            )
        alpha, b, residual = solution_of(seen, C=self.C, bias=self.bias)
        alpha, b = _in_unit(move.unit, alpha), _in_unit(move.unit, b, move.shift)
        self._store(alpha, b, seen["landmarks"], single)
        self.solver_, self.n_iter_, self.residual_, self._seen_ = "online", 1, residual, seen
        return self

    def _fit_weighted(self, X, targets, weight, single):
        rows, memory = weight > 0.0, memory_to_use(self.max_memory)
        if self.kernel == "precomputed":
            return self._fit_matrix(X, targets, weight, single, memory)
        solver = self.solver
        if solver == "auto" and solver_for(rows.sum(), memory, matrix_given=False) == "nystrom":
            solver = "nystrom"
        if solver == "nystrom":
            blocks = ArrayBlocks(X, targets, weight)
            move = self._move_by(blocks)
            return self._by_landmarks(Passes(self._between(), MovedBlocks(blocks, move)), move, single)
        kept, targets, weight = (column if rows.all() else column[rows] for column in (X, targets, weight))
        if self.C * weight.max() > _MERGED:
            kept, targets, weight = merged(kept, targets, weight)
        self.offset_ = middle_of(kept, self.kernel, self.bias)
        Z = self._coordinates()(kept)
        alpha, b = self._solved(Machine(self._between(), Z, None, **self._limits(memory)), targets, weight)
        self._store(alpha, b, Z, single)
        self.X_fit_ = kept.astype(np.float64)
        return self

    def _fit_matrix(self, X, targets, weight, single, memory):
        if self.solver in ("pcg", "nystrom"):
            raise ValueError(
                f"solver={self.solver!r} needs rows, and a precomputed kernel has none; use 'auto', "
                "'cholesky' or 'tiled'."
            )
        if X.shape[0] != X.shape[1]:
            raise ValueError(f"A precomputed kernel matrix must be square, got shape {X.shape}.")
        rows = weight > 0.0
        matrix = np.asarray(X if rows.all() else X[np.ix_(rows, rows)], dtype=np.float64)
        alpha = np.zeros(targets.shape)
        machine = Machine(None, None, matrix, **self._limits(memory))
        alpha[rows], b = self._solved(machine, targets[rows], weight[rows])
        self._store(alpha, b, None, single)
        return self

    def _solved(self, machine, targets, weight):
        unit = unit_of(targets)
        dual, self.solver_ = machine.solved(self.solver, targets / unit, 1.0 / (self.C * weight))
        self.n_iter_, self.residual_ = dual.n_iter + 1, dual.residual
        return _in_unit(unit, dual.alpha), _in_unit(unit, dual.b)

    def _limits(self, memory):
        options = {name: getattr(self, name) for name in ("bias", "tol", "max_iter", "n_jobs")}
        return {
            "memory": memory,
            "options": options | {"random_state": check_random_state(self.random_state)},
        }

    def _by_landmarks(self, passes, move, single):
        n_features, options = len(self.offset_), ("C", "bias", "max_iter", "n_jobs", "n_landmarks")
        gamma, _ = self._gamma_and_scale()
        tol = _NYSTROM_TOLERANCE * self.tol
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            found = fit_nystrom(
                passes,
                length=kernel_length(self.kernel, gamma, n_features),
                tol=tol,
                random_state=check_random_state(self.random_state),
                **{name: getattr(self, name) for name in options},
            )
        raise_unless_finite(found.alpha, found.b)
        if not found.residual <= tol:
            warn_of_residual(found.residual)
        if found.uneven > _UNEVEN:
            warnings.warn(
                f"The heaviest row weighs {found.uneven:.1e} times the middle one: on landmarks light ones "
                "are met less well than residual_ says; use an exact solver.",
                UserWarning,
                stacklevel=6,
            )
        alpha, b = _in_unit(move.unit, found.alpha), _in_unit(move.unit, found.b, move.shift)
        self._store(alpha, b, found.landmarks, single)
        self.solver_, self.n_iter_, self.residual_ = "nystrom", found.n_iter + 1, found.residual
        return self

    def _begin_anew(self, moments_of_rows=None):
        """Forget what was fitted; what is changed afterwards is for the next fit.

        `moments_of_rows` gives the moments of the blocks of rows, and is called where gamma depends on them.
        """
        self._kernel_ = {name: getattr(self, name) for name in _OF_THE_FUNCTION}
        if self._scales():
            parts = moments_of_rows()
            self._kernel_["gamma"] = gamma_of_scale(parts, self.n_features_in_)
        elif isinstance(self.gamma, str):
            self._kernel_["gamma"] = None
        for name in ("robust_weight_", "loo_residuals_"):
            if hasattr(self, name):
                delattr(self, name)

    def _move_by(self, blocks):
        self.offset_, shift, unit = begin(blocks, self.kernel, self.bias)
        return Move(self._coordinates(), shift, unit)

    def _store(self, alpha, b, Z, single):
        self._seen_ = self._spread_ = None
        raise_unless_finite(alpha)
        self.dual_coef_ = alpha[:, 0] if single else alpha
        self.X_fit_ = None
        if Z is not None:
            self._right_ = as_right(self._between(), Z)
            self.X_fit_ = self._coordinates().back(Z)
            with np.errstate(over="ignore", invalid="ignore"):
                b = b - self._of_offset(alpha)
        raise_unless_finite(b)
        self.intercept_ = float(b[0]) if single else b

    def _trusted(self, X, targets, counts, weight):
        known, trusted = counts > 0.0, np.ones(len(counts))
        if self.kernel != "precomputed":
            errors = targets[known] - self._function(self._coordinates()(X[known]))
        else:
            errors = self._alpha()[known] / (self.C * counts[known])[:, None]
        trusted[known] = trust(errors, weight[known])
        return trusted

    def _learn_spread(self, blocks, single):
        between, Z = self._between(), self._coordinates()(self.X_fit_)
        landmarks = chosen_landmarks(
            between, Z, self.n_landmarks, check_random_state(self.random_state), self.n_jobs
        )
        self._spread_, errors = fit_spread(
            MovedBlocks(blocks, Move(self._coordinates(), 0.0, 1.0)),
            between,
            landmarks,
            self._function,
            C=self.C,
            bias=self.bias,
            n_jobs=self.n_jobs,
        )
        self.loo_residuals_ = errors[:, 0] if single else errors

    def _scales(self):
        """Whether gamma depends on the rows of the fit."""
        return isinstance(self.gamma, str) and self.kernel in WITH_GAMMA

    def _refuse(self, what, *names):
        """Refuse parameters that a way of fitting knows nothing of."""
        for name in names:
            if getattr(self, name):
                raise ValueError(
                    f"{what} does not go with {name}={getattr(self, name)!r}; use fit with rows in arrays."
                )


def _in_unit(unit, values, shift=0.0):
    """Values in the unit of the targets; what overflows there is refused by whoever stores them."""
    with np.errstate(over="ignore", invalid="ignore"):
        return unit * values + shift
