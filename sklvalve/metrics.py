# SPDX-License-Identifier: BSD-3-Clause
"""How far a prediction is from what was measured: RMSE, MAPE, largest relative error, and their scorers.

The three figures are equations 18 to 20 of the paper. Its two percentages divide by the signed measured value
and are undefined at zero flow; here they divide by the magnitude, and rows whose magnitude is under a cut-off
are left out. With a span all three are percentages of that, which have a meaning at zero flow too.
"""

import numpy as np
from sklearn.metrics import make_scorer
from sklearn.utils import check_array, check_consistent_length

__all__ = ["SCORERS", "err_max", "mape", "neg_err_max_scorer", "neg_mape_scorer", "neg_rmse_scorer", "rmse"]

# A flow meter's relative error has no meaning in the lowest part of its range.
DEFAULT_CUT_OFF = 0.01


def rmse(y_true, y_pred, *, span=None, sample_weight=None):
    r"""Root mean square error.

    Parameters
    ----------
    y_true : array-like of shape (n_samples,)
        Measured values. [any unit]
    y_pred : array-like of shape (n_samples,)
        Predicted values. [same unit]
    span : float or "measured", default=None
        Tell the error in percent of this, in the unit of `y_true`; "measured" is the largest less the
        smallest measured value.
    sample_weight : array-like of shape (n_samples,), default=None
        Non-negative weights of the rows.

    Returns
    -------
    error : float
        In the unit of `y_true`, or in percent of the span.

    Raises
    ------
    ValueError
        If the lengths differ, a value is missing or infinite, the weights are negative or all zero, or the
        span is not above 0.

    Notes
    -----
    .. math:: \mathrm{RMSE} = \sqrt{\sum_i w_i (y_i - \hat y_i)^2 / \sum_i w_i}

    Equation 18 of the paper, with weights.

    Examples
    --------
    >>> from sklvalve.metrics import rmse
    >>> rmse([3.0, 4.0, 5.0, 6.0], [3.0, 6.0, 5.0, 6.0])
    1.0
    >>> rmse([3.0, 4.0, 5.0, 6.0], [3.0, 6.0, 5.0, 6.0], span=20.0)
    5.0
    """
    y_true, y_pred, weight = _columns(y_true, y_pred, sample_weight)
    if span is not None:
        unit = 100.0 / _span(y_true, span)
        y_true, y_pred = unit * y_true, unit * y_pred
    error = np.abs(y_true - y_pred)
    largest = error.max()
    if largest == 0.0:
        return 0.0
    # Scaled by the largest error, so that squares neither overflow nor vanish.
    return float(largest * np.sqrt(np.average((error / largest) ** 2, weights=weight)))


def mape(y_true, y_pred, *, min_flow=None, span=None, sample_weight=None):
    r"""Mean absolute percentage error, of each value or of the span. [%]

    Parameters
    ----------
    y_true : array-like of shape (n_samples,)
        Measured values. [any unit]
    y_pred : array-like of shape (n_samples,)
        Predicted values. [same unit]
    min_flow : float, default=None
        Rows with :math:`|y|` under this are left out, in the unit of `y_true`. By default 1 % of the largest
        :math:`|y|` of this call: give a number where several sets of rows are compared. Exact zeros are left
        out always.
    span : float or "measured", default=None
        Divide by this, in the unit of `y_true`, and leave no row out; "measured" is the largest less the
        smallest measured value of this call. It takes the place of `min_flow`.
    sample_weight : array-like of shape (n_samples,), default=None
        Non-negative weights of the rows.

    Returns
    -------
    error : float
        In percent: 5.0 means 5 %.

    Raises
    ------
    ValueError
        If no row reaches `min_flow`, the lengths differ, a value is missing or infinite, the weights of the
        rows that remain are all zero, the span is not above 0, or both `span` and `min_flow` are given.

    Notes
    -----
    .. math:: \mathrm{MAPE} = 100 \, \frac{\sum_i w_i |y_i - \hat y_i| / |y_i|}{\sum_i w_i}

    Equation 19 of the paper with the magnitude in the denominator. It never exceeds :func:`err_max` with the
    same cut-off, nor with the same span.

    Examples
    --------
    >>> from sklvalve.metrics import mape
    >>> mape([10.0, 20.0, 0.0], [11.0, 20.0, 0.5])
    5.0
    >>> mape([10.0, 20.0, 0.0], [11.0, 20.0, 0.5], span=25.0)
    2.0
    """
    y_true, y_pred, weight = _columns(y_true, y_pred, sample_weight)
    if span is not None:
        return float(np.average(_of_span(y_true, y_pred, span, min_flow), weights=weight))
    rows = _rows_with_flow(y_true, min_flow)
    if weight is not None:
        weight = weight[rows]
        if not weight.any():
            raise ValueError(
                "Every row that reaches min_flow has zero sample_weight; give one of them weight, "
                "or lower min_flow."
            )
    return float(np.average(_percentage(y_true[rows], y_pred[rows]), weights=weight))


def err_max(y_true, y_pred, *, min_flow=None, span=None):
    r"""Largest absolute percentage error, of its value or of the span. [%]

    Parameters
    ----------
    y_true : array-like of shape (n_samples,)
        Measured values. [any unit]
    y_pred : array-like of shape (n_samples,)
        Predicted values. [same unit]
    min_flow : float, default=None
        Rows with :math:`|y|` under this are left out, in the unit of `y_true`. By default 1 % of the largest
        :math:`|y|` of this call: give a number where several sets of rows are compared. Exact zeros are left
        out always.
    span : float or "measured", default=None
        Divide by this, in the unit of `y_true`, and leave no row out; "measured" is the largest less the
        smallest measured value of this call. It takes the place of `min_flow`.

    Returns
    -------
    error : float
        In percent: 5.0 means 5 %.

    Raises
    ------
    ValueError
        If no row reaches `min_flow`, the lengths differ, a value is missing or infinite, the span is not
        above 0, or both `span` and `min_flow` are given.

    Notes
    -----
    .. math:: \mathrm{Err}_{max} = 100 \max_i |y_i - \hat y_i| / |y_i|

    Equation 20 of the paper with the magnitude in the denominator. One row decides it, so weights have no
    place here.

    Examples
    --------
    >>> from sklvalve.metrics import err_max
    >>> err_max([10.0, 20.0, 0.0], [11.0, 20.0, 0.5])
    10.0
    >>> err_max([10.0, 20.0, 0.0], [11.0, 20.0, 0.5], span="measured")
    5.0
    """
    y_true, y_pred, _ = _columns(y_true, y_pred, None)
    if span is not None:
        return float(_of_span(y_true, y_pred, span, min_flow).max())
    rows = _rows_with_flow(y_true, min_flow)
    return float(_percentage(y_true[rows], y_pred[rows]).max())


def _columns(y_true, y_pred, sample_weight):
    y_true = _column(y_true, "y_true")
    y_pred = _column(y_pred, "y_pred")
    check_consistent_length(y_true, y_pred)
    if sample_weight is None:
        return y_true, y_pred, None
    weight = _column(sample_weight, "sample_weight")
    check_consistent_length(y_true, weight)
    if np.any(weight < 0):
        raise ValueError(f"sample_weight must not be negative; the smallest is {weight.min():g}.")
    if not weight.any():
        raise ValueError("The sample_weight of every row is zero; give at least one row weight.")
    return y_true, y_pred, weight / weight.max()


def _column(values, name):
    values = check_array(values, ensure_2d=False, dtype=np.float64, input_name=name)
    if values.ndim == 2 and values.shape[1] == 1:
        values = values[:, 0]
    if values.ndim != 1:
        raise ValueError(f"{name} must be one column of numbers, got an array of shape {values.shape}.")
    return values


def _rows_with_flow(y_true, min_flow):
    magnitude = np.abs(y_true)
    cut_off = DEFAULT_CUT_OFF * magnitude.max() if min_flow is None else min_flow
    if not (np.isfinite(cut_off) and cut_off >= 0):
        raise ValueError(f"min_flow must be a number of 0 or more, got {min_flow!r}.")
    rows = (magnitude >= cut_off) & (magnitude > 0)
    if not rows.any():
        raise ValueError(
            f"No row of y_true reaches min_flow={cut_off:g}, the largest magnitude is {magnitude.max():g}: "
            "a percentage error has no meaning here; lower min_flow or use rmse."
        )
    return rows


def _percentage(y_true, y_pred):
    return 100.0 * np.abs((y_true - y_pred) / y_true)


def _of_span(y_true, y_pred, span, min_flow):
    if min_flow is not None:
        raise ValueError(
            "min_flow leaves out rows of small flow, and span needs none left out; give only one."
        )
    span = _span(y_true, span)
    # of halves: a difference may overflow where neither value does
    return 200.0 * (np.abs(0.5 * y_true - 0.5 * y_pred) / span)


def _span(y_true, span):
    known = np.ptp(y_true) if isinstance(span, str) and span == "measured" else span
    if isinstance(known, bool | str) or not (np.isfinite(known) and known > 0.0):
        told = "all measured values are equal" if span == "measured" else f"got {span!r}"
        raise ValueError(f'span must be a number above 0 or "measured", and {told}.')
    return float(known)


neg_rmse_scorer = make_scorer(rmse, greater_is_better=False)
"""`rmse` with the sign turned, as ``scoring`` of scikit-learn's model selection: larger is better."""

neg_mape_scorer = make_scorer(mape, greater_is_better=False)
"""`mape` with the sign turned, as ``scoring`` of scikit-learn's model selection: larger is better."""

neg_err_max_scorer = make_scorer(err_max, greater_is_better=False)
"""`err_max` with the sign turned, as ``scoring`` of scikit-learn's model selection: larger is better."""

SCORERS = {"neg_rmse": neg_rmse_scorer, "neg_mape": neg_mape_scorer, "neg_err_max": neg_err_max_scorer}
"""The scorers by name: ``"neg_rmse"``, ``"neg_mape"`` and ``"neg_err_max"``. For
``cross_validate(..., scoring=SCORERS)`` or ``GridSearchCV(..., scoring=SCORERS, refit="neg_rmse")``;
scikit-learn takes a name by itself for its own scorers only."""
