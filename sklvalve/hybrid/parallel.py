# SPDX-License-Identifier: BSD-3-Clause
"""Parallel hybrid: data give what physics leaves over."""

from numbers import Real
from typing import ClassVar

import numpy as np
from sklearn.base import BaseEstimator, RegressorMixin, _fit_context
from sklearn.utils._param_validation import HasMethods
from sklearn.utils.metaestimators import available_if
from sklearn.utils.validation import check_is_fitted

from sklvalve._refits import whole_or_nothing
from sklvalve.hybrid.inner import (
    InnerModelsMixin,
    checked_table,
    clone_model,
    fit_keywords,
    fit_regressor,
    fit_router,
    kept_columns,
    keywords_of_rows,
    mechanism_of,
    mechanism_or_default,
    one_per_row,
    regressor_or_default,
    take_columns,
    take_rows,
    usable_rows,
)


def _mechanism_has(*methods):
    return lambda self: all(hasattr(mechanism_of(self), method) for method in methods)


class ParallelHybridRegressor(InnerModelsMixin, RegressorMixin, BaseEstimator):
    r"""Physics plus a regressor that learns the residual.

    Predicts :math:`\hat y = g(x) + r(x)`: `fit` computes the mechanism's prediction g and lets the regressor
    learn :math:`y - g(x)`. Use it where physics is nearly right and something small, of unknown form, is
    missing; where one quantity in the equations is unknown, :class:`SeriesHybridRegressor` extrapolates
    better.

    Parameters
    ----------
    mechanism : object, default=None
        A model with ``predict(X)``, for example any regressor, a calibrated simulation or a series hybrid; or
        physics with ``forward(X, parameter)``, used with one parameter for all rows. ``fit(X, y)`` is called
        first where there is one. None is :class:`~sklvalve.mechanism.ValveMechanismTransformer` with the
        columns opening, p1, p2.
    regressor : object, default=None
        Any regressor. None is :class:`~sklvalve.lssvm.LSSVMRegressor` behind a
        :class:`~sklearn.preprocessing.StandardScaler`.
    parameter : float, default=None
        Parameter for ``forward``. None uses ``predict`` where the mechanism has it, and otherwise the
        weighted median of ``invert(X, y)``.
    regressor_columns : list of str or int, default=None
        Columns of X that the regressor sees, by name or position; None is all.

    Attributes
    ----------
    mechanism_ : object
        Fitted copy of the mechanism.
    regressor_ : object
        Fitted copy of the regressor.
    regressor_columns_ : list of str or int, or None
        The `regressor_columns` of the fit, by which the hybrid predicts.
    parameter_ : float or None
        Parameter used in ``forward``; None where ``predict`` is used.
    n_features_in_ : int
        Number of columns seen in `fit`.
    feature_names_in_ : ndarray of shape (`n_features_in_`,)
        Their names, where X had names.

    See Also
    --------
    SeriesHybridRegressor : Physics with a learnt parameter.

    Notes
    -----
    The paper's parallel connection of mechanism and data. With a series hybrid as the mechanism it is the
    mixed connection. The residual is taken on the rows of the fit: a mechanism that itself learns from them
    closely leaves less residual there than elsewhere. Behind a series hybrid choose the C of an LS-SVM by
    cross-validation between 0.01 and 1000: a larger one learns noise and errs far outside. Sample weights
    reach the mechanism too, where it takes them. To search over parameters of the two models, as
    ``regressor__C``, hand the models in: None has none to be set.

    Examples
    --------
    >>> import numpy as np
    >>> from sklearn.linear_model import LinearRegression
    >>> from sklvalve.hybrid import ParallelHybridRegressor
    >>> X = np.linspace(-3, 3, 61)[:, None]
    >>> y = 2 * X[:, 0] + np.sin(3 * X[:, 0])
    >>> model = ParallelHybridRegressor(LinearRegression()).fit(X, y)
    >>> round(model.score(X, y), 2)
    1.0
    """

    _parameter_constraints: ClassVar[dict] = {
        "mechanism": [HasMethods("predict"), HasMethods("forward"), None],
        "regressor": [HasMethods(["fit", "predict"]), None],
        "parameter": [Real, None],
        "regressor_columns": ["array-like", None],
    }

    def __init__(self, mechanism=None, regressor=None, *, parameter=None, regressor_columns=None):
        self.mechanism = mechanism
        self.regressor = regressor
        self.parameter = parameter
        self.regressor_columns = regressor_columns

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
        """Fit the mechanism, then the regressor on what it leaves over.

        Parameters
        ----------
        X : array-like or data frame of shape (n_samples, n_features)
            Operating conditions. A data frame reaches mechanism and regressor as it is.
        y : array-like of shape (n_samples,)
            Measured output.
        sample_weight : float or array-like of shape (n_samples,), default=None
            Non-negative weights of the rows.
        **fit_params : dict
            Further metadata, with metadata routing only.

        Returns
        -------
        self : ParallelHybridRegressor
            The fitted model.

        Raises
        ------
        ValueError
            If the mechanism predicts a number in no row, has no usable parameter, or the data are not finite
            numbers.
        TypeError
            If weights are given to a regressor that takes none.

        Warns
        -----
        sklvalve.mechanism.ValidityWarning
            If the mechanism predicts a number in some rows only, with their number; if columns that the
            regressor sees have one value in all rows, such as a constant outlet pressure.
        """
        X, y = checked_table(self, X, y, reset=True)
        self.mechanism_ = clone_model(mechanism_or_default(self.mechanism))
        regressor = clone_model(regressor_or_default(self.regressor))
        for_mechanism, for_regressor, weight = fit_keywords(
            self, X, sample_weight, fit_params, self.mechanism_, regressor
        )
        if hasattr(self.mechanism_, "fit"):
            self.mechanism_.fit(X, y, **for_mechanism)
        self.regressor_columns_ = kept_columns(self.regressor_columns)
        self.parameter_ = self._choose_parameter(X, y, weight)
        residual = y - self._mechanism_prediction(X)
        rows = usable_rows(
            residual,
            "The mechanism predicts a number",
            "check units and columns, and the mechanism's parameters",
        )
        self.regressor_ = fit_regressor(
            regressor,
            take_rows(X, rows),
            residual[rows],
            self.regressor_columns_,
            keywords_of_rows(X, for_regressor, rows),
        )
        return self

    def predict(self, X):
        """Predict the output: mechanism plus residual.

        Parameters
        ----------
        X : array-like or data frame of shape (n_samples, n_features)
            Operating conditions.

        Returns
        -------
        y : ndarray of shape (n_samples,)
            In the unit of the output; NaN where the mechanism gives none.
        """
        check_is_fitted(self)
        X = checked_table(self, X)
        return self._mechanism_prediction(X) + self._residual(X)

    @available_if(_mechanism_has("forward", "invert"))
    def forward(self, X, parameter):
        """Output with a given parameter of the mechanism, so that a series hybrid can hold this one.

        Parameters
        ----------
        X : array-like or data frame of shape (n_samples, n_features)
            Operating conditions.
        parameter : array-like of shape (n_samples,)
            The mechanism's parameter.

        Returns
        -------
        y : ndarray of shape (n_samples,)
        """
        check_is_fitted(self)
        X = checked_table(self, X)
        return one_per_row(
            self.mechanism_.forward(X, parameter), X, "forward of the mechanism"
        ) + self._residual(X)

    @available_if(_mechanism_has("forward", "invert"))
    def invert(self, X, y):
        """Parameter of the mechanism that gives the measured output less the learnt residual.

        Parameters
        ----------
        X : array-like or data frame of shape (n_samples, n_features)
            Operating conditions.
        y : array-like of shape (n_samples,)
            Measured output.

        Returns
        -------
        parameter : ndarray of shape (n_samples,)
        """
        check_is_fitted(self)
        X = checked_table(self, X)
        return self.mechanism_.invert(X, one_per_row(y, X, "y") - self._residual(X))

    @available_if(_mechanism_has("sensitivity"))
    def sensitivity(self, X, parameter):
        """Derivative of `forward` by the parameter, which is that of the mechanism.

        Parameters
        ----------
        X : array-like or data frame of shape (n_samples, n_features)
            Operating conditions.
        parameter : array-like of shape (n_samples,)
            The mechanism's parameter.

        Returns
        -------
        derivative : ndarray of shape (n_samples,)
        """
        check_is_fitted(self)
        return self.mechanism_.sensitivity(checked_table(self, X), parameter)

    def _choose_parameter(self, X, y, weight):
        name = type(self.mechanism_).__name__
        if self.parameter is not None:
            if not hasattr(self.mechanism_, "forward"):
                raise ValueError(
                    f"parameter is for a mechanism with forward, which {name} has not; leave it out."
                )
            return float(self.parameter)
        if hasattr(self.mechanism_, "predict"):
            return None
        if not hasattr(self.mechanism_, "invert"):
            raise ValueError(f"The mechanism {name} has neither predict nor invert; set parameter=...")
        values = one_per_row(self.mechanism_.invert(X, y), X, "invert of the mechanism")
        weight = np.ones_like(values) if weight is None else weight
        known = np.isfinite(values) & (weight > 0)
        if not known.any():
            raise ValueError(
                f"The mechanism {name} can be inverted for its parameter in none of the {len(values)} rows; "
                "check units and columns, or set parameter=..."
            )
        return _weighted_median(values[known], weight[known])

    def _mechanism_prediction(self, X):
        if self.parameter_ is None:
            return one_per_row(self.mechanism_.predict(X), X, "predict of the mechanism")
        parameter = np.full(X.shape[0], self.parameter_)
        return one_per_row(self.mechanism_.forward(X, parameter), X, "forward of the mechanism")

    def _residual(self, X):
        values = self.regressor_.predict(take_columns(X, self.regressor_columns_))
        return one_per_row(values, X, "predict of the regressor")


def _weighted_median(values, weight):
    order = np.argsort(values, kind="stable")
    below = np.cumsum(weight[order])
    return float(values[order][np.searchsorted(below, 0.5 * below[-1])])
