# SPDX-License-Identifier: BSD-3-Clause
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from sklearn.linear_model import LinearRegression
from sklearn.metrics import make_scorer, mean_absolute_percentage_error, root_mean_squared_error
from sklearn.model_selection import GridSearchCV, cross_val_score, cross_validate

from sklvalve.metrics import (
    SCORERS,
    err_max,
    mape,
    neg_err_max_scorer,
    neg_mape_scorer,
    neg_rmse_scorer,
    rmse,
)

numbers = st.floats(-1e6, 1e6, allow_subnormal=False)


@st.composite
def measured_and_predicted(draw):
    n = draw(st.integers(1, 30))
    y_true = draw(arrays(float, n, elements=numbers))
    y_true[draw(st.integers(0, n - 1))] = draw(st.floats(0.1, 1e6))
    return y_true, draw(arrays(float, n, elements=numbers))


@settings(deadline=None, max_examples=50)
@given(measured_and_predicted())
def test_no_mean_exceeds_its_largest(pair):
    y_true, y_pred = pair
    assert mape(y_true, y_pred) <= err_max(y_true, y_pred) * (1 + 1e-12)
    assert rmse(y_true, y_pred) <= np.abs(y_true - y_pred).max() * (1 + 1e-12)


@settings(deadline=None, max_examples=50)
@given(measured_and_predicted(), st.floats(1e-3, 1e3), st.sampled_from([-1.0, 1.0]))
def test_percentages_do_not_depend_on_the_unit_and_rmse_scales_with_it(pair, size, sign):
    y_true, y_pred = pair
    # A row that sits on the cut-off to the last bit may fall on either side of it after scaling.
    min_flow = 0.0123456789 * np.abs(y_true).max()
    factor = size * sign
    for metric in (mape, err_max):
        scaled = metric(factor * y_true, factor * y_pred, min_flow=size * min_flow)
        np.testing.assert_allclose(scaled, metric(y_true, y_pred, min_flow=min_flow), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(
        rmse(factor * y_true, factor * y_pred), size * rmse(y_true, y_pred), rtol=1e-9, atol=1e-12
    )


@settings(deadline=None, max_examples=30)
@given(measured_and_predicted(), st.randoms(use_true_random=False))
def test_a_weight_of_k_is_the_row_k_times(pair, random):
    y_true, y_pred = pair
    count = np.array([random.randint(0, 3) for _ in y_true])
    count[np.argmax(np.abs(y_true))] += 1
    repeated = np.repeat(y_true, count), np.repeat(y_pred, count)
    min_flow = 0.01 * np.abs(y_true).max()
    for value, expected in [
        (mape(y_true, y_pred, min_flow=min_flow, sample_weight=count), mape(*repeated, min_flow=min_flow)),
        (rmse(y_true, y_pred, sample_weight=count), rmse(*repeated)),
    ]:
        np.testing.assert_allclose(value, expected, rtol=1e-10, atol=1e-12)


def test_values_agree_with_scikit_learn_away_from_zero():
    rng = np.random.default_rng(0)
    y_true = rng.uniform(1.0, 2.0, 100) * rng.choice([-1, 1], 100)
    y_pred = y_true + rng.normal(size=100)
    weight = rng.uniform(size=100)
    np.testing.assert_allclose(
        mape(y_true, y_pred, sample_weight=weight),
        100 * mean_absolute_percentage_error(y_true, y_pred, sample_weight=weight),
        rtol=1e-12,
    )
    np.testing.assert_allclose(
        rmse(y_true, y_pred, sample_weight=weight),
        root_mean_squared_error(y_true, y_pred, sample_weight=weight),
        rtol=1e-12,
    )


def test_rows_under_the_cut_off_are_left_out():
    y_true, y_pred = [100.0, 0.9, 0.0, -50.0], [110.0, 5.0, 1.0, -50.0]
    assert mape(y_true, y_pred) == pytest.approx(5.0)
    assert err_max(y_true, y_pred) == pytest.approx(10.0)
    assert mape(y_true, y_pred, min_flow=60) == pytest.approx(10.0)
    assert err_max(y_true, y_pred, min_flow=0) == pytest.approx(100 * 4.1 / 0.9)


@pytest.mark.parametrize("metric", [mape, err_max])
def test_no_row_above_the_cut_off_is_a_clear_error(metric):
    with pytest.raises(ValueError, match="No row of y_true reaches min_flow=5"):
        metric([1.0, 2.0], [1.0, 2.0], min_flow=5)
    with pytest.raises(ValueError, match="No row of y_true"):
        metric([0.0, 0.0], [1.0, 2.0])
    with pytest.raises(ValueError, match="min_flow must be"):
        metric([1.0], [1.0], min_flow=-1)


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="inconsistent numbers"):
        rmse([1.0, 2.0], [1.0])
    with pytest.raises(ValueError, match="y_pred contains NaN"):
        mape([1.0, 2.0], [1.0, np.nan])
    with pytest.raises(ValueError, match="one column"):
        rmse(np.ones((3, 2)), np.ones((3, 2)))
    with pytest.raises(ValueError, match="not be negative"):
        rmse([1.0, 2.0], [1.0, 2.0], sample_weight=[1, -1])
    with pytest.raises(ValueError, match="every row is zero"):
        rmse([1.0, 2.0], [1.0, 2.0], sample_weight=[0, 0])
    with pytest.raises(ValueError, match="zero sample_weight"):
        mape([1.0, 0.0], [1.0, 2.0], sample_weight=[0, 1])


@pytest.mark.parametrize(
    ("scorer", "metric"), [(neg_rmse_scorer, rmse), (neg_mape_scorer, mape), (neg_err_max_scorer, err_max)]
)
def test_scorers_are_negative_and_pickle(scorer, metric):
    rng = np.random.default_rng(1)
    X = rng.normal(size=(60, 2))
    y = 5 + X @ [1.0, 2.0] + rng.normal(size=60)
    model = LinearRegression().fit(X, y)
    assert scorer(model, X, y) == -metric(y, model.predict(X))
    assert pickle.loads(pickle.dumps(scorer))(model, X, y) == scorer(model, X, y)
    assert (cross_val_score(model, X, y, scoring=scorer, cv=3) < 0).all()


def test_all_scorers_go_by_name_into_a_search():
    X = np.linspace(1.0, 2.0, 40)[:, None]
    y = 3.0 * X[:, 0] + np.tile([0.01, -0.01], 20)
    found = cross_validate(LinearRegression(), X, y, scoring=SCORERS, cv=4)
    assert {name.removeprefix("test_") for name in found if name.startswith("test_")} == set(SCORERS)
    for name, scorer in SCORERS.items():
        np.testing.assert_array_equal(
            found[f"test_{name}"], cross_val_score(LinearRegression(), X, y, scoring=scorer, cv=4)
        )
    grid = {"fit_intercept": [False, True]}
    search = GridSearchCV(LinearRegression(), grid, scoring=SCORERS, refit="neg_mape", cv=4).fit(X, y)
    assert search.best_score_ == search.cv_results_["mean_test_neg_mape"].max()


@settings(deadline=None, max_examples=50)
@given(measured_and_predicted(), st.floats(1e-3, 1e6))
def test_percent_of_a_span_leaves_no_row_out(pair, span):
    y_true, y_pred = pair
    error = np.abs(y_true - y_pred)
    np.testing.assert_allclose(
        mape(y_true, y_pred, span=span), 100.0 * error.mean() / span, rtol=1e-9, atol=1e-9
    )
    np.testing.assert_allclose(
        err_max(y_true, y_pred, span=span), 100.0 * error.max() / span, rtol=1e-9, atol=1e-9
    )
    np.testing.assert_allclose(
        rmse(y_true, y_pred, span=span), 100.0 * rmse(y_true, y_pred) / span, rtol=1e-9, atol=1e-9
    )
    assert mape(y_true, y_pred, span=span) <= rmse(y_true, y_pred, span=span) * (1 + 1e-9) + 1e-9


@pytest.mark.parametrize("metric", [rmse, mape, err_max])
def test_the_measured_span(metric):
    y_true, y_pred = [-1.0, 0.0, 3.0], [-1.0, 0.5, 3.0]
    assert metric(y_true, y_pred, span="measured") == metric(y_true, y_pred, span=4.0)
    assert metric([0.0, 0.0], [0.0, 1.0], span=10.0) > 0.0
    assert np.isfinite(metric([1e308, -1e308], [-1e308, 1e308], span=1e308))


@pytest.mark.parametrize("metric", [rmse, mape, err_max])
@pytest.mark.parametrize("span", [0.0, -1.0, np.nan, np.inf, "range", True])
def test_a_span_that_is_none_is_told(metric, span):
    with pytest.raises(ValueError, match='span must be a number above 0 or "measured", and got'):
        metric([1.0, 2.0], [1.0, 2.0], span=span)


@pytest.mark.parametrize("metric", [rmse, mape, err_max])
def test_equal_values_have_no_span(metric):
    with pytest.raises(ValueError, match="all measured values are equal"):
        metric([2.0, 2.0], [1.0, 2.0], span="measured")


@pytest.mark.parametrize("metric", [mape, err_max])
def test_a_span_and_a_least_flow_are_two_answers(metric):
    with pytest.raises(ValueError, match="give only one"):
        metric([1.0, 2.0], [1.0, 2.0], span=1.0, min_flow=0.1)


def test_weights_and_scorers_with_a_span():
    assert mape([1.0, 2.0], [2.0, 2.0], span=10.0, sample_weight=[3.0, 1.0]) == pytest.approx(7.5)
    assert rmse([1.0, 2.0], [2.0, 2.0], span=10.0, sample_weight=[1.0, 0.0]) == pytest.approx(10.0)
    X, y = np.arange(8.0)[:, None], np.array([0.0, 1, 2, 3, 4, 5, 6, 8])
    scorer = make_scorer(err_max, greater_is_better=False, span="measured")
    fitted = LinearRegression().fit(X, y)
    assert scorer(fitted, X, y) == -err_max(y, fitted.predict(X), span=8.0)
