# SPDX-License-Identifier: BSD-3-Clause
"""scikit-learn's whole check suite, and the checks that it does not run by itself."""

import pytest
from sklearn.utils import estimator_checks
from sklearn.utils.estimator_checks import parametrize_with_checks

from sklvalve.mechanism import ValveMechanismTransformer

# the suite's columns are no pressures: every role on column 0 fits a matrix of any width
ANYWHERE = {"opening": 0, "p1": 0, "p2": 0, "flow": 0, "warn": False}


@parametrize_with_checks(
    [
        ValveMechanismTransformer(**ANYWHERE),
        ValveMechanismTransformer(**ANYWHERE, kv_rated=40.0, fl=0.9, characteristic="parabolic"),
        ValveMechanismTransformer(
            **ANYWHERE,
            temperature=0,
            kv_rated=1.0,
            output="outlet_pressure",
            features=["dp", "outlet_pressure"],
        ),
        ValveMechanismTransformer(
            **ANYWHERE,
            temperature=0,
            kv_rated=10.0,
            fl=[[0.0, 0.9], [1.0, 0.8]],
            fd=0.4,
            nominal_size=0.05,
            inlet_pipe=0.08,
            features=["flow", "reynolds", "fr", "fp", "flp", "state"],
        ),
        ValveMechanismTransformer(
            **ANYWHERE, temperature=0, kv_rated=10.0, fluid="gas", molar_mass=0.029, gamma=1.4, xt=0.7
        ),
    ]
)
def test_the_suite(estimator, check):
    check(estimator)


BY_HAND = [
    "check_set_output_transform",
    "check_set_output_transform_pandas",
    "check_set_output_transform_polars",
    "check_global_output_transform_pandas",
    "check_global_set_output_transform_polars",
    "check_transformer_get_feature_names_out",
    "check_transformer_get_feature_names_out_pandas",
    "check_get_feature_names_out_error",
    "check_dataframe_column_names_consistency",
    "check_param_validation",
]


# they hand arrays to an estimator fitted on frames, of which scikit-learn itself warns
@pytest.mark.filterwarnings("ignore:X (has|does not have valid) feature names:UserWarning")
@pytest.mark.parametrize("name", BY_HAND)
def test_by_hand(name):
    check = getattr(estimator_checks, name, None)
    if check is None:
        pytest.skip(f"this scikit-learn has no {name}")
    if "polars" in name:
        pytest.importorskip("polars")
    check("ValveMechanismTransformer", ValveMechanismTransformer(**ANYWHERE))
