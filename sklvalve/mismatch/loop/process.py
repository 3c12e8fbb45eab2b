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
    share : float
        Of the variance of the command's moves that a controller explains; 0 without an integral action.
    """
    error = (value.mean() if setpoint is None else setpoint) - value
    design = np.column_stack([np.diff(error), error[1:], np.ones(len(error) - 1)])
    moves = np.diff(command)
    weights = np.linalg.lstsq(design, moves, rcond=None)[0]
    left = moves - design @ weights
    share = 1.0 - np.var(left) / (np.var(moves) or 1.0)
    # a value that follows the command at once explains its moves as well, but has no integral
    spread = np.sqrt(np.var(left) * np.linalg.pinv(design.T @ design)[1, 1])
    if weights[1] * np.sign(weights[0]) <= _INTEGRAL * spread:
        share = 0.0
    return (1 if weights[0] >= 0.0 else -1), float(share)


_INTEGRAL = 3.0  # standard errors of the integral action, below which there may be no controller
#: Dead times [rows] and time constants [rows] of the responses. Rows are thinned to some 30 a period, so they
#: span from at once to longer than a period whatever the sampling.
_DEAD = (2, 4, 8)
_FAST = (1.5, 4.0, 10.0)
#: Lags behind a dead time: two lags one behind the other begin as slowly as these, and no sum of single ones
#: does. Without them a band stands in for the beginning.
_BEHIND = ((4, 4.0), (4, 10.0), (8, 10.0))
_LATE = (25.0,)
_SLOW = (60.0, 150.0)
#: Of the responses, how many are quick: at once, late, behind a dead time, with the first lags, or both.
QUICK = 2 + len(_DEAD) + len(_FAST) + len(_BEHIND)
_SUMMED = (0.0, 4.0, 25.0)


def responses(stem, ahead, any_kind):
    """Responses that a process may be made of, all of one sign.

    A positive mixture of them is any process whose step response does not turn back: a flow follows the stem
    at once, after a dead time, or with a time constant up to the period of the loop; a value of unknown kind
    may also answer more slowly, or integrate, behind further lags.

    Parameters
    ----------
    stem, ahead : ndarray of shape (..., n)
        Position [fraction of travel], and as foreseen from the rows before.
    any_kind : bool
        Whether a slow or integrating process may stand between the stem and the value.

    Returns
    -------
    columns : ndarray of shape (..., k, n)
    """
    level = stem.mean(axis=-1, keepdims=True) if any_kind else stem[..., :1]

    def dead(rows):
        return np.concatenate([np.repeat(stem[..., :1], rows, axis=-1), stem[..., :-rows]], axis=-1) - level

    def lag(values, rows):
        keep = np.exp(-1.0 / rows) if rows else 0.0
        # at rest at the first value, not at zero
        begin = keep * values[..., :1]
        return lfilter([1.0 - keep], [1.0, -keep], values, axis=-1, zi=begin)[0]

    late = dead(1)
    columns = [ahead - level, late, *map(dead, _DEAD), *(lag(late, rows) for rows in _FAST)]
    columns += [lag(dead(after), rows) for after, rows in _BEHIND]
    columns += [lag(late, rows) for rows in _LATE]
    if any_kind:
        columns += [lag(late, rows) for rows in _SLOW]
        # the divisor only brings the columns to one size
        columns += [0.02 * np.cumsum(lag(late, rows), axis=-1) for rows in _SUMMED]
    return np.stack(columns, axis=-2)


def _scaled(values):
    return (values - values.mean()) / (values.std() or 1.0)
