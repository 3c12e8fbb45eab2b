# SPDX-License-Identifier: BSD-3-Clause
"""How an LS-SVM is fitted, by where its rows are: in arrays, in blocks, on a cluster, or yet to come."""

import warnings

import numpy as np
from sklearn.utils import check_random_state
from sklearn.utils.validation import validate_data

from sklvalve.lssvm.choice import Machine, memory_to_use, solver_for, weight_of
from sklvalve.lssvm.distributed import DaskPasses, parts_of
from sklvalve.lssvm.kernels import gamma_and_scale, kernel_length
from sklvalve.lssvm.large import warn_of_residual
from sklvalve.lssvm.nystrom import chosen_landmarks, fit_nystrom
from sklvalve.lssvm.online import nothing_seen, solution_of, with_rows
from sklvalve.lssvm.passes import Passes
from sklvalve.lssvm.products import as_right
from sklvalve.lssvm.robust import trust
from sklvalve.lssvm.rows import (
    HEAD,
    ArrayBlocks,
    GivenBlocks,
    Move,
    MovedBlocks,
    middle_of,
)
from sklvalve.lssvm.spread import fit_spread

# the approximation's own error is far above this, whatever the tolerance of an exact solution
_NYSTROM_TOLERANCE = 100.0
# of what there is to be spanned; less than this is no loss
_LACKING = 1e-4


class Fitting:
    """The ways of `fit`, `fit_blocks` and `partial_fit` of :class:`~sklvalve.lssvm.LSSVMRegressor`."""

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
        """
        X_fit, dual_coef = np.asarray(X_fit, dtype=np.float64), np.asarray(dual_coef, dtype=np.float64)
        self._gamma_, self.n_features_in_ = self.gamma, X_fit.shape[1]
        self.offset_ = middle_of(X_fit, self.kernel, self.bias)
        alpha = dual_coef.reshape(len(dual_coef), -1)
        self._store(alpha, np.zeros(alpha.shape[1]), self._coordinates()(X_fit), dual_coef.ndim == 1)
        self.X_fit_ = X_fit
        self.intercept_ = float(intercept) if dual_coef.ndim == 1 else np.asarray(intercept, dtype=np.float64)
        return self

    def _fit_arrays(self, X, y, sample_weight):
        # what is changed afterwards is for the next fit
        self._gamma_ = self.gamma
        weight = weight_of(self.C, sample_weight, X)
        targets, single = y.astype(np.float64).reshape(len(y), -1), y.ndim == 1
        self._fit_weighted(X, targets, weight, single)
        counts = weight
        for _ in range(self.robust_passes):
            self.robust_weight_ = self._trusted(X, targets, counts)
            counts = weight * self.robust_weight_
            self._fit_weighted(X, targets, counts, single)
        if self.uncertainty:
            self._learn_spread(ArrayBlocks(X, targets, counts), single)
        return self

    def _fit_given(self, blocks):
        self._refuse("fit_blocks", robust_passes=self.robust_passes)
        self._gamma_ = self.gamma
        given = GivenBlocks(blocks, self)
        X, y, _ = given.first()
        first = self._blocks_begin(X, y)
        self._by_landmarks(Passes(self._between(), MovedBlocks(given, *first)), first[1], given.single)
        if self.uncertainty:
            self._learn_spread(given, given.single)
        return self

    def _fit_dask(self, X, y, sample_weight):
        refused = {name: getattr(self, name) for name in ("robust_passes", "uncertainty")}
        self._refuse("A Dask collection", precomputed=self.kernel == "precomputed", **refused)
        self._gamma_ = self.gamma
        parts, lengths = parts_of(X, y, sample_weight)
        head = X.get_partition(0) if hasattr(X, "get_partition") else X.blocks[0]
        validate_data(self, head.compute(), dtype=np.float64)
        rows, targets, _ = parts[0].compute()
        coordinates, shift = self._blocks_begin(rows, targets)
        passes = DaskPasses(self._between(), parts, lengths, Move(coordinates, shift))
        return self._by_landmarks(passes, shift, y.ndim == 1)

    def _fit_more(self, X, y, sample_weight):
        self._refuse("partial_fit", robust_passes=self.robust_passes, uncertainty=self.uncertainty)
        seen = getattr(self, "_seen_", None)
        X, y = validate_data(
            self, X, y, dtype=np.float64, multi_output=True, y_numeric=True, reset=seen is None
        )
        weight = weight_of(self.C, sample_weight, X)
        targets = y.astype(np.float64).reshape(len(y), -1)
        if seen is None:
            self._gamma_ = self.gamma
            _, shift = self._blocks_begin(X, targets)
            seen = nothing_seen(X.shape[1], targets.shape[1]) | {"shift": shift}
        elif targets.shape[1] != len(seen["shift"]):
            raise ValueError(f"y has {targets.shape[1]} targets, the rows before had {len(seen['shift'])}.")
        more = {name: getattr(self, name) for name in ("C", "n_landmarks", "n_jobs")}
        more["random_state"] = check_random_state(self.random_state)
        Z = self._coordinates()(X)
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            seen, lacking = with_rows(seen, self._between(), Z, targets - seen["shift"], weight, **more)
        if lacking > _LACKING:
            warnings.warn(
                f"The {len(seen['landmarks'])} landmarks leave {lacking:.1e} of the kernel of the new rows "
                "unspanned; raise n_landmarks and begin anew with rows of all kinds, or use fit.",
                UserWarning,
                stacklevel=4,
            )
        alpha, b, residual = solution_of(seen, C=self.C, bias=self.bias)
        self._store(alpha, b + seen["shift"], seen["landmarks"], y.ndim == 1)
        self.solver_, self.n_iter_, self.residual_, self._seen_ = "online", 1, residual, seen
        return self

    def _fit_weighted(self, X, targets, weight, single):
        rows, memory = weight > 0.0, memory_to_use(self.max_memory)
        matrix_given = self.kernel == "precomputed"
        if matrix_given and self.solver in ("pcg", "nystrom"):
            raise ValueError(
                f"solver={self.solver!r} needs rows, and a precomputed kernel has none; use 'auto', "
                "'cholesky' or 'tiled'."
            )
        solver = self.solver
        if solver == "auto" and solver_for(rows.sum(), memory, matrix_given=matrix_given) == "nystrom":
            solver = "nystrom"
        if solver == "nystrom":
            first = self._blocks_begin(X, targets)
            blocks = MovedBlocks(ArrayBlocks(X, targets, weight), *first)
            return self._by_landmarks(Passes(self._between(), blocks), first[1], single)
        options = {name: getattr(self, name) for name in ("bias", "tol", "max_iter", "n_jobs")}
        options["random_state"] = check_random_state(self.random_state)
        Z, given = None, None
        if matrix_given:
            if X.shape[0] != X.shape[1]:
                raise ValueError(f"A precomputed kernel matrix must be square, got shape {X.shape}.")
            given = np.asarray(X if rows.all() else X[np.ix_(rows, rows)], dtype=np.float64)
        else:
            kept = X[rows]
            self.offset_ = middle_of(kept, self.kernel, self.bias)
            Z = self._coordinates()(kept)
        machine = Machine(None if matrix_given else self._between(), Z, given, memory=memory, options=options)
        dual, self.solver_ = machine.solved(solver, targets[rows], 1.0 / (self.C * weight[rows]))
        self.n_iter_, self.residual_ = dual.n_iter + 1, dual.residual
        alpha = dual.alpha
        if matrix_given:
            alpha = np.zeros((len(rows), alpha.shape[1]))
            alpha[rows] = dual.alpha
        self._store(alpha, dual.b, Z, single)
        if not matrix_given:
            self.X_fit_ = kept.astype(np.float64)
        return self

    def _by_landmarks(self, passes, shift, single):
        n_features, options = len(self.offset_), ("C", "bias", "max_iter", "n_jobs", "n_landmarks")
        gamma, _ = gamma_and_scale(self.kernel, self._gamma_, n_features)
        tol = _NYSTROM_TOLERANCE * self.tol
        with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
            found = fit_nystrom(
                passes,
                length=kernel_length(self.kernel, gamma, n_features),
                tol=tol,
                random_state=check_random_state(self.random_state),
                **{name: getattr(self, name) for name in options},
            )
        if found.residual > tol:
            warn_of_residual(found.residual)
        self._store(found.alpha, found.b + shift, found.landmarks, single)
        self.solver_, self.n_iter_, self.residual_ = "nystrom", found.n_iter + 1, found.residual
        return self

    def _blocks_begin(self, X, targets):
        """Coordinates of the kernel, and what is taken off the targets, by the first rows alone."""
        self.offset_ = middle_of(X[:HEAD], self.kernel, self.bias)
        shift = targets[:HEAD].mean(axis=0) if self.bias == "free" else np.zeros(targets.shape[1])
        return self._coordinates(), shift

    def _store(self, alpha, b, Z, single):
        self._seen_ = self._spread_ = None
        self.dual_coef_ = alpha[:, 0] if single else alpha
        self.X_fit_ = None
        if Z is not None:
            self._right_ = as_right(self._between(), Z)
            self.X_fit_ = self._coordinates().back(Z)
            b = b - self._of_offset(alpha)
        self.intercept_ = float(b[0]) if single else b

    def _trusted(self, X, targets, weight):
        known, trusted = weight > 0.0, np.ones(len(weight))
        if self.solver_ == "nystrom":
            errors = targets[known] - self._function(self._coordinates()(X[known]))
        else:
            alpha = self._alpha() if self.kernel != "precomputed" else self._alpha()[known]
            errors = alpha / (self.C * weight[known])[:, None]
        trusted[known] = trust(errors)
        return trusted

    def _learn_spread(self, blocks, single):
        self._refuse("uncertainty", precomputed=self.kernel == "precomputed")
        between, Z = self._between(), self._coordinates()(self.X_fit_)
        landmarks = chosen_landmarks(
            between, Z, self.n_landmarks, check_random_state(self.random_state), self.n_jobs
        )
        self._spread_, errors = fit_spread(
            MovedBlocks(blocks, self._coordinates(), 0.0),
            between,
            landmarks,
            self._function,
            C=self.C,
            bias=self.bias,
            n_jobs=self.n_jobs,
        )
        self.loo_residuals_ = errors[:, 0] if single else errors

    def _refuse(self, what, **asked):
        for name, is_asked in asked.items():
            if is_asked:
                told = "a precomputed kernel" if name == "precomputed" else f"{name}={getattr(self, name)!r}"
                raise ValueError(f"{what} does not go with {told}; use fit with rows in arrays.")
