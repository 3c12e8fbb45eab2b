# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sklvalve.lssvm import dense, solvers
from sklvalve.lssvm.kernels import kernel_between, lower_gram, row_blocks
from sklvalve.lssvm.products import kernel_product


def positive_definite(n, seed=0):
    A = np.random.default_rng(seed).normal(size=(n, n + 2))
    return A @ A.T + np.eye(n)


@settings(deadline=None, max_examples=40)
@given(n=st.integers(1, 40), tile=st.integers(1, 45), seed=st.integers(0, 50))
def test_tiles_give_the_factor_of_the_whole(n, tile, seed):
    matrix = positive_definite(n, seed)
    factor = np.array(matrix, order="F")
    factor[np.triu_indices(n, 1)] = np.nan
    assert solvers.cholesky(factor, tile=tile)
    np.testing.assert_allclose(np.tril(factor), np.linalg.cholesky(matrix), rtol=1e-9, atol=1e-10)
    right = np.random.default_rng(seed).normal(size=(n, 3))
    x = solvers.cholesky_solve(factor, right, tile=tile)
    np.testing.assert_allclose(matrix @ x, right, atol=1e-9)


def test_the_factorisation_is_in_place_and_leaves_the_other_triangle_alone():
    matrix = np.array(positive_definite(30), order="F")
    upper = np.triu(matrix, 1)
    expected = np.linalg.cholesky(matrix)
    assert solvers.cholesky(matrix)
    np.testing.assert_allclose(np.tril(matrix), expected, rtol=1e-9)
    np.testing.assert_array_equal(np.triu(matrix, 1), upper)


@pytest.mark.parametrize("tile", [None, 3, 5])
@pytest.mark.parametrize("bad", [0, 6, 11])
def test_an_indefinite_matrix_is_reported(tile, bad):
    matrix = np.asfortranarray(positive_definite(12))
    matrix[bad, bad] = -1.0
    assert not solvers.cholesky(matrix, tile=tile)


def test_no_call_of_lapack_sees_more_than_a_tile_of_a_large_matrix(monkeypatch):
    seen = []
    real = solvers.dpotrf
    monkeypatch.setattr(solvers, "LAPACK_ROWS", 20)
    monkeypatch.setattr(solvers, "TILE", 8)
    monkeypatch.setattr(solvers, "dpotrf", lambda a, **kw: seen.append(len(a)) or real(a, **kw))
    assert solvers.cholesky(np.asfortranarray(positive_definite(20)))
    assert solvers.cholesky(np.asfortranarray(positive_definite(21)))
    assert seen == [20, 8, 8, 5]


@pytest.mark.parametrize("bias", ["free", "regularized", "none"])
def test_least_squares_agrees_with_the_factorisation_where_both_work(bias):
    matrix = positive_definite(25)
    y = np.random.default_rng(1).normal(size=(25, 2)) + 7
    ridge = np.full(25, 0.5)
    found = dense.solve_lssvm(lambda: np.array(matrix, order="F"), lambda v: matrix @ v, y, ridge, bias=bias)
    alpha, b = found.alpha, found.b
    expected, b_expected = dense.least_squares(np.asfortranarray(matrix + np.diag(ridge)), y, bias=bias)
    np.testing.assert_allclose(alpha, expected, atol=1e-9)
    np.testing.assert_allclose(b, b_expected, atol=1e-9)


def test_refinement_reduces_the_residual():
    # A factor of slightly another matrix stands for the rounding of a bad one.
    matrix = positive_definite(20)
    factor = np.asfortranarray(matrix * (1 + 1e-4))
    solvers.cholesky(factor)
    right = np.random.default_rng(0).normal(size=(20, 1))
    rough = solvers.cholesky_solve(factor, right)
    refined, worst = dense._refined(rough, right, factor, lambda v: matrix @ v)
    before, after = (np.abs(matrix @ x - right).max() for x in (rough, refined))
    assert after < 1e-9 < before
    assert worst == pytest.approx(after / np.abs(right).max())


@pytest.mark.parametrize("kernel", ["rbf", "linear", "poly", "laplacian"])
def test_matrix_and_product_do_not_depend_on_the_blocks(kernel, monkeypatch):
    X = np.random.default_rng(0).normal(size=(37, 3))
    between = kernel_between(kernel, gamma=0.5)
    whole = between(X, X)
    monkeypatch.setattr("sklvalve.lssvm.kernels.BLOCK", 100)
    assert len(row_blocks(37, 37)) > 10
    np.testing.assert_allclose(np.tril(lower_gram(between, X)), np.tril(whole), rtol=1e-12, atol=1e-13)
    v = np.ones((37, 2))
    np.testing.assert_allclose(kernel_product(between, X, X, v), whole @ v, rtol=1e-12, atol=1e-12)


def test_an_unknown_kernel_is_named():
    with pytest.raises(ValueError, match="got 'cosine'"):
        kernel_between("cosine")
