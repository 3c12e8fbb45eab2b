# SPDX-License-Identifier: BSD-3-Clause
"""Solvers for many rows against the dense one, and the parts that they are made of."""

import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.linalg import LinAlgWarning

from sklvalve.lssvm import LSSVMRegressor
from sklvalve.lssvm.cells import Cells, gathered
from sklvalve.lssvm.choice import SOLVERS, memory_to_use, solver_for
from sklvalve.lssvm.conjugate import LowRankPreconditioner, conjugate_gradients
from sklvalve.lssvm.kernels import kernel_between
from sklvalve.lssvm.packed import PackedCholesky
from sklvalve.lssvm.pivoted import pivoted_cholesky
from sklvalve.lssvm.products import KernelBlocks, product, symmetric_product
from sklvalve.lssvm.threads import own_threads, threads_to_use

KERNELS = ("rbf", "laplacian", "linear", "poly")
BIASES = ("free", "regularized", "none")
EXACT = ("tiled", "pcg")


def some(n=700, d=3, seed=0):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(n, d)) + 2.0
    y = np.column_stack([np.sin(X.sum(axis=1)), 2.0 * X[:, 0] + 7.0])
    return X, y + 0.01 * rng.normal(size=y.shape), rng.uniform(0.5, 2.0, n)


@pytest.mark.parametrize("bias", BIASES)
@pytest.mark.parametrize("kernel", KERNELS)
def test_exact_solvers_give_what_the_dense_one_gives(kernel, bias):
    X, y, weight = some()
    options = {"C": 100.0, "bias": bias, "random_state": 0}
    known = LSSVMRegressor(kernel, solver="cholesky", **options).fit(X, y, weight)
    for solver in EXACT:
        found = LSSVMRegressor(kernel, solver=solver, **options).fit(X, y, weight)
        assert found.solver_ == solver
        assert found.residual_ <= found.tol
        np.testing.assert_allclose(found.predict(X + 0.05), known.predict(X + 0.05), atol=2e-5)
    left = known.predict(X) + known.dual_coef_ / (100.0 * weight[:, None]) - y
    np.testing.assert_allclose(left, 0.0, atol=1e-6)


@pytest.mark.parametrize("bias", BIASES)
def test_all_rows_as_landmarks_are_the_whole_machine(bias):
    X, y, weight = some(300)
    options = {"C": 100.0, "bias": bias, "random_state": 0}
    known = LSSVMRegressor(solver="cholesky", **options).fit(X, y, weight)
    found = LSSVMRegressor(solver="nystrom", tol=1e-10, **options).fit(X, y, weight)
    assert len(found.X_fit_) <= 300
    np.testing.assert_allclose(found.predict(X), known.predict(X), atol=1e-4)


def test_few_landmarks_are_as_good_as_the_equations_on_them():
    X, y, weight = some(3000)
    found = LSSVMRegressor(C=1e3, solver="nystrom", n_landmarks=150, tol=1e-10, random_state=1).fit(
        X, y, weight
    )
    assert found.X_fit_.shape == (150, 3)
    between = kernel_between("rbf")
    Z, own = between(X, found.X_fit_), between(found.X_fit_, found.X_fit_)
    # the cost |w|^2 / 2 + C / 2 sum s (y - f)^2 has no slope at its minimum, in weights and in bias
    left = weight[:, None] * (y - found.predict(X))
    slope = own @ found.dual_coef_ - 1e3 * Z.T @ left
    assert np.abs(slope).max() < 1e-5 * np.abs(1e3 * Z.T @ (weight[:, None] * y)).max()
    assert np.abs(left.sum(axis=0)).max() < 1e-5 * weight.sum()


def test_more_rows_than_one_block_are_gathered_alike():
    X, y, weight = some(5000)
    one, parts = Cells(0.15, 400), Cells(0.15, 400)
    one.add(gathered(X, y, weight, 0.15))
    for start in range(0, 5000, 900):
        parts.add(gathered(*(a[start : start + 900] for a in (X, y, weight)), 0.15))
    for found in (one.result(), parts.result(), parts.result(200)):
        means, targets, weights = found
        assert len(weights) <= 400
        assert weights.sum() == pytest.approx(weight.sum())
        np.testing.assert_allclose(weights @ means, weight @ X, rtol=1e-9)
        np.testing.assert_allclose(weights @ targets, weight @ y, rtol=1e-9)
    assert len(weights) <= 200


@pytest.mark.parametrize("n", [1, 2, 63, 64, 65, 200])
def test_a_factor_in_tiles_solves(n):
    rng = np.random.default_rng(n)
    root = rng.normal(size=(n, n + 3))
    matrix, right = root @ root.T + np.eye(n), rng.normal(size=(n, 2))
    found = PackedCholesky(lambda rows, columns: matrix[rows, columns].copy(), n, tile=64)
    assert found.positive_definite
    np.testing.assert_allclose(matrix @ found.solve(right), right, atol=1e-8)


@pytest.mark.parametrize("spoilt", [0, 70, 190])
@pytest.mark.parametrize("value", [-5.0, np.nan])
def test_a_matrix_that_is_not_positive_definite_is_told(spoilt, value):
    matrix = np.eye(200)
    matrix[spoilt, spoilt] = value
    found = PackedCholesky(lambda rows, columns: matrix[rows, columns].copy(), 200, tile=32)
    assert not found.positive_definite


def test_an_error_in_a_block_ends_every_thread():
    def block(rows, columns):
        if rows.start >= 96:
            raise OverflowError("too large")
        return np.eye(200)[rows, columns].copy()

    with pytest.raises(OverflowError, match="too large"):
        PackedCholesky(block, 200, tile=32)


def test_low_rank_is_below_the_matrix_and_tells_what_is_left():
    X, _, _ = some(400)
    between = kernel_between("rbf", gamma=0.1)
    K = between(X, X)
    rng = np.random.RandomState(0)
    F, pivots, rest = pivoted_cholesky(between, X, np.ones(400), rank=60, left=0.0, random_state=rng)
    assert F.shape == (400, 60)
    assert len(set(pivots)) == 60
    left = K - F @ F.T
    assert rest == pytest.approx(np.trace(left), rel=1e-6)
    assert np.linalg.eigvalsh(left).min() > -1e-9
    np.testing.assert_allclose(left[pivots], 0.0, atol=1e-8)
    # not far from the best that any matrix of this rank can do
    assert rest < 20.0 * np.linalg.eigvalsh(K)[:-60].sum()


def test_low_rank_stops_where_enough_is_explained():
    X, _, _ = some(400)
    between = kernel_between("linear")
    diagonal = np.einsum("ij,ij->i", X, X)
    F, _, rest = pivoted_cholesky(
        between, X, diagonal, rank=100, left=0.0, random_state=np.random.RandomState(0)
    )
    assert F.shape[1] <= 6
    assert rest <= 1e-9 * diagonal.sum()


@pytest.mark.parametrize("kernel", KERNELS)
def test_products_without_the_matrix(kernel):
    X, y, _ = some(1300)
    between = kernel_between(kernel)
    with own_threads() as run:
        found = symmetric_product(run, KernelBlocks(between, X, X), 1300, y)
        other = product(run, KernelBlocks(between, X[:77], X), (77, 1300), y)
    np.testing.assert_allclose(found, between(X, X) @ y, rtol=1e-9, atol=1e-8)
    np.testing.assert_allclose(other, between(X[:77], X) @ y, rtol=1e-9, atol=1e-8)


def test_conjugate_gradients_reach_the_tolerance_or_say_so():
    rng = np.random.default_rng(0)
    root = rng.normal(size=(300, 300))
    matrix = root @ root.T + 1e-3 * np.eye(300)
    right = rng.normal(size=(300, 2))
    nothing = LowRankPreconditioner(np.zeros((300, 1), order="F"), np.ones(300))
    found = conjugate_gradients(lambda v: matrix @ v, nothing, right, tol=1e-8, max_iter=4000)
    assert (np.abs(right - matrix @ found.x) <= 1e-7 * np.abs(right).max()).all()
    stopped = conjugate_gradients(lambda v: matrix @ v, nothing, right, tol=1e-8, max_iter=20)
    assert np.abs(stopped.residual).max() > 1e-8
    np.testing.assert_allclose(stopped.residual, right - matrix @ stopped.x, atol=1e-9)


def test_the_choice_follows_rows_and_memory():
    assert solver_for(8000, 1e10, matrix_given=False) == "cholesky"
    assert solver_for(8000, 1e8, matrix_given=False) == "pcg"
    assert solver_for(20_000, 1e10, matrix_given=False) == "pcg"
    assert solver_for(20_000, 1e10, matrix_given=True) == "tiled"
    assert solver_for(200_000, 1e11, matrix_given=False) == "nystrom"
    assert memory_to_use(5e6) == 5e6
    assert memory_to_use(None) > 1e7


def test_gradients_that_stall_make_room_for_a_factor():
    X, y, _ = some(900)
    rough = {"gamma": 20.0, "C": 1e6, "max_iter": 2, "tol": 1e-10, "random_state": 0}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # so little that the dense matrix is not tried, and enough for the tiles
        found = LSSVMRegressor(max_memory=4e6, **rough).fit(X, y[:, 0])
    assert found.solver_ == "tiled"
    with pytest.warns(LinAlgWarning, match="raise max_memory"):
        found = LSSVMRegressor(max_memory=3e6, **rough).fit(X, y[:, 0])
    assert found.solver_ == "pcg"
    assert found.residual_ > found.tol


@pytest.mark.parametrize("solver", ["pcg", "nystrom"])
def test_a_matrix_has_no_rows_for_solvers_that_need_them(solver):
    with pytest.raises(ValueError, match="a precomputed kernel has none"):
        LSSVMRegressor("precomputed", solver=solver).fit(np.eye(3), np.ones(3))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("n", [1, 2, 3])
def test_the_smallest_data(solver, n):
    X, y = np.arange(float(n))[:, None], np.arange(float(n)) + 5.0
    found = LSSVMRegressor(C=1e6, gamma=0.1, solver=solver, random_state=0).fit(X, y)
    np.testing.assert_allclose(found.predict(X), y, atol=1e-2)


@pytest.mark.parametrize("offset", [1e6, 1e12])
@pytest.mark.parametrize("solver", SOLVERS)
def test_offsets_are_taken_up_by_the_bias(solver, offset):
    X, y, _ = some(300)
    plain = LSSVMRegressor(C=100.0, solver=solver, random_state=0).fit(X, y[:, 0])
    moved = LSSVMRegressor(C=100.0, solver=solver, random_state=0).fit(X + 1e6, y[:, 0] + offset)
    digits = 1e-3 if offset < 1e9 else 1e-2
    np.testing.assert_allclose(moved.predict(X + 1e6) - offset, plain.predict(X), atol=digits)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("C", [1e10, 1e13, 1e16])
def test_a_huge_c_gives_the_answer_or_a_warning(solver, C):
    X, y, _ = some(200)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = LSSVMRegressor(C=C, gamma=0.5, solver=solver, random_state=0).fit(X, y)
    made = found.predict(X)
    assert np.isfinite(made).all()
    left = np.abs(made - y).max() / np.abs(y - y.mean(axis=0)).max()
    # so large a C asks to go through every point
    assert left < 1e-2 or any(issubclass(w.category, LinAlgWarning) for w in told)


@pytest.mark.parametrize("solver", SOLVERS)
def test_columns_that_never_change_and_rows_that_repeat(solver):
    X, y, _ = some(120)
    X = np.column_stack([np.repeat(X[:40], 3, axis=0), np.full(120, 4.0)])
    found = LSSVMRegressor(C=10.0, solver=solver, random_state=0).fit(X, y)
    known = LSSVMRegressor(C=10.0).fit(X, y)
    np.testing.assert_allclose(found.predict(X), known.predict(X), atol=1e-3)


@pytest.mark.parametrize("solver", SOLVERS)
def test_what_overflows_is_an_error(solver):
    X, y, _ = some(60)
    with pytest.raises(ValueError, match="not finite"):
        LSSVMRegressor("poly", degree=9, solver=solver, random_state=0).fit(1e60 * X, y)


@pytest.mark.parametrize("kernel", KERNELS)
def test_a_solution_that_is_known_already_predicts_alike(kernel):
    X, y, _ = some(100)
    for targets in (y, y[:, 0]):
        known = LSSVMRegressor(kernel).fit(X, targets)
        found = LSSVMRegressor(kernel).with_solution(known.X_fit_, known.dual_coef_, known.intercept_)
        np.testing.assert_allclose(found.predict(X + 0.1), known.predict(X + 0.1), atol=1e-9)


def test_weights_that_hide_light_rows_from_the_landmarks_are_told():
    X, y, _ = some(200)
    weight = np.where(np.arange(200) % 3 == 0, 1e6, 1.0)
    with pytest.warns(UserWarning, match="light ones are met less well"):
        LSSVMRegressor(solver="nystrom", random_state=0).fit(X, y, weight)


def test_one_blas_thread_is_given_back_by_the_last_that_asked():
    before = threads_to_use()
    with ThreadPoolExecutor(3) as pool:
        X, y, _ = some(60)
        list(pool.map(lambda _: LSSVMRegressor().fit(X, y), range(60)))
    assert threads_to_use() == before
