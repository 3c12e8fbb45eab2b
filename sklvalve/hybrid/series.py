# SPDX-License-Identifier: BSD-3-Clause
"""Series hybrid: data give the parameter that physics does not know."""

import warnings
from numbers import Real
from typing import ClassVar

import numpy as np
from sklearn.base import BaseEstimator, RegressorMixin, _fit_context
from sklearn.utils._param_validation import HasMethods, Interval, StrOptions
from sklearn.utils.validation import check_is_fitted

from sklvalve._refits import whole_or_nothing
from sklvalve.hybrid.inner import (
    InnerModelsMixin,
    checked_table,
    clone_model,
    could_take_weights,
    fit_keywords,
    fit_regressor,
    fit_router,
    kept_columns,
    keywords_of_rows,
    mechanism_or_default,
    one_per_row,
    regressor_or_default,
    take_columns,
    take_rows,
    usable_rows,
    weight_keywords,
)
from sklvalve.hybrid.outputs import OutputsMixin
from sklvalve.mechanism import ValidityWarning

# of the largest parameter: a valve that is shut tightly leaks less, and no meter tells less from nothing
_LEAST = 1e-3


class SeriesHybridRegressor(InnerModelsMixin, OutputsMixin, RegressorMixin, BaseEstimator):
    r"""Physics with an unknown parameter that a regressor learns.

    `fit` inverts the mechanism row by row for its parameter and lets the regressor learn the parameter from
    X; `predict` puts the predicted parameter into the mechanism. Use it where the equations are known but
    for one quantity, such as the capacity of an unknown trim; where physics is complete but slightly wrong,
    :class:`ParallelHybridRegressor` corrects its output instead.

    Parameters
    ----------
    mechanism : object, default=None
        Physics with ``forward(X, parameter)``, which gives the output, and ``invert(X, y)``, which gives the
        parameter, NaN where the output says nothing about it. Optional: ``fit(X, y)``, called first;
        ``sensitivity(X, parameter)``, the derivative of the output by the parameter;
        ``for_output(output, column)``, itself for another ``output``, and ``output_columns``, the positions
        of columns that hold one. None is :class:`~sklvalve.mechanism.ValveMechanismTransformer` with the
        columns opening, p1, p2.
    regressor : object, default=None
        Any regressor. None is :class:`~sklvalve.lssvm.LSSVMRegressor` behind a
        :class:`~sklearn.preprocessing.StandardScaler`.
    link : {"identity", "log"}, default="identity"
        What the regressor learns: the parameter, or its logarithm, which keeps the prediction positive. With
        "log", rows whose parameter is negative are left out, and one from zero up to `floor`, as of a shut
        valve, counts as `floor`.
    regressor_columns : list of str or int, default=None
        Columns of X that the regressor sees, by name or position; None is all.
    sensitivity_weights : bool, default=True
        Weight each row by the square of the mechanism's sensitivity, where the mechanism tells it and the
        regressor takes weights (with metadata routing: asks for them). The noise of the parameter is that of
        the output over the sensitivity, so rows near zero pressure drop would otherwise drown the rest.

    floor : float, default=None
        Least parameter that is learnt with the link "log", in the mechanism's unit; None is a thousandth of
        the largest in the rows of the fit.

    Attributes
    ----------
    link_ : {"identity", "log"}
        The `link` of the fit, by which the hybrid predicts.
    regressor_columns_ : list of str or int, or None
        The `regressor_columns` of the fit, likewise.
    floor_ : float or None
        The `floor` of the fit; None with the link "identity".
    mechanism_ : object
        Fitted copy of the mechanism.
    regressor_ : object
        Fitted copy of the regressor.
    n_features_in_ : int
        Number of columns seen in `fit`.
    feature_names_in_ : ndarray of shape (`n_features_in_`,)
        Their names, where X had names.

    See Also
    --------
    ParallelHybridRegressor : Physics plus a learnt residual.

    Notes
    -----
    Equations 14 to 16 of the paper in their static form: :math:`y = g(x, P)` with :math:`P = f(x)` unknown.
    With the valve's mechanism, :math:`f` is the flow coefficient :math:`K_v`, which carries the paper's
    area :math:`f(x)`, and y is flow or outlet pressure. With sensitivity :math:`s_i = \partial g / \partial
    P` the rows are weighted by :math:`s_i^2`, and by :math:`(s_i P_i)^2` for the link "log". These weights
    are scaled so that their sum stays that of the `sample_weight` given, or the number of rows. So choose the
    C of an LS-SVM as for rows without weights: near the variance of what it learns over that of its noise.
    Where the mechanism gives no number `predict` is NaN, which metrics refuse: mask such rows. Metadata given
    to `fit` reaches the mechanism and the regressor by scikit-learn's routing; without routing,
    `sample_weight` reaches whichever of them takes it.

    To search over parameters of the two models, as ``regressor__C``, hand the models in: None has none to be
    set.

    Outside the rows of the fit an LS-SVM falls back to its bias, and so does the default's parameter. Where
    the parameter follows a line there, as the logarithm of an equal-percentage trim's capacity does, take
    ``ParallelHybridRegressor(LinearRegression(), make_pipeline(StandardScaler(), LSSVMRegressor(C=10)))`` as
    the regressor: on flows outside the trained box it erred by 0.24 t/h, the default by 2.1, of 40 t/h.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.hybrid import SeriesHybridRegressor
    >>> from sklvalve.mechanism import liquid_flow
    >>> rng = np.random.default_rng(0)
    >>> opening, p1, p2 = rng.uniform([0.2, 5e5, 2e5], [1.0, 6e5, 4e5], (200, 3)).T
    >>> flow = liquid_flow(40 * 50 ** (opening - 1), p1, p2, 998.2)
    >>> X = np.column_stack([opening, p1, p2])
    >>> model = SeriesHybridRegressor(link="log", regressor_columns=[0]).fit(X, flow)
    >>> model.predict_parameter([[0.5, 6e5, 3e5]]).round(1)
    array([5.7])

    The same f(x) gives the outlet pressure, from opening, p1 and the flow:

    >>> behind = model.for_output("outlet_pressure")
    >>> through = np.column_stack([opening, p1, flow])
    >>> bool(np.median(np.abs(behind.predict(through) / p2 - 1)) < 0.02)
    True

    A search over both models inside:

    >>> from sklearn.model_selection import GridSearchCV
    >>> from sklvalve.lssvm import LSSVMRegressor
    >>> from sklvalve.mechanism import ValveMechanismTransformer
    >>> model = SeriesHybridRegressor(ValveMechanismTransformer(), LSSVMRegressor(), regressor_columns=[0])
    >>> search = GridSearchCV(model, {"mechanism__fl": [None, 0.9], "regressor__C": [1e-6, 1e3]}).fit(X, flow)
    >>> search.best_params_["regressor__C"]
    1000.0
    """

    _parameter_constraints: ClassVar[dict] = {
        "mechanism": [HasMethods(["forward", "invert"]), None],
        "regressor": [HasMethods(["fit", "predict"]), None],
        "link": [StrOptions({"identity", "log"})],
        "regressor_columns": ["array-like", None],
        "sensitivity_weights": ["boolean"],
        "floor": [Interval(Real, 0, None, closed="neither"), None],
    }

    def __init__(
        self,
        mechanism=None,
        regressor=None,
        *,
        link="identity",
        regressor_columns=None,
        sensitivity_weights=True,
        floor=None,
    ):
        self.mechanism = mechanism
        self.regressor = regressor
        self.link = link
        self.regressor_columns = regressor_columns
        self.sensitivity_weights = sensitivity_weights
        self.floor = floor

    def get_metadata_routing(self):
        """Metadata routing: `fit` passes on to the `fit` of the mechanism and of the regressor.

        Returns
        -------
        routing : MetadataRouter
        """
        return fit_router(self, mechanism_or_default(self.mechanism), regressor_or_default(self.regressor))

    @_fit_context(prefer_skip_nested_validation=False)
    @whole_or_nothing
    def fit(self, X, y, sample_weight=None, **fit_params):
        """Invert the mechanism and learn its parameter.

        Parameters
        ----------
        X : array-like or data frame of shape (n_samples, n_features)
            Operating conditions. A data frame reaches mechanism and regressor as it is.
        y : array-like of shape (n_samples,)
            Measured output of the mechanism.
        sample_weight : float or array-like of shape (n_samples,), default=None
            Non-negative weights of the rows.
        **fit_params : dict
            Further metadata, with metadata routing only.

        Returns
        -------
        self : SeriesHybridRegressor
            The fitted model.

        Raises
        ------
        ValueError
            If the mechanism can be inverted in no row, or the data are not finite numbers.
        TypeError
            If weights are given to a regressor that takes none.

        Warns
        -----
        sklvalve.mechanism.ValidityWarning
            If the mechanism can be inverted in some rows only, with their number; if parameters are raised to
            the `floor`; if columns that the regressor sees have one value in all rows, such as a constant
            outlet pressure.
        UserWarning
            If metadata routing is on and the regressor does not ask for the weights that it could take.
        """
        X, y = checked_table(self, X, y, reset=True)
        self.mechanism_ = clone_model(mechanism_or_default(self.mechanism))
        regressor = clone_model(regressor_or_default(self.regressor))
        for_mechanism, for_regressor, weight = fit_keywords(
            self, X, sample_weight, fit_params, self.mechanism_, regressor
        )
        if hasattr(self.mechanism_, "fit"):
            self.mechanism_.fit(X, y, **for_mechanism)
        parameter = one_per_row(self.mechanism_.invert(X, y), X, "invert of the mechanism")
        self.link_, self.regressor_columns_ = self.link, kept_columns(self.regressor_columns)
        self.floor_ = None
        if self.link == "log":
            parameter = self._above_floor(parameter)
        rows = usable_rows(
            parameter,
            "The mechanism can be inverted for its parameter",
            "check units and columns, and that pressure drop and output are not zero",
        )
        X_rows, parameter = take_rows(X, rows), parameter[rows]
        keywords = keywords_of_rows(X, for_regressor, rows)
        if self.sensitivity_weights and hasattr(self.mechanism_, "sensitivity"):
            given = np.ones(len(rows)) if weight is None else weight[rows]
            weights = weight_keywords(regressor, self._weight_by_sensitivity(X_rows, parameter, given))
            if not weights and could_take_weights(regressor):
                warnings.warn(
                    f"The regressor {type(regressor).__name__} does not ask for sample_weight, so the rows "
                    "are not weighted by sensitivity; call set_fit_request(sample_weight=True) on it, or on "
                    "the steps of a pipeline, or set sensitivity_weights=False.",
                    UserWarning,
                    stacklevel=4,
                )
            keywords.update(weights)
        target = np.log(parameter) if self.link == "log" else parameter
        self.regressor_ = fit_regressor(regressor, X_rows, target, self.regressor_columns_, keywords)
        return self

    def predict_parameter(self, X):
        """Predict the parameter of the mechanism, the paper's f(x).

        Parameters
        ----------
        X : array-like or data frame of shape (n_samples, n_features)
            Operating conditions.

        Returns
        -------
        parameter : ndarray of shape (n_samples,)
            In the mechanism's unit; m3/h for the flow coefficient of a valve.
        """
        check_is_fitted(self)
        X = checked_table(self, X)
        return self._parameter(X)

    def predict(self, X):
        """Predict the output of the mechanism with the predicted parameter.

        Parameters
        ----------
        X : array-like or data frame of shape (n_samples, n_features)
            Operating conditions.

        Returns
        -------
        y : ndarray of shape (n_samples,)
            In the mechanism's unit; NaN where the mechanism gives none.
        """
        check_is_fitted(self)
        X = checked_table(self, X)
        return one_per_row(self.mechanism_.forward(X, self._parameter(X)), X, "forward of the mechanism")

    def _parameter(self, X):
        values = self.regressor_.predict(take_columns(X, self.regressor_columns_))
        values = one_per_row(values, X, "predict of the regressor")
        return np.exp(values) if self.link_ == "log" else values

    def _above_floor(self, parameter):
        """Parameters whose logarithm is learnt: NaN where negative, and raised to the floor."""
        parameter = np.where(parameter >= 0.0, parameter, np.nan)
        largest = np.max(parameter, initial=0.0, where=np.isfinite(parameter))
        self.floor_ = float(_LEAST * largest if self.floor is None else self.floor)
        low = parameter < self.floor_
        if not largest:
            # nothing says how large a parameter is
            return np.full_like(parameter, np.nan)
        if low.any():
            warnings.warn(
                f"The parameter of {np.count_nonzero(low)} of {len(parameter)} rows is under "
                f"{self.floor_:.3g}, as of a shut valve, and counts as that, because its logarithm has no "
                "lower end; set floor=..., or link='identity'.",
                ValidityWarning,
                stacklevel=5,
            )
        return np.maximum(parameter, self.floor_)

    def _weight_by_sensitivity(self, X, parameter, given):
        slope = one_per_row(self.mechanism_.sensitivity(X, parameter), X, "sensitivity of the mechanism")
        weight = (slope * parameter if self.link == "log" else slope) ** 2
        weight = np.where(np.isfinite(weight), weight, 0.0) * given
        if not weight.any():
            raise ValueError(
                "In no row do sample_weight and the mechanism's sensitivity leave a weight above zero; "
                "check the weights, or set sensitivity_weights=False."
            )
        # Total weight stays what was given, so that the regressor's C means the same with and without.
        return weight * (given.sum() / weight.sum())
