# SPDX-License-Identifier: BSD-3-Clause
"""A column with one value, such as the pressure of the vessel behind a valve, is told once a fit."""

import warnings

import numpy as np
import pandas as pd
import pytest
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from sklvalve.hybrid import ParallelHybridRegressor, SeriesHybridRegressor
from sklvalve.lssvm import LSSVMRegressor
from sklvalve.mechanism import ValidityWarning, ValveMechanismTransformer

ATMOSPHERE = 101325.0


def rows(n=200, p2=ATMOSPHERE):
    rng = np.random.default_rng(0)
    opening, p1 = rng.uniform([0.2, 5e5], [1.0, 6e5], (n, 2)).T
    flow = 40.0 * opening**2 * np.sqrt((p1 - p2) / 1e5) / 3600.0
    return np.column_stack([opening, p1, np.full(n, p2)]), flow


def warned(model, X, y):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.fit(X, y)
        model.predict(X)
        model.predict(X[:1])
    return caught


MODELS = [SeriesHybridRegressor(), ParallelHybridRegressor(ValveMechanismTransformer(kv_rated=40.0))]


@pytest.mark.parametrize("model", MODELS, ids=lambda model: type(model).__name__)
@pytest.mark.parametrize("p2", [ATMOSPHERE, 2e3, 4e5])
def test_one_warning_of_physics_for_all_rows_and_calls(model, p2):
    (told,) = warned(model, *rows(p2=p2))
    assert told.category is ValidityWarning
    assert str(told.message) == (
        "Of the columns of X that the regressor sees, 2 had one value in all 200 rows of the fit, so that it "
        "knows nothing of other values; leave out by regressor_columns what may change."
    )
    assert told.filename == __file__


def test_the_prediction_is_that_of_a_fit_without_the_column():
    X, y = rows()
    scaled = make_pipeline(StandardScaler(), LSSVMRegressor(gamma=0.5))
    with pytest.warns(ValidityWarning, match="the regressor sees, 2 had one value"):
        whole = SeriesHybridRegressor(regressor=scaled).fit(X, y)
    without = SeriesHybridRegressor(regressor=scaled, regressor_columns=[0, 1]).fit(X, y)
    np.testing.assert_allclose(whole.predict(X), without.predict(X), rtol=1e-9)


def test_columns_by_name_several_of_them():
    X, y = rows()
    frame = pd.DataFrame(X, columns=["opening", "p1", "p2"]).assign(temperature=293.15)
    model = SeriesHybridRegressor(ValveMechanismTransformer(opening="opening", p1="p1", p2="p2"))
    (told,) = warned(model, frame, y)
    assert "sees, 'p2', 'temperature' had one value" in str(told.message)
    (told,) = warned(model.set_params(regressor_columns=["opening", "p2"]), frame, y)
    assert "sees, 'p2' had one value" in str(told.message)
    (told,) = warned(SeriesHybridRegressor(regressor_columns=[2, 0]), X, y)
    assert "the regressor sees, 2 had one value" in str(told.message)


def test_silent_where_the_regressor_does_not_see_it():
    X, y = rows()
    assert warned(SeriesHybridRegressor(regressor_columns=[0]), X, y) == []
