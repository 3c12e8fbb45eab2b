# SPDX-License-Identifier: BSD-3-Clause
"""The black box of a closed loop: a mixture of responses of one sign, which cannot be the controller."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import nnls
from scipy.signal import lfilter

from sklvalve.mismatch.loop.operators import stick_slip

_KNOTS = 6
# of the driver's span: bands of play
_PLAYS = (0.03, 0.1, 0.3)
# rows: first-order lags and delays of the responses
_LAGS, _DELAYS = (1.0, 3.0, 10.0, 30.0, 100.0), (0, 1, 3, 10)
# how slowly the wander beside white noise is followed
_FOLLOWS = (0.4, 0.7, 0.9, 0.97, 0.99, 0.997)


def one_sign_prediction(
    driver: np.ndarray,
    value: np.ndarray,
    train: np.ndarray,
    *,
    forecast: np.ndarray | None = None,
    weight: np.ndarray | None = None,
) -> np.ndarray:
    r"""Forecast of a value in a closed loop by responses to its driver that do not turn back.

    .. math:: y = \sum_i c_i\, G_i\, h_i(u) + d, \qquad c_i \ge 0

    :math:`h_i` are hinges and plays of the driver, :math:`G_i` lags and delays; :math:`d` is a random walk
    under white noise. The weights are fitted to whitened rows, each weighed by what the rows before do not
    foretell: the direct method of closed-loop identification (Ljung, System Identification, 1999, ch. 13).
    The command of the same row is replaced by its forecast from the rows before, since a controller answers
    the noise of its row.

    Parameters
    ----------
    driver, value : ndarray of shape (n,)
        Without gaps; the value rises with its driver.
    train : ndarray of bool, shape (n,)
        Rows to learn from; a stretch at the beginning.
    forecast : ndarray of shape (n,), default=None
        The driver in each row as the rows before forecast it; the driver itself unless given.
    weight : ndarray of shape (n,), default=None
        What the responses are multiplied by, such as the root of the pressure drop.

    Returns
    -------
    predicted : ndarray of shape (n,)
        A free run; its level is that of the rows learnt from.
    """
    columns = _responses(driver, driver if forecast is None else forecast)
    if weight is not None:
        columns = np.concatenate([columns * weight, weight[None]])
    fits = [_fitted(columns, value, train, follow) for follow in _FOLLOWS]
    run = max(fits, key=lambda fit: fit[1])[0] @ columns
    return run + np.mean((value - run)[train])


def _responses(driver: np.ndarray, forecast: np.ndarray) -> np.ndarray:
    low, high = np.quantile(driver, [0.002, 0.998])
    span = max(high - low, 1e-12)
    knots = np.linspace(low, high, _KNOTS + 1)[:-1]
    columns = [np.maximum(forecast - knot, 0.0) for knot in knots]
    bases = [np.maximum(driver - knot, 0.0) for knot in knots]
    bases += list(stick_slip(driver, np.array(_PLAYS) * span, np.zeros(len(_PLAYS))))
    for base in bases:
        late = np.concatenate([base[:1], base[:-1]])
        columns += [np.concatenate([np.full(k, late[0]), late[: len(late) - k]]) for k in _DELAYS]
        columns += [_lagged(late, rows) for rows in _LAGS]
    return np.array(columns)


def _lagged(values: np.ndarray, rows: float) -> np.ndarray:
    keep = np.exp(-1.0 / rows)
    return lfilter([1.0 - keep], [1.0, -keep], values - values[0]) + values[0]


def _fitted(
    columns: np.ndarray, value: np.ndarray, train: np.ndarray, follow: float
) -> tuple[np.ndarray, float]:
    """Weights of no sign but plus, and the log likelihood of the whitened rows."""
    new = lfilter([1.0, -1.0], [1.0, -follow], value - value[0])[train]
    answers = lfilter([1.0, -1.0], [1.0, -follow], columns - columns[:, :1], axis=-1)[:, train]
    scale = np.sqrt((answers**2).sum(axis=1))
    scale = np.where(scale > 0.0, scale, 1.0)
    small: Any = np.linalg.qr(np.column_stack([(answers / scale[:, None]).T, new]), mode="r")
    weights, _ = nnls(small[:, :-1], small[:, -1], maxiter=30 * small.shape[1])
    left = np.sum((small[:, :-1] @ weights - small[:, -1]) ** 2)
    return weights / scale, -0.5 * len(new) * np.log(max(left, 1e-300) / len(new))
