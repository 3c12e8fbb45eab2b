# SPDX-License-Identifier: BSD-3-Clause
"""Between the stem and what is measured: an unknown process that answers one way."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

#: Dead time [rows] and time constant [rows] of the responses. Rows are averaged to some 30 a period, so they
#: span from at once to longer than a period whatever the sampling. Two lags one behind the other begin as
#: slowly as those behind a dead time, and no sum of single lags does; without them a band stands in for that.
_QUICK = (
    *((1, 0.0), (2, 0.0), (4, 0.0), (8, 0.0)),
    *((1, 1.5), (1, 4.0), (1, 10.0)),
    *((4, 4.0), (4, 10.0), (8, 10.0)),
)
_LONG = ((1, 25.0),)
#: Beside them, of a value of unknown kind: slow responses, and integrals behind a lag.
_SLOW = ((1, 60.0), (1, 150.0))
_INTEGRATED = ((1, 0.0), (1, 4.0), (1, 25.0))
#: Number of responses, the one at once included, that follow within a fraction of a swing.
QUICK_RESPONSES = 1 + len(_QUICK)
_FORECAST_ORDER = 4


def lagged(values: NDArray, count: int) -> NDArray:
    """Values of the `count` rows before each, nearest first, of shape (n, count).

    The first value stands in before the first row.
    """
    padded = np.concatenate([np.full(count, values[0]), values])
    n = len(values)
    return np.column_stack([padded[count - i : count - i + n] for i in range(1, count + 1)])


def forecast_command(command: NDArray, value: NDArray, setpoint: NDArray | None = None) -> NDArray:
    """Forecast of the command in each row from the rows before.

    The controller answers the noise of the same row, so the recorded command is correlated with it and a
    regression on it is biased. The forecast is not correlated with it.

    Parameters
    ----------
    command : ndarray of shape (n,)
        [fraction of travel]
    value : ndarray of shape (n,)
        [any unit]
    setpoint : ndarray of shape (n,), optional
        Known in its own row, because an operator or another loop sets it [any unit].

    Returns
    -------
    forecast : ndarray of shape (n,)
        [fraction of travel]
    """
    order = _FORECAST_ORDER
    columns = [
        np.ones((len(command), 1)),
        lagged(_standardised(command), order),
        lagged(_standardised(value), order),
    ]
    if setpoint is not None and np.ptp(setpoint) > 1e-9 * np.abs(setpoint).max():
        columns += [_standardised(setpoint)[:, None], lagged(_standardised(setpoint), 2)]
    design = np.hstack(columns)
    forecast = design @ np.linalg.lstsq(design[order:], command[order:], rcond=None)[0]
    forecast[:order] = command[:order]
    return forecast


def responses(stem: NDArray, stem_forecast: NDArray, any_kind: bool) -> NDArray:
    """Responses that a process may be made of, all of one sign.

    A positive mixture of them is any process whose step response does not turn back: a flow follows the stem
    at once, after a dead time, or with a time constant up to the period of the loop; a value of unknown kind
    may also answer more slowly, or integrate, behind further lags.

    Parameters
    ----------
    stem, stem_forecast : ndarray of shape (..., n)
        Position, and its forecast from the rows before [fraction of travel].
    any_kind : bool
        Whether a slow or integrating process may stand between the stem and the value.

    Returns
    -------
    responses : ndarray of shape (..., k, n)
        [fraction of travel]
    """
    level = stem.mean(axis=-1, keepdims=True) if any_kind else stem[..., :1]

    def response(dead_time: int, lag: float) -> NDArray:
        before = np.repeat(stem[..., :1], dead_time, axis=-1)
        late = np.concatenate([before, stem[..., :-dead_time]], axis=-1) - level
        if not lag:
            return late
        keep = np.exp(-1.0 / lag)
        # at rest at the first value, not at zero
        return lfilter([1.0 - keep], [1.0, -keep], late, axis=-1, zi=keep * late[..., :1])[0]

    columns = [stem_forecast - level, *(response(*each) for each in _QUICK + _LONG)]
    if any_kind:
        columns += [response(*each) for each in _SLOW]
        # the factor only brings the columns to one size
        columns += [0.02 * np.cumsum(response(*each), axis=-1) for each in _INTEGRATED]
    return np.stack(columns, axis=-2)


def _standardised(values: NDArray) -> NDArray:
    """Values of mean zero and unit standard deviation."""
    return (values - values.mean()) / (values.std() or 1.0)
