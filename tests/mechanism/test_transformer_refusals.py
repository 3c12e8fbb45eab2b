# SPDX-License-Identifier: BSD-3-Clause
"""What the transformer warns of, and what it refuses."""

import pytest
from sklearn.exceptions import NotFittedError

from sklvalve.mechanism import ValidityWarning, ValveMechanismTransformer
from tests.mechanism.valves import COLUMNS, ROLES, by_position, duties


class TestOutsideValidity:
    def test_said_once_with_the_count(self):
        X = duties()
        X[:3, 1] = 1.2
        with pytest.warns(ValidityWarning, match="3 of 200 rows have an opening outside") as said:
            by_position(features=["kv", "flow"]).fit(X).transform(X)
        assert len(said) == 1

    @pytest.mark.parametrize("method", ["transform", "predict"])
    def test_pressures_in_kilopascal_are_said(self, method):
        X = duties()
        valve = by_position().fit(X)
        X[:, 2:4] /= 1e3
        with pytest.warns(ValidityWarning, match="200 of 200 rows have liquid at or below its vapour"):
            getattr(valve, method)(X)

    def test_choked_outlet_pressure_is_said(self):
        X = duties()
        valve = by_position(output="outlet_pressure").fit(X)
        with pytest.warns(ValidityWarning, match="ask for a flow that the valve cannot pass"):
            valve.predict(X)


class TestBadInput:
    @pytest.mark.parametrize(
        ("settings", "message"),
        [
            ({"p1": "P1"}, "p1='P1' is a name, but the columns have no names: give its position"),
            ({"p1": 9}, r"p1=9 is no column of the data, which have 5: set p1="),
            ({"features": ["dp", "delta"]}, "unknown feature 'delta' in features: use some of opening, dp"),
            (
                {"features": "dp"},
                "The 'features' parameter of ValveMechanismTransformer must be an array-like",
            ),
            ({"p2": None, "features": ["dp"]}, "this needs the role 'p2', which has no column"),
            ({"kv_rated": None, "features": ["kv"]}, "give kv_rated="),
            ({"fl": None, "features": ["choked"]}, "give fl="),
            ({"fluid": "mead"}, "unknown fluid 'mead'"),
            ({"characteristic": "equal"}, "unknown characteristic 'equal'"),
            ({"rangeability": 1.0}, "The 'rangeability' parameter of ValveMechanismTransformer must be"),
            ({"fluid": "oil", "density": 870.0}, "the fluid 'oil' has no vapour_pressure"),
            (
                {"fluid": "oil", "density": 870.0, "vapour_pressure": 9.0},
                "the fluid 'oil' has no critical_pressure",
            ),
        ],
    )
    def test_fit_says_what_is_wrong(self, settings, message):
        with pytest.raises(ValueError, match=message):
            by_position(**settings).fit(duties())

    def test_unknown_column_name(self):
        pd = pytest.importorskip("pandas")
        frame = pd.DataFrame(duties(), columns=COLUMNS)
        with pytest.raises(
            ValueError, match=r"p1='P1' is not a column of the data[.] Columns: t, h, pin, pout, F"
        ):
            ValveMechanismTransformer(**{**ROLES, "p1": "P1"}).fit(frame)

    def test_flow_is_needed_for_the_outlet_pressure(self):
        X = duties()
        valve = by_position(flow=None, output="outlet_pressure").fit(X)
        with pytest.raises(ValueError, match="this needs the role 'flow'"):
            valve.forward(X, 10.0)

    def test_one_parameter_for_each_row(self):
        X = duties()
        with pytest.raises(
            ValueError, match=r"parameter must have one value for each of the 200 rows; got shape \(3,\)"
        ):
            by_position().fit(X).forward(X, [1.0, 2.0, 3.0])

    def test_not_fitted(self):
        with pytest.raises(NotFittedError):
            by_position().forward(duties(), 1.0)
