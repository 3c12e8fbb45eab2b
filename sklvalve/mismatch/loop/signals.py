# SPDX-License-Identifier: BSD-3-Clause
"""Signals of a loop that can be diagnosed, or the one sentence that says why not."""

from dataclasses import dataclass, replace

import numpy as np

from sklvalve.mismatch.loop.pace import thinning
from sklvalve.mismatch.loop.process import sense_of_process
from sklvalve.recording.errors import InputError
from sklvalve.recording.runs import runs

_FEWEST = 100
_STRETCH = 2000  # rows of a stretch; of a longer record some are taken apart, since plants change
_STRETCHES = 3
_HELD = 6  # rows in which nothing recorded changes are a historian's hold, not the plant
_SURE = 0.9  # share of the command's moves that a controller explains, from which on its sign is known
_AT_LIMIT = 0.2
_NEAR_ZERO = 0.02


@dataclass(frozen=True, eq=False)
class LoopSignals:
    """Command, value and set-point of a loop, row by row; a row is the mean of `every` recorded ones.

    Parameters
    ----------
    time : ndarray of shape (n,)
        [s]
    command : ndarray of shape (n,)
        At the end of each row [fraction of travel].
    value : ndarray of shape (n,)
        Flow, or the process value [as recorded, SI].
    setpoint : ndarray of shape (n,) or None
    used : ndarray of bool, shape (n,)
        Rows that were recorded, not held or missing.
    is_flow : bool
        Whether the value is the flow through the valve.
    span : float
        Span of the command between its 1 % and 99 % quantiles [fraction of travel].
    whole : ndarray of shape (n * every,)
        Command in every recorded row: a stem answers each of them.
    every : int
        Recorded rows in one of these.
    step : float
        Time from row to row [s].
    period : float
        Of the strongest swing [s]; infinite without one.
    senses : tuple of int
        Signs that the response to the command may have: one where the controller tells it, else both.
    """

    time: np.ndarray
    command: np.ndarray
    value: np.ndarray
    setpoint: np.ndarray | None
    used: np.ndarray
    is_flow: bool
    span: float
    whole: np.ndarray
    every: int
    step: float
    period: float
    senses: tuple[int, ...]

    def means(self, values):
        """Means over each row of what is known in every recorded row, along the last axis."""
        return row_means(values, self.every)

    def stretches(self):
        """The record itself, or of a long one up to three stretches, evenly spread."""
        n = len(self.command)
        if n <= 1.25 * _STRETCH:
            return [self]
        count = min(_STRETCHES, max(2, n // _STRETCH))
        begins = np.linspace(0, n - _STRETCH, count).astype(int)
        cut = [slice(begin, begin + _STRETCH) for begin in begins]
        parts = [self._slice(rows) for rows in cut]
        # where all that is fresh and moves lies between the stretches, the whole is looked at
        return [part for part in parts if part.used.sum() >= _FEWEST and part.span > 0.0] or [self]

    def _slice(self, rows):
        every = slice(rows.start * self.every, rows.stop * self.every)
        whole = self.whole[every]
        return replace(
            self,
            time=self.time[rows],
            command=self.command[rows],
            value=self.value[rows],
            setpoint=None if self.setpoint is None else self.setpoint[rows],
            used=self.used[rows],
            span=_span(whole),
            whole=whole,
        )


def row_means(values, every):
    """Means of `every` values, along the last axis; what is over at the end is left out."""
    if every == 1:
        return values
    n = values.shape[-1] // every
    return values[..., : n * every].reshape(*values.shape[:-1], n, every).mean(axis=-1)


def _span(command):
    return float(np.ptp(np.quantile(command, [0.01, 0.99])))


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
    whole, gaps = _filled(recording["command"])
    value, missing = _filled(recording[role])
    _require_command(recording.source, whole)
    setpoint = recording.get("setpoint")
    if setpoint is not None:
        setpoint = _filled(setpoint)[0]
    _require_value(recording.source, role, value, setpoint, whole)
    span = _span(whole)
    if span <= 0.0:
        raise InputError(
            f"{recording.source}: the command is at rest in 98 % of the rows; give a time in which it moves"
        )
    every, period = thinning(whole, value)
    n = len(whole) // every
    ends = slice(every - 1, n * every, every)
    command = whole[ends]
    used = (row_means((gaps | missing).astype(float), every) < 0.5) & ~_held(command, value[ends])
    if used.sum() < _FEWEST:
        raise InputError(
            f"{recording.source}: only {used.sum()} rows hold a fresh command and {role}; give at least "
            f"{_FEWEST} rows, exported as they were sampled"
        )
    return LoopSignals(
        row_means(recording.time, every),
        command,
        row_means(value, every),
        None if setpoint is None else row_means(setpoint, every),
        used,
        role == "flow",
        span,
        whole[: n * every],
        every,
        recording.sample_time * every,
        period * recording.sample_time,
        _senses(whole, value, setpoint, role == "flow"),
    )


def _senses(command, value, setpoint, is_flow):
    """Signs of the response that are tried.

    Of 197 drawn loops without a set-point the controller's sign was right in 99 % of those where it explains
    nine tenths of the command's moves, and in 81 % of the others; with the set-point in 97 % of all. A larger
    opening gives more flow, unless the controller shows that the command is of the other sense.
    """
    sense, share = sense_of_process(command, value, setpoint)
    if share >= _SURE:
        return (sense,)
    if is_flow:
        return (1,)
    return (sense,) if setpoint is not None and np.ptp(setpoint) > 0.0 else (1, -1)


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
            f"{source}: the command runs from {command.min():.1%} to {command.max():.1%} of the travel, and "
            "a valve's command stays between 0 and 100 %; correct its unit, or name the column of the command"
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
