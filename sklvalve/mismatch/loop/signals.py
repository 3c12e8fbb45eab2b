# SPDX-License-Identifier: BSD-3-Clause
"""Signals of a loop that can be diagnosed, or the one sentence that says why not."""

from dataclasses import dataclass

import numpy as np

from sklvalve.recording.errors import InputError
from sklvalve.recording.runs import runs

_FEWEST = 100
_MOST = 2500  # more rows than this are thinned: the search would take too long
_STEP = 10.0  # s; a valve that follows a loop needs no finer rows
_HELD = 6  # rows in which nothing recorded changes are a historian's hold, not the plant
_AT_LIMIT = 0.2
_NEAR_ZERO = 0.02


@dataclass(frozen=True, eq=False)
class LoopSignals:
    """Command, value and set-point of a loop, row by row.

    Parameters
    ----------
    time : ndarray of shape (n,)
        [s]
    command : ndarray of shape (n,)
        [fraction of travel]
    value : ndarray of shape (n,)
        Flow, or the process value [as recorded, SI].
    setpoint : ndarray of shape (n,) or None
    used : ndarray of bool, shape (n,)
        Rows that were recorded, not held or missing.
    is_flow : bool
        Whether the value is the flow through the valve.
    span : float
        Span of the command between its 1 % and 99 % quantiles [fraction of travel].
    """

    time: np.ndarray
    command: np.ndarray
    value: np.ndarray
    setpoint: np.ndarray | None
    used: np.ndarray
    is_flow: bool
    span: float


def loop_signals(recording):
    """Take a loop's signals from a recording.

    Parameters
    ----------
    recording : Recording
        With the roles `command` and `flow`, or `command` and `process_value`; `setpoint` where known.

    Returns
    -------
    signals : LoopSignals

    Raises
    ------
    InputError
        If a role is missing, rows are too few, the command is outside its range, at a limit or at rest, or
        the value is constant or near zero.
    """
    role = "flow" if "flow" in recording else "process_value"
    for needed in ("command", role):
        if needed not in recording:
            raise InputError(
                f"{recording.source}: a loop needs the roles command and flow (or process_value), and there "
                f"is no {needed}; name its column"
            )
    every = max(1, round(_STEP / recording.sample_time), -(-len(recording) // _MOST))
    command, gaps = _filled(recording["command"][::every])
    value, missing = _filled(recording[role][::every])
    setpoint = recording.get("setpoint")
    if setpoint is not None:
        setpoint = _filled(setpoint[::every])[0]
    _require_command(recording.source, command)
    _require_value(recording.source, role, value, setpoint, command)
    used = ~(gaps | missing | _held(command, value))
    if used.sum() < _FEWEST:
        raise InputError(
            f"{recording.source}: only {used.sum()} rows hold a fresh command and {role}; give at least "
            f"{_FEWEST} rows, exported as they were sampled"
        )
    span = float(np.ptp(np.quantile(command, [0.01, 0.99])))
    if span <= 0.0:
        raise InputError(
            f"{recording.source}: the command is at rest in 98 % of the rows; give a time in which it moves"
        )
    return LoopSignals(recording.time[::every], command, value, setpoint, used, role == "flow", span)


def _filled(values):
    known = np.isfinite(values)
    if not known.any():
        return np.zeros(len(values)), ~known
    rows = np.arange(len(values))
    return np.interp(rows, rows[known], values[known]), ~known


def _held(command, value):
    """Rows held by a historian, and the first row after: it shows in one step what moved in many."""
    same = np.concatenate([[False], (np.diff(command) == 0.0) & (np.diff(value) == 0.0)])
    held = np.zeros(len(same), dtype=bool)
    for begin, end in runs(same):
        if end - begin >= _HELD:
            held[begin : end + 1] = True
    return held


def _require_command(source, command):
    if command.min() < -0.1 or command.max() > 1.1:
        raise InputError(
            f"{source}: the command runs from {command.min():.3g} to {command.max():.3g} of the travel; "
            "correct its unit, or leave the recording out if it is no valve's command"
        )
    share = max(np.mean(command <= 0.001), np.mean(command >= 0.999))
    if share > _AT_LIMIT:
        raise InputError(
            f"{source}: the command is at its limit in {share:.0%} of the rows, where no loop controls; "
            "give a time in which it does"
        )


def _require_value(source, role, value, setpoint, command):
    if np.ptp(value) <= 1e-9 * np.abs(value).max():
        raise InputError(
            f"{source}: {role} holds one value ({value[0]:.3g}) in all rows; give a time in "
            "which it is measured"
        )
    if role != "flow":
        return
    most = max(np.abs(value).max(), 0.0 if setpoint is None else np.abs(setpoint).max())
    usual = float(np.median(np.abs(value)))
    if usual < _NEAR_ZERO * most:
        raise InputError(
            f"{source}: the flow is near zero ({usual:.2g} in the middle, {most:.2g} at most or asked for) "
            f"while the command runs from {command.min():.1%} to {command.max():.1%}; give a time in which "
            "it flows"
        )
