# SPDX-License-Identifier: BSD-3-Clause
"""The black box of a closed loop: a mixture of responses of one sign, which cannot be the controller."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.optimize import nnls
from scipy.signal import lfilter

from sklvalve.mismatch.loop.operators import stick_slip
from sklvalve.mismatch.signals.tall import row_blocks, triangle

_KNOTS = 6
# of the driver's span: bands of play
_PLAYS = (0.03, 0.1, 0.3)
# rows: first-order lags and delays of the responses
_LAGS, _DELAYS = (1.0, 3.0, 10.0, 30.0, 100.0), (0, 1, 3, 10)
# how slowly the wander beside white noise is followed
_FOLLOWS = (0.4, 0.7, 0.9, 0.97, 0.99, 0.997)


def one_sign_predictions(
    driver: np.ndarray,
    value: np.ndarray,
    origins: Sequence[int],
    *,
    forecast: np.ndarray | None = None,
    weight: np.ndarray | None = None,
) -> list[np.ndarray]:
    r"""Forecasts of a value in a closed loop by responses to its driver that do not turn back.

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
    origins : sequence of int
        Each forecast learns from the rows before one of these, the first one first.
    forecast : ndarray of shape (n,), default=None
        The driver in each row as the rows before forecast it; the driver itself unless given.
    weight : ndarray of shape (n,), default=None
        What the responses are multiplied by, such as the root of the pressure drop.

    Returns
    -------
    predicted : list of ndarray of shape (n,)
        Of each origin a free run; its level is that of the rows learnt from.
    """
    columns = _responses(driver, driver if forecast is None else forecast, weight)
    fits = zip(*(_fitted(columns, value, origins, follow) for follow in _FOLLOWS), strict=True)
    made = []
    for origin, of_origin in zip(origins, fits, strict=True):
        run = max(of_origin, key=lambda fit: fit[1])[0] @ columns
        made.append(run + np.mean((value - run)[:origin]))
    return made


def _responses(driver: np.ndarray, forecast: np.ndarray, weight: np.ndarray | None) -> np.ndarray:
    """Responses, a row each, with the weight itself as the last where there is one."""
    late = (_KNOTS + len(_PLAYS)) * (len(_DELAYS) + len(_LAGS))
    # one at a time: of a week at 1 Hz all of them are 400 MB
    columns = np.empty((_KNOTS + late + (weight is not None), len(driver)))
    for k, response in enumerate(_each_response(driver, forecast)):
        columns[k] = response if weight is None else response * weight
    if weight is not None:
        columns[-1] = weight
    return columns


def _each_response(driver: np.ndarray, forecast: np.ndarray) -> Iterator[np.ndarray]:
    low, high = np.quantile(driver, [0.002, 0.998])
    span = max(high - low, 1e-12)
    knots = np.linspace(low, high, _KNOTS + 1)[:-1]
    yield from (np.maximum(forecast - knot, 0.0) for knot in knots)
    bases = [np.maximum(driver - knot, 0.0) for knot in knots]
    bases += list(stick_slip(driver, np.array(_PLAYS) * span, np.zeros(len(_PLAYS))))
    for base in bases:
        late = np.concatenate([base[:1], base[:-1]])
        yield from (np.concatenate([np.full(k, late[0]), late[: len(late) - k]]) for k in _DELAYS)
        yield from (_lagged(late, rows) for rows in _LAGS)


def _lagged(values: np.ndarray, rows: float) -> np.ndarray:
    keep = np.exp(-1.0 / rows)
    return lfilter([1.0 - keep], [1.0, -keep], values - values[0]) + values[0]


def _fitted(
    columns: np.ndarray, value: np.ndarray, origins: Sequence[int], follow: float
) -> list[tuple[np.ndarray, float]]:
    """Of each origin the weights of no sign but plus, and the log likelihood of the whitened rows."""
    first = np.append(columns[:, 0], value[0])[:, None]
    memory, small, before, made = np.zeros((len(first), 1)), np.empty((0, len(first))), 0, []
    for origin in origins:
        for rows in row_blocks(before, origin):
            table = np.concatenate([columns[:, rows], value[None, rows]]) - first
            white, memory = lfilter([1.0, -1.0], [1.0, -follow], table, zi=memory)
            small = triangle([white.T], small)
        before = origin
        made.append(_weights(small, origin))
    return made


def _weights(small: np.ndarray, rows: int) -> tuple[np.ndarray, float]:
    """Weights and log likelihood by R of the whitened columns and, last, of the whitened value."""
    scale = np.sqrt((small[:, :-1] ** 2).sum(axis=0))
    scale = np.where(scale > 0.0, scale, 1.0)
    answers, new = small[:, :-1] / scale, small[:, -1]
    weights, _ = nnls(answers, new, maxiter=30 * small.shape[1])
    left = np.sum((answers @ weights - new) ** 2)
    return weights / scale, -0.5 * rows * np.log(max(left, 1e-300) / rows)
