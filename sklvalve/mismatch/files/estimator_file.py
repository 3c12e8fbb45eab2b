# SPDX-License-Identifier: BSD-3-Clause
"""What a model file holds of an estimator that is no finder: its parts as plain data, and a trial of them."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from sklearn.utils.validation import check_is_fitted

from sklvalve import __version__
from sklvalve.lssvm import LSSVMRegressor
from sklvalve.mismatch.files.plain_estimator import estimator_of, plain_of
from sklvalve.mismatch.files.plain_file import ESTIMATOR
from sklvalve.recording import InputError

if TYPE_CHECKING:
    from sklvalve.mismatch.effects import Effect

# rows of a trial, and how far a result may be from that of another machine, of the largest
_ROWS, _EQUAL = 8, 1e-6
# what columns of these names hold in a trial [SI]
_USUAL = {"p1": 6e5, "p2": 4e5, "temperature": 300.0, "flow": 1e-3, "simulated_flow": 1e-3}


def content_of_estimator(model: Any, rows: Any = None) -> dict[str, Any]:
    """The content of a model file.

    Parameters
    ----------
    model : fitted estimator
    rows : array-like of shape (n_samples, n_features), default=None
        On which the file is tried when it is read; None makes some up.

    Returns
    -------
    content : dict

    Raises
    ------
    NotFittedError
        If it is not fitted.
    InputError
        If it holds what a model file does not, or cannot work on `rows`.
    """
    check_is_fitted(model)
    content = {"format": ESTIMATOR, "version": __version__, "estimator": plain_of(model), "trial": None}
    if rows is None and not getattr(model, "n_features_in_", None):
        return content
    try:
        X = _made_up(model) if rows is None else _ordered(rows, model)
        content["trial"] = {"rows": X, "result": _result(model, X)}
    except Exception as error:
        if rows is not None:
            raise InputError(f"the model cannot work on the rows given to try it ({error})") from error
    return content


def _ordered(rows: Any, model: Any) -> np.ndarray:
    """Rows of a trial; columns with names stand as the model wants them."""
    names = getattr(model, "feature_names_in_", None)
    if names is not None and hasattr(rows, "columns"):
        rows = rows[list(names)]
    return np.asarray(rows, dtype=np.float64)[:_ROWS]


def estimator_of_content(content: dict[str, Any], known: dict[str, Effect]) -> Any:
    """The estimator of a content, tried; ``ValueError`` with a few words where it is unsound.

    Parameters
    ----------
    content : dict
    known : dict
        Effects by key.

    Returns
    -------
    model : estimator
    """
    model = estimator_of(content["estimator"], known)
    check_is_fitted(model)
    if content["trial"] is None:
        _require_working(model)
    else:
        rows, before = content["trial"]["rows"], content["trial"]["result"]
        if not all(isinstance(part, np.ndarray) and part.dtype.kind == "f" for part in (rows, before)):
            raise ValueError("its trial is none")
        made = _result(model, rows)
        scale = np.max(np.abs(before), initial=0.0, where=np.isfinite(before))
        if made.shape != before.shape or not np.allclose(
            made, before, rtol=_EQUAL, atol=_EQUAL * scale, equal_nan=True
        ):
            raise ValueError(f"it gives other numbers here than in sklvalve {content['version']}")
    return model


def _require_working(model: Any) -> None:
    """``ValueError`` where a model fails on rows made up; what physics refuses of them is no failure."""
    if not getattr(model, "n_features_in_", None):
        return
    try:
        _result(model, _made_up(model))
    except Exception as error:
        # physics may refuse rows that are made up, or give a gap that a regression refuses
        if isinstance(model, LSSVMRegressor) or not isinstance(error, ValueError):
            raise ValueError("it fails on any rows") from error


def _made_up(model: Any) -> np.ndarray:
    X = np.repeat(np.linspace(0.1, 0.9, _ROWS)[:, None], int(model.n_features_in_), axis=1)
    for k, name in enumerate(getattr(model, "feature_names_in_", ())):
        if name in _USUAL:
            X[:, k] = _USUAL[name] * (1.0 + 0.1 * X[:, k])
    return X


def _result(model: Any, X: np.ndarray) -> np.ndarray:
    """What a model makes of rows: its prediction, or what it turns them into."""
    names = getattr(model, "feature_names_in_", None)
    table = X if names is None else _frame(X, names)
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # of rows that are made up, physics may say what it likes
        warnings.simplefilter("ignore")
        made = model.predict(table) if hasattr(model, "predict") else model.transform(table)
    made = made.toarray() if hasattr(made, "toarray") else np.asarray(made)
    # of labels their place among the classes
    return np.asarray(
        made if made.dtype.kind in "biuf" else np.searchsorted(model.classes_, made), dtype=np.float64
    )


def _frame(X: np.ndarray, names: Iterable[str]) -> Any:
    try:
        from pandas import DataFrame
    except ImportError:
        raise ImportError('named columns need pandas: pip install "sklvalve[io]"') from None
    return DataFrame(X, columns=list(names))
