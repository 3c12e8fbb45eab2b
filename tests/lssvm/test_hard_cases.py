# SPDX-License-Identifier: BSD-3-Clause
"""Numerically hard and awkward cases: the right answer, or one clear error or warning; never a silent NaN."""

import warnings
from functools import partial, reduce
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import LinAlgWarning

from sklvalve.lssvm import LSSVMRegressor, LSSVMRegressorCV

SOLVERS = ("cholesky", "tiled", "pcg", "nystrom")
WAYS = (*SOLVERS, "partial_fit", "fit_blocks")
NOISE = 0.05


def function(X):
    return np.sin(3.0 * X[:, 0]) + X[:, -1] ** 2


def rows(n=60, seed=0):
    random = np.random.default_rng(seed)
    X = random.uniform(-1.0, 1.0, (n, 2))
    return X, function(X) + NOISE * random.normal(size=n)


X, Y = rows()
ASKED = rows(20, 1)[0]
COUNTS = np.random.default_rng(5).integers(1, 4, 60)
TIMES = np.random.default_rng(6).permutation(np.repeat(np.arange(60), COUNTS))
KEPT = np.arange(60) % 3 > 0


def fitted(way, X, y, weight=None, *, blocks=2, **options):
    """Fit in one of the `WAYS`, so tightly that what is left is the method's own error."""
    options = {"gamma": 0.5, "tol": 1e-8, "random_state": 0} | options
    if way in SOLVERS:
        return LSSVMRegressor(solver=way, **options).fit(X, y, weight)
    edges = pairwise(np.linspace(0, len(y), min(blocks, len(y)) + 1).astype(int))
    given = [(X[i:j], y[i:j], None if weight is None else weight[i:j]) for i, j in edges]
    if way == "fit_blocks":
        return LSSVMRegressor(**options).fit_blocks(given)
    return reduce(lambda model, block: model.partial_fit(*block), given, LSSVMRegressor(**options))


def kernel(A, B, gamma):
    A, B = np.asarray(A, np.longdouble), np.asarray(B, np.longdouble)
    return np.exp(-(np.asarray(gamma, np.longdouble) * (A[:, None] - B) ** 2).sum(axis=2))


def solution(X, y, weight=1.0, asked=ASKED, *, C=100.0, gamma=0.5):
    """Predictions by the equations of the docstring, with residuals in extended precision."""
    n, y = len(y), np.asarray(y, np.longdouble)
    ridge = np.diag(1 / (np.longdouble(C) * weight * np.ones(n)))
    A = np.pad(kernel(X, X, gamma) + ridge, (1, 0), constant_values=1)
    A[0, 0] = 0
    right, solved = np.vstack([np.zeros((1, y.size // n)), y.reshape(n, -1)]), 0
    for _ in range(9):
        solved = solved + np.linalg.solve(A.astype(float), (right - A @ (solved + 0 * right)).astype(float))
    predicted = kernel(asked, X, gamma) @ solved[1:] + solved[0]
    return predicted.astype(float).reshape(-1, *y.shape[1:])


def left_out_errors(X, y, weight, **options):
    """One machine without each row, which is then asked for it; NaN of rows without weight."""
    errors = np.full(len(y), np.nan)
    for i in np.flatnonzero(weight):
        kept = (weight > 0) & (np.arange(len(y)) != i)
        errors[i] = y[i] - solution(X[kept], y[kept], weight[kept], X[[i]], **options)[0]
    return errors


def assert_right(way, got, expected, exact=1e-7):
    """Exact to rounding and `tol`; Nystrom to a hundred `tol`; row by row to a share of the noise."""
    assert got.shape == expected.shape
    if way == "partial_fit":
        assert np.sqrt(np.mean((got - expected) ** 2)) < max(exact, 0.4 * NOISE)
    else:
        assert_allclose(got, expected, rtol=0, atol=max(exact, 1e-5 * (way in ("nystrom", "fit_blocks"))))


def case(given, asked=ASKED, *, alike=None, exact=1e-7, **options):
    """What is fitted and asked for; the answer is that to `alike` data, by themselves the same."""
    return given, asked, alike or given, exact, options


CASES = {
    "rows repeated": case((X[TIMES], Y[TIMES]), alike=(X, Y, COUNTS)),
    "weights for repeated rows": case((X, Y, COUNTS), alike=(X[TIMES], Y[TIMES])),
    "rows of 1e-300 are equal": case((1e-300 * X, Y), 1e-300 * ASKED),
    "one row": case((X[:1], Y[:1])),
    "two rows": case((X[:2], Y[:2])),
    "two equal rows": case((X[[0, 0]], Y[:2])),
    "constant column": case((X * [1, 0] + [0, 1e15], Y), ASKED * [1, 0] + [0, 1e15]),
    "constant columns": case((0 * X + 0.1, Y), 0 * ASKED + 0.1),
    "constant target": case((X, 0 * Y + 0.3), exact=1e-14),
    "lists": case((X.tolist(), Y.tolist()), ASKED.tolist()),
    "float32": case((X.astype("f4"), Y.astype("f4")), ASKED.astype("f4")),
    "integers": case(((3 * X).astype(int), (3 * Y).astype(int)), (3 * ASKED).astype(int)),
    "Fortran order and strides": case((np.asfortranarray(X), np.repeat(Y, 2)[::2]), np.asfortranarray(ASKED)),
    "read-only": case((np.broadcast_to(X, (60, 2)), np.broadcast_to(Y, 60)), np.broadcast_to(ASKED, (20, 2))),
    "mapped": case((X, Y)),
    "one column of targets": case((X, Y[:, None])),
    "many targets": case((X, np.c_[Y, 0 * Y + 3.0, -2 * Y, Y**2, -Y, 2 - Y, 0.1 * Y])),
    **{f"gamma {g}": case((X, Y), gamma=g) for g in (1e-8, 1e4, [0.3, 2.0], np.array([1, 2], "f4"))},
    **{f"weights of {w}": case((X, Y, np.full(60, w)), exact=1e-6) for w in (1e-12, 1e-3, 1e3)},
    **{f"targets at {far}": case((X, Y + far), exact=1e-7 + 5e-16 * far) for far in (1e6, 1e12)},
    **{f"rows at {far}": case((X + far, Y), ASKED + far) for far in (1e6, 1e12)},
}
for w in (0.0, 1e-300, 1e-12):
    CASES[f"{w} for no weight"] = case((X, Y + 10 * ~KEPT, np.where(KEPT, 1, w)), alike=(X[KEPT], Y[KEPT]))


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("way", WAYS)
def test_right_answer(way, name, tmp_path):
    given, asked, alike, exact, options = CASES[name]
    if name == "mapped":
        np.save(tmp_path / "rows.npy", X)
        given = np.load(tmp_path / "rows.npy", mmap_mode="r"), Y
    got = fitted(way, *given, **options).predict(asked)
    assert_right(way, got, solution(*alike, asked=asked, **options), exact)


@pytest.mark.parametrize("repeated", [False, True])
@pytest.mark.parametrize("C", [1e-12, 1e10, 1e13, 1e16])
@pytest.mark.parametrize("solver", SOLVERS)
def test_extreme_C_is_solved_or_told(solver, C, repeated):
    A, b = (np.vstack([X, X[:20]]), np.r_[Y, Y[:20]]) if repeated else (X, Y)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        model = fitted(solver, A, b, C=C, tol=1e-6)
    assert [w.category for w in told] in ([], [LinAlgWarning])
    assert np.isfinite([*model.predict(ASKED), model.residual_]).all()
    if solver != "nystrom":
        # rows that repeat each other are one where C is large
        one, first, many = np.unique(A, axis=0, return_index=True, return_counts=True)
        rows, target, ridge = (
            (one, b[first], 1.0 / (C * many)) if C > 1e8 else (A, b, np.full(len(b), 1.0 / C))
        )
        order = np.lexsort(model.X_fit_.T[::-1]) if C > 1e8 else slice(None)
        left = np.abs(model.predict(rows) + (model.dual_coef_[order] * ridge) - target)
        left = left.max() / np.abs(target - target.mean()).max()
        assert told or left < 3e-6
        assert not told or left > 3e-7
        assert solver == "pcg" or left < (0.2 if repeated and C == 1e16 else 3e-3)
    if C < 1.0 or (C == 1e10 and solver in ("cholesky", "tiled")):
        expected = solution(X, Y, 1.0 + repeated * (np.arange(60) < 20), C=C)
        assert_allclose(model.predict(ASKED), expected, rtol=0, atol=1e-9 if C < 1.0 else 1e-3)


@pytest.mark.parametrize("solver", ["cholesky", "tiled"])
def test_extreme_targets(solver):
    for scale in (1e-300, 1e300):
        assert_right(solver, fitted(solver, X, Y * scale).predict(ASKED) / scale, solution(X, Y))


@pytest.mark.parametrize("solver", ["cholesky", "tiled", "pcg"])
def test_huge_weights_are_met_and_huge_rows_refused(solver):
    weight = np.where(np.arange(60) % 30, 1.0, 1e12)
    model = fitted(solver, X, Y, weight)
    assert_right(solver, model.predict(ASKED), solution(X, Y, weight))
    assert_allclose(model.predict(X[::30]), Y[::30], rtol=0, atol=1e-7)
    with pytest.raises(ValueError, match="too large for this kernel"):
        fitted(solver, 1e300 * X, Y)


@pytest.mark.parametrize("where", ["X", "y", "sample_weight"])
@pytest.mark.parametrize("way", [*WAYS, "cross-validated"])
def test_no_nan_or_infinity(way, where):
    for bad in (np.nan, np.inf, -np.inf):
        data = {"X": X.copy(), "y": Y.copy(), "sample_weight": np.ones(60)}
        data[where][-1] = bad
        fit = partial(fitted, way) if way in WAYS else LSSVMRegressorCV().fit
        with pytest.raises(ValueError, match=f"Input {where} contains"):
            fit(*data.values())
        with pytest.raises(ValueError, match="Input X contains"):
            fit(X, Y).predict([[bad, 0.0]])


@pytest.mark.parametrize("way", WAYS)
def test_impossible_options(way):
    for gamma in ([0.3], [0.3, 1, 2], [0.3, -1], [0.3, np.nan], [], [[0.3, 1]], 0.0, np.nan, "a"):
        with pytest.raises(ValueError, match="gamma"):
            fitted(way, X, Y, gamma=gamma)
    for weight in (np.where(KEPT, 1.0, -1.0), np.zeros(60), np.ones((60, 2)), np.ones(59)):
        with pytest.raises(ValueError, match=r"(?i)sample.weight"):
            fitted(way, X, Y, weight)


@pytest.mark.parametrize("way", WAYS)
def test_names_of_columns(way):
    frame = pd.DataFrame(X, columns=["a", "b"])
    model = fitted(way, frame, pd.Series(Y))
    assert_right(way, model.predict(frame), solution(X, Y, asked=X))
    assert list(model.feature_names_in_) == ["a", "b"]
    with pytest.raises(ValueError, match="feature names"):
        model.predict(frame[["b", "a"]])


@pytest.mark.parametrize("blocks", [1, 7, 60])
@pytest.mark.parametrize("way", ["partial_fit", "fit_blocks"])
def test_division_into_blocks_does_not_matter(way, blocks):
    A, b = rows(300, 2)
    expected = LSSVMRegressor(gamma=0.5).fit(A, b).predict(ASKED)
    assert_right(way, fitted(way, A, b, blocks=blocks).predict(ASKED), expected)


def test_new_rows_that_no_landmark_spans_or_that_are_unlike():
    model = LSSVMRegressor(n_landmarks=40, random_state=0).partial_fit(X, Y)
    with pytest.warns(UserWarning, match="40 landmarks leave"):
        model.partial_fit(np.vstack([X + 5.0, X + 10.0]), np.r_[Y, Y])
    for other in ((X[:, :1], Y), (X, np.c_[Y, Y])):
        with pytest.raises(ValueError, match=r"1 features|y has the shape"):
            model.partial_fit(*other)


def test_impossible_blocks():
    for blocks, message in [
        ((block for block in [(X, Y)]), "read only once"),
        ([], "no rows with a positive weight"),
        ([X, X], "must be"),
        ([(X, Y), (X[:, :1], Y)], "features"),
        ([(X, Y), (X, np.c_[Y, Y])], "in a block"),
        ([(X, Y), (X[:0], Y[:0])], "0 sample"),
        ([(X, Y), (X, Y, np.zeros(60))], "at least one non-zero"),
    ]:
        with pytest.raises(ValueError, match=message):
            LSSVMRegressor().fit_blocks(blocks)


@pytest.mark.parametrize(("solver", "n_landmarks"), [*((s, 1000) for s in SOLVERS), ("nystrom", 40)])
def test_intervals_hold_as_often_as_asked(solver, n_landmarks):
    """Few fresh rows to each of many fits, so that the fits differ by little beside what the rows do."""
    held = []
    for seed in range(25):
        model = LSSVMRegressor(solver=solver, n_landmarks=n_landmarks, uncertainty=True, random_state=0)
        fresh, y = rows(30, 1000 + seed)
        low, high = model.fit(*rows(100, seed)).predict_interval(fresh, 0.9)
        held.append((low <= y) & (y <= high))
    assert abs(np.mean(held) - 0.9) < 3.0 * np.sqrt(0.9 * 0.1 / np.size(held))


def test_spread_that_is_not_known():
    model = LSSVMRegressor().fit(X, Y)
    for asked in (partial(model.predict, return_std=True), model.predict_interval):
        with pytest.raises(ValueError, match="uncertainty=True"):
            asked(ASKED)
    assert np.isinf(model.set_params(uncertainty=True).fit(X[:2], Y[:2]).predict_interval(ASKED)).all()
    for coverage in (0, 1, -0.5, 2, np.nan):
        with pytest.raises(ValueError, match="between 0 and 1"):
            model.predict_interval(ASKED, coverage)


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("solver", SOLVERS)
def test_left_out_errors_are_those_of_brute_force(solver, weighted):
    weight = np.random.default_rng(3).uniform(0.2, 3.0, 60) * KEPT if weighted else np.ones(60)
    found = fitted(solver, X, Y, weight, uncertainty=True, tol=1e-12).loo_residuals_
    assert_allclose(found, left_out_errors(X, Y, weight), rtol=0, atol=1e-8)
    chosen = LSSVMRegressorCV(solver=solver).fit(X, Y, weight)
    expected = left_out_errors(X, Y, weight, C=chosen.best_C_, gamma=chosen.best_gamma_)
    assert_allclose(chosen.loo_residuals_, expected, rtol=0, atol=1e-8)
    score = np.sqrt(np.nansum(weight * expected**2) / weight.sum())
    assert chosen.best_score_ == pytest.approx(score, abs=1e-8)


@pytest.mark.parametrize("way", WAYS)
def test_pruned(way):
    model = fitted(way, *rows(200))
    expected, pruned = model.predict(ASKED), [model.pruned(m) for m in (3, 15, 500)]
    few, more, all_of_them = (np.abs(p.predict(ASKED) - expected).max() for p in pruned)
    assert few > 4 * more > 4 * all_of_them < 0.4 * NOISE
    assert len(pruned[0].dual_coef_) == 3 < 15 < len(model.dual_coef_)
    with pytest.raises(ValueError, match="n_landmarks"):
        model.pruned(0)


@pytest.mark.parametrize("solver", SOLVERS)
def test_outliers(solver):
    A, b = rows(200)
    wrong = np.arange(200) % 10 == 0
    b[wrong] += np.where(np.arange(20) % 3, 5.0, -5.0)
    plain, robust = (fitted(solver, A, b, robust_passes=passes) for passes in (0, 3))
    errors = [np.sqrt(np.mean((model.predict(ASKED) - function(ASKED)) ** 2)) for model in (plain, robust)]
    assert errors[1] < NOISE < 4 * NOISE < errors[0]
    assert robust.robust_weight_[wrong].max() < 0.01 < 0.9 < robust.robust_weight_[~wrong].mean()


def test_precomputed():
    K, between = kernel(X, X, 0.5).astype(float), kernel(ASKED, X, 0.5).astype(float)
    for solver, matrix in [("auto", np.tril(K)), ("cholesky", np.tril(K)), ("tiled", K)]:
        model = LSSVMRegressor("precomputed", solver=solver).fit(matrix, Y)
        assert_right("cholesky", model.predict(between), solution(X, Y))
    for options in ({"solver": "pcg"}, {"solver": "nystrom"}, {"uncertainty": True}):
        with pytest.raises(ValueError, match="precomputed kernel"):
            LSSVMRegressor("precomputed", **options).fit(K, Y)
    with pytest.raises(ValueError, match="no rows"):
        model.pruned(5)
    with pytest.raises(ValueError, match="square"):
        model.fit(K[:, :50], Y)
    assert {"partial_fit", "fit_blocks"}.isdisjoint(dir(model))
    with pytest.warns(LinAlgWarning, match="not positive definite"):
        assert np.isfinite(LSSVMRegressor("precomputed").fit(-K, Y).predict(between)).all()


@pytest.mark.parametrize("kernel", ["rbf", "linear", "poly", "laplacian"])
@pytest.mark.parametrize("solver", SOLVERS)
def test_no_prediction_is_nan(solver, kernel):
    model = fitted(solver, X, Y, kernel=kernel, tol=1e-6)
    for far in (1e160, 1e300, 1e305):
        if kernel == "poly":
            with pytest.raises(ValueError, match=r"60 rows overflow: .*scale them"):
                model.predict(far * np.sign(X))
        else:
            assert np.isfinite(model.predict(far * np.sign(X))).all()


# checks of finiteness by sums, those of scikit-learn
@pytest.mark.filterwarnings("ignore:(invalid value|overflow) encountered in reduce:RuntimeWarning")
@pytest.mark.parametrize("kernel", ["rbf", "linear", "poly", "laplacian"])
@pytest.mark.parametrize("solver", ["cholesky", "tiled", "pcg"])
def test_targets_that_overflow_are_said(solver, kernel):
    with pytest.raises(ValueError, match=r"scale (it|them), for example"):
        fitted(solver, X, 1.7e308 * np.sign(Y), kernel=kernel, tol=1e-6).predict(X)


def test_a_prediction_that_overflows_is_said_with_its_rows():
    few = np.r_[X[:3], 1e160 * X[:2]]
    with pytest.raises(ValueError, match=r"of 2 rows overflow.*scale them"):
        LSSVMRegressor("poly").fit(X, Y).predict(few)
    with pytest.raises(ValueError, match=r"of 1 rows overflow"):
        LSSVMRegressor("precomputed").fit(X @ X.T, Y).predict([[0.0] * 60, [1.7e308] * 60])


@pytest.mark.parametrize(
    ("parameters", "hidden", "reason"),
    [
        ({"robust_passes": 1}, {"partial_fit", "fit_blocks"}, "robust_passes=1 needs all rows at once"),
        ({"uncertainty": True}, {"partial_fit"}, "uncertainty=True needs all rows at once"),
        ({"kernel": "precomputed"}, {"partial_fit", "fit_blocks"}, "no rows that could come in parts"),
        ({}, set(), None),
    ],
)
def test_what_would_be_refused_is_not_there(parameters, hidden, reason):
    model = LSSVMRegressor(**parameters)
    assert {name for name in ("partial_fit", "fit_blocks") if not hasattr(model, name)} == hidden
    if hidden:
        with pytest.raises(AttributeError) as refusal:
            model.partial_fit(X, Y)
        assert reason in str(refusal.value.__cause__)


def test_blocks_that_change_between_passes_are_refused():
    random = np.random.default_rng(0)
    passes = []

    def noisy():
        """As many rows each time, with other noise."""
        for part in (slice(0, 30), slice(30, 60)):
            yield X[part], Y[part] + 0.01 * random.normal(size=30)

    def drifting():
        """The second block changes from the third pass on."""
        passes.append(None)
        yield X[:30], Y[:30]
        yield X[30:], Y[30:] + (len(passes) > 2)

    model = LSSVMRegressor(random_state=0)
    with pytest.raises(ValueError, match=r"Block 0 holds other numbers.*same each time"):
        model.fit_blocks(noisy)
    with pytest.raises(ValueError, match=r"Block 1 holds other numbers.*same each time"):
        model.fit_blocks(drifting)
    weighed = [(X, Y, np.ones(60))]
    weight = iter(range(1, 99))
    with pytest.raises(ValueError, match="Block 0 holds other numbers"):
        model.fit_blocks(lambda: [(X, Y, np.full(60, next(weight)))])
    assert model.fit_blocks(weighed).predict(X[:1]).shape == (1,)


@pytest.mark.parametrize("kernel", ["rbf", "laplacian"])
def test_robust_passes_count_a_weight_as_repeated_rows(kernel):
    A, b = rows(60, 3)
    b[::9] += 4.0
    counts = np.random.default_rng(1).integers(0, 4, 60)
    times = np.repeat(np.arange(60), counts)
    weighed = LSSVMRegressor(kernel, robust_passes=3).fit(A, b, counts)
    repeated = LSSVMRegressor(kernel, robust_passes=3).fit(A[times], b[times])
    assert_allclose(weighed.predict(ASKED), repeated.predict(ASKED), rtol=0, atol=1e-9)
    assert_allclose(weighed.robust_weight_[times], repeated.robust_weight_, rtol=0, atol=1e-9)


def test_a_warning_of_rows_added_points_to_the_caller():
    model = LSSVMRegressor(n_landmarks=40, random_state=0).partial_fit(X, Y)
    with pytest.warns(UserWarning, match="unspanned") as caught:
        model.partial_fit(np.vstack([X + 5.0, X + 10.0]), np.r_[Y, Y])
    assert caught[0].filename == __file__
