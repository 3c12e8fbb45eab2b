# SPDX-License-Identifier: BSD-3-Clause
"""Between the stem and what is measured: an unknown process that answers one way, and a controller."""

import numpy as np
from scipy.signal import lfilter


def lagged(values, count):
    """Values of the rows before, nearest first; the first value stands in before the first row.

    Parameters
    ----------
    values : ndarray of shape (n,)
    count : int

    Returns
    -------
    rows : ndarray of shape (n, count)
    """
    padded = np.concatenate([np.full(count, values[0]), values])
    n = len(values)
    return np.column_stack([padded[count - i : count - i + n] for i in range(1, count + 1)])


def foreseen_command(command, value, setpoint=None, order=4):
    """Command as the rows before foresee it.

    The controller answers the noise of the same row, so the recorded command is correlated with it and a
    regression on it is biased. What the past foresees of the command is not.

    Parameters
    ----------
    command, value : ndarray of shape (n,)
    setpoint : ndarray of shape (n,) or None
        Known in its own row, because an operator or another loop sets it.
    order : int, default=4

    Returns
    -------
    foreseen : ndarray of shape (n,)
    """
    columns = [np.ones((len(command), 1)), lagged(_scaled(command), order), lagged(_scaled(value), order)]
    if setpoint is not None and np.ptp(setpoint) > 1e-9 * np.abs(setpoint).max():
        columns += [_scaled(setpoint)[:, None], lagged(_scaled(setpoint), 2)]
    design = np.hstack(columns)
    foreseen = design @ np.linalg.lstsq(design[order:], command[order:], rcond=None)[0]
    foreseen[:order] = command[:order]
    return foreseen


def sense_of_process(command, value, setpoint=None):
    """Sign of the response to the command: that with which this controller can hold the loop.

    Parameters
    ----------
    command, value : ndarray of shape (n,)
    setpoint : ndarray of shape (n,) or None

    Returns
    -------
    sense : int
        1 where the controller raises the command when the value is too low, else -1.
    """
    error = (value.mean() if setpoint is None else setpoint) - value
    design = np.column_stack([np.diff(error), error[1:], np.ones(len(error) - 1)])
    gain = np.linalg.lstsq(design, np.diff(command), rcond=None)[0][0]
    return 1 if gain >= 0.0 else -1


def responses(stem, ahead, integrates):
    """Responses that a process may be made of, all of one sign.

    A positive mixture of them is any process whose step response does not turn back: flow follows the stem
    at once, after a row or two, or with time constants up to 20 rows; anything else answers within 100 rows
    or integrates, behind further lags.

    Parameters
    ----------
    stem, ahead : ndarray of shape (..., n)
        Position [fraction of travel], and as foreseen from the rows before.
    integrates : bool
        Whether a slow or integrating process may stand between the stem and the value.

    Returns
    -------
    columns : ndarray of shape (..., k, n)
    """
    level = stem[..., :1] if not integrates else stem.mean(axis=-1, keepdims=True)
    late = np.concatenate([stem[..., :1], stem[..., :-1]], axis=-1) - level

    def lag(keep):
        return lfilter([1.0 - keep], [1.0, -keep], late, axis=-1)

    if integrates:
        # the divisor only brings the columns to one size
        sums = [0.02 * np.cumsum(column, axis=-1) for column in (late, lag(0.7), lag(0.9), lag(0.97))]
        columns = [late, lag(0.7), lag(0.95), lag(0.99), *sums]
    else:
        later = np.concatenate([late[..., :1], late[..., :-1]], axis=-1)
        columns = [ahead - level, late, later, lag(0.6), lag(0.85), lag(0.95)]
    return np.stack(columns, axis=-2)


def _scaled(values):
    return (values - values.mean()) / (values.std() or 1.0)
