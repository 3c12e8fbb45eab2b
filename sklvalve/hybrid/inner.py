# SPDX-License-Identifier: BSD-3-Clause
"""What both hybrids do with the two models inside them: which rows, columns and weights each of them gets."""

import warnings

import numpy as np
from sklearn.base import clone
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils import _safe_indexing
from sklearn.utils.metadata_routing import (
    MetadataRouter,
    MethodMapping,
    _raise_for_params,
    _routing_enabled,
    get_routing_for_object,
    process_routing,
)
from sklearn.utils.validation import (
    _check_method_params,
    _check_sample_weight,
    has_fit_parameter,
    validate_data,
)

from sklvalve.lssvm import LSSVMRegressor
from sklvalve.mechanism import ValidityWarning, ValveMechanismTransformer
from sklvalve.recording.errors import shown

# columns that a message names
_TOLD = 5


def mechanism_or_default(mechanism):
    """The mechanism itself, or that of a valve with its columns in the order opening, p1, p2."""
    return ValveMechanismTransformer() if mechanism is None else mechanism


def mechanism_of(hybrid):
    """The mechanism that a hybrid works with: the fitted one, or the one that a fit would take."""
    fitted = getattr(hybrid, "mechanism_", None)
    return mechanism_or_default(hybrid.mechanism) if fitted is None else fitted


def regressor_or_default(regressor):
    """The regressor itself, or an LS-SVM of scaled columns, because Pa and openings differ by ten decades."""
    if regressor is not None:
        return regressor
    steps = [StandardScaler(), LSSVMRegressor()]
    if _routing_enabled():
        steps = [step.set_fit_request(sample_weight=True) for step in steps]
    return make_pipeline(*steps)


class InnerModelsMixin:
    """`set_params` of an estimator whose `mechanism` and `regressor` may be None."""

    def set_params(self, **params):
        """Set parameters, those of the models inside as ``mechanism__name`` and ``regressor__name``.

        Parameters
        ----------
        **params : dict

        Returns
        -------
        self : estimator

        Raises
        ------
        ValueError
            If a name is no parameter, or belongs to a model that is None.
        """
        for key in params:
            name, inside, _ = key.partition("__")
            if (
                inside
                and name in ("mechanism", "regressor")
                and params.get(name, getattr(self, name)) is None
            ):
                raise ValueError(
                    f"{key} cannot be set, because {name} is None and its default is made in fit: hand a "
                    f"model in as {name}=..., for example {_EXAMPLES[name]}."
                )
        return super().set_params(**params)


_EXAMPLES = {
    "mechanism": "ValveMechanismTransformer()",
    "regressor": "LSSVMRegressor()",
}


def clone_model(model):
    """An unfitted copy; a mechanism need not be a scikit-learn estimator."""
    return clone(model, safe=hasattr(model, "get_params"))


def checked_table(estimator, X, y="no_validation", *, reset=False):
    """Check X, and y where given, as scikit-learn does; return X as it came where it is a data frame.

    A mechanism finds its columns by name, which an array has lost.
    """
    with_y = not isinstance(y, str)
    if with_y:
        array, y = validate_data(estimator, X, y, y_numeric=True, reset=reset)
    else:
        array = validate_data(estimator, X, reset=reset)
    table = X if hasattr(X, "columns") and hasattr(X, "shape") else array
    return (table, y.astype(np.float64)) if with_y else table


def take_rows(X, rows):
    """Rows of an array or a data frame by their positions."""
    return X if len(rows) == X.shape[0] else _safe_indexing(X, rows)


def take_columns(X, columns):
    """Columns of an array or a data frame by names or positions; None takes all."""
    if columns is None:
        return X
    columns = list(columns)
    names = list(getattr(X, "columns", []))
    unknown = [column for column in columns if isinstance(column, str) and column not in names]
    if unknown:
        had = f"the columns are {', '.join(map(str, names))}" if names else "the columns have no names"
        raise ValueError(
            f"regressor_columns holds {unknown[0]!r}, but {had}; give names or positions of columns."
        )
    outside = [column for column in columns if not isinstance(column, str) and not -1 < column < X.shape[1]]
    if outside:
        raise ValueError(
            f"regressor_columns holds {outside[0]!r}, but X has {X.shape[1]} columns, from 0 on."
        )
    return _safe_indexing(X, [names.index(c) if isinstance(c, str) else int(c) for c in columns], axis=1)


def kept_columns(columns):
    """Columns as a list of one's own, which nobody changes after the fit; None is all."""
    return None if columns is None else list(columns)


def seen_columns(columns, names):
    """Positions of the columns that `take_columns` takes of a table with these names."""
    names = list(names)
    if columns is None:
        return set(range(len(names)))
    return {names.index(column) if isinstance(column, str) else int(column) for column in columns}


def usable_rows(values, meaning, remedy):
    """Positions of the rows where `values` is finite; warns of the others, and raises where there is none."""
    rows = np.flatnonzero(np.isfinite(values))
    missing = len(values) - len(rows)
    if not len(rows):
        raise ValueError(f"{meaning} in none of the {len(values)} rows: {remedy}.")
    if missing:
        warnings.warn(
            f"{meaning} in {len(rows)} of {len(values)} rows; left out: {missing}.",
            ValidityWarning,
            stacklevel=5,
        )
    return rows


def fit_regressor(regressor, X, target, columns, keywords):
    """Fit a regressor to its columns of X; columns with one value are told in one warning.

    A scaler that is given weights takes the root of what rounding leaves of the variance of such a column,
    which may be negative; it knows and mends that, so numpy's own warning would only be noise.
    """
    table = take_columns(X, columns)
    values = np.asarray(table)
    constant = np.flatnonzero((values == values[:1]).all(axis=0)) if len(values) > 1 else []
    if not len(constant):
        return regressor.fit(table, target, **keywords)
    names = getattr(table, "columns", range(X.shape[1]) if columns is None else list(columns))
    told = ", ".join(shown(names[k]) for k in constant[:_TOLD])
    more = f" and {len(constant) - _TOLD} more" if len(constant) > _TOLD else ""
    warnings.warn(
        f"Of the columns of X that the regressor sees, {told}{more} had one value in all {len(values)} rows "
        "of the fit, so that it knows nothing of other values; leave out by regressor_columns what may "
        "change.",
        ValidityWarning,
        stacklevel=5,
    )
    with np.errstate(invalid="ignore"):
        return regressor.fit(table, target, **keywords)


def one_per_row(values, X, what):
    """`values` as floats, one for each row of X."""
    values = np.asarray(values, dtype=np.float64)
    if values.shape == (X.shape[0], 1):
        values = values[:, 0]
    if values.shape != (X.shape[0],):
        raise ValueError(
            f"{what} must give one number for each of {X.shape[0]} rows, got shape {values.shape}."
        )
    return values


def fit_router(estimator, mechanism, regressor):
    """Routing of what `fit` is given on to the `fit` of both models inside."""
    to_fit = MethodMapping().add(caller="fit", callee="fit")
    router = MetadataRouter(owner=estimator)
    return router.add(mechanism=mechanism, method_mapping=to_fit).add(
        regressor=regressor, method_mapping=to_fit
    )


def fit_keywords(estimator, X, sample_weight, parameters, mechanism, regressor):
    """Keywords for the `fit` of mechanism and regressor, and the weights among the latter, or None.

    With metadata routing they are what each asked for; without it, the weights for each that takes weights.
    """
    _raise_for_params(parameters, estimator, "fit")
    if sample_weight is not None:
        sample_weight = _checked_weight(sample_weight, X)
    if _routing_enabled():
        if sample_weight is not None:
            parameters = {**parameters, "sample_weight": sample_weight}
        routed = process_routing(estimator, "fit", **parameters)
        for_regressor = dict(routed.regressor.fit)
        return dict(routed.mechanism.fit), for_regressor, for_regressor.get("sample_weight")
    if sample_weight is None:
        return {}, {}, None
    for_regressor = weight_keywords(regressor, sample_weight)
    if not for_regressor:
        raise TypeError(
            f"sample_weight was given, but the regressor {type(regressor).__name__} takes none in fit; "
            "leave it out or choose a regressor with weights."
        )
    return weight_keywords(mechanism, sample_weight), for_regressor, sample_weight


def weight_keywords(model, weight):
    """Keywords that give a model, or the steps of a pipeline, its weights; empty where it takes none.

    With metadata routing a model that passes on gets them only where something inside asked for them, and a
    plain one unless it said that it wants none.
    """
    if _routing_enabled():
        routing = get_routing_for_object(model)
        if isinstance(routing, MetadataRouter):
            return {"sample_weight": weight} if routing.consumes("fit", ["sample_weight"]) else {}
        if routing.fit.requests.get("sample_weight") is False:
            return {}
    if has_fit_parameter(model, "sample_weight"):
        return {"sample_weight": weight}
    if isinstance(model, Pipeline):
        takers = [name for name, step in model.steps if has_fit_parameter(step, "sample_weight")]
        if model.steps[-1][0] in takers:
            return {f"{name}__sample_weight": weight for name in takers}
    return {}


def could_take_weights(model):
    """Whether a model, or the last step of a pipeline, has weights in its `fit`, asked for or not."""
    last = model.steps[-1][1] if isinstance(model, Pipeline) else model
    return has_fit_parameter(last, "sample_weight")


def keywords_of_rows(X, keywords, rows):
    """Keywords with one value for each row, for some of the rows only."""
    return _check_method_params(X, keywords, indices=rows)


def _checked_weight(sample_weight, X):
    weight = _check_sample_weight(sample_weight, X, dtype=np.float64, ensure_non_negative=True)
    if not weight.any():
        raise ValueError("The sample weights of all rows are zero; give at least one row a positive one.")
    return weight
