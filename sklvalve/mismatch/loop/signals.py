# SPDX-License-Identifier: BSD-3-Clause
"""Signals of a loop that can be diagnosed, or the one sentence that says why not."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

import sklvalve.mismatch.loop.constants as constants
from sklvalve.mismatch.loop.controller import process_gain_sign
from sklvalve.mismatch.loop.oscillation import swing_spectrum
from sklvalve.recording.errors import InputError
from sklvalve.recording.gaps import filled
from sklvalve.recording.recording import Recording
from sklvalve.recording.runs import runs

_STRETCH_ROWS = 2000  # of a longer record some stretches are examined apart, since plants change
_MOST_STRETCHES = 3
_FEWEST_SWINGS = 4  # in the record: fewer are a trend
_NOISE_FLOOR = 3.0  # times the median of the power: what lies below is no swing
_ROWS_PER_SWING = 30  # that are kept; 20 are enough to see where a stem stands still
_ROWS_KEPT = 600  # in any case: the fit averages noise out better than a mean of rows


@dataclass(frozen=True, eq=False)
class LoopSignals:
    """Command, value and set-point of a loop, row by row; a row is the mean of `decimation` recorded ones.

    Parameters
    ----------
    time : ndarray of shape (n,)
        [s]
    command : ndarray of shape (n,)
        At the end of each row [fraction of travel].
    value : ndarray of shape (n,)
        Flow, or the process value [as recorded, SI].
    setpoint : ndarray of shape (n,) or None
        [as the value]
    used : ndarray of bool, shape (n,)
        Rows that were recorded, not held or missing.
    is_flow : bool
        Whether the value is the flow through the valve.
    span : float
        Span of the command between its 1 % and 99 % quantiles [fraction of travel].
    recorded_command : ndarray of shape (n * decimation,)
        Command in every recorded row, since a stem answers each of them [fraction of travel].
    decimation : int
        Recorded rows in one of these.
    recorded_sample_time, sample_time : float
        From recorded row to recorded row, and from row to row [s].
    period : float
        Of the strongest swing [s]; infinite without one.
    gain_signs : tuple of int
        Signs that the process gain may have: one where the controller tells it, else both.
    """

    time: NDArray
    command: NDArray
    value: NDArray
    setpoint: NDArray | None
    used: NDArray[np.bool_]
    is_flow: bool
    span: float
    recorded_command: NDArray
    decimation: int
    recorded_sample_time: float
    sample_time: float
    period: float
    gain_signs: tuple[int, ...]

    def stretches(self) -> list["LoopSignals"]:
        """The record itself, or of a long one up to three stretches, evenly spread."""
        n = len(self.command)
        if n <= 1.25 * _STRETCH_ROWS:
            return [self]
        count = min(_MOST_STRETCHES, max(2, n // _STRETCH_ROWS))
        begins = np.linspace(0, n - _STRETCH_ROWS, count).astype(int)
        parts = [self._slice(begin, begin + _STRETCH_ROWS) for begin in begins.tolist()]
        # where all that is fresh and moves lies between the stretches, the whole is examined
        fresh = [part for part in parts if part.used.sum() >= constants.FEWEST_ROWS]
        return [part for part in fresh if part.span > 0.0] or [self]

    def _slice(self, begin: int, end: int) -> "LoopSignals":
        """The rows from `begin` up to, not including, `end`."""
        rows = slice(begin, end)
        recorded_command = self.recorded_command[begin * self.decimation : end * self.decimation]
        return replace(
            self,
            time=self.time[rows],
            command=self.command[rows],
            value=self.value[rows],
            setpoint=None if self.setpoint is None else self.setpoint[rows],
            used=self.used[rows],
            span=span_of(recorded_command),
            recorded_command=recorded_command,
        )


def value_role(recording: Recording) -> str:
    """Role of the value that a loop controls: the flow where it is known."""
    return "flow" if "flow" in recording else "process_value"


def block_means(values: NDArray, size: int) -> NDArray:
    """Means of blocks of `size` rows, along the last axis; what is over at the end is left out."""
    if size == 1:
        return values
    n = values.shape[-1] // size
    return values[..., : n * size].reshape(*values.shape[:-1], n, size).mean(axis=-1)


def span_of(command: NDArray) -> float:
    """Span of a command between its 1 % and 99 % quantiles [command's unit]."""
    return float(np.ptp(np.quantile(command, [0.01, 0.99])))


def loop_signals(recording: Recording) -> LoopSignals:
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
    source, role = recording.source, value_role(recording)
    for needed in ("command", role):
        if needed not in recording:
            raise InputError(
                f"{source}: a loop needs the roles command and flow (or process_value), and there is no "
                f"{needed}; name its column"
            )
    command, value, setpoint = filled(recording["command"]), filled(recording[role]), None
    if "setpoint" in recording:
        setpoint = filled(recording["setpoint"])
    _require_command(source, command)
    _require_value(source, role, value, setpoint, command)
    if span_of(command) <= 0.0:
        raise InputError(
            f"{source}: the command is at rest in 98 % of the rows; give a time in which it moves"
        )
    signals = _decimated(recording, command, value, setpoint)
    if signals.used.sum() < constants.FEWEST_ROWS:
        raise InputError(
            f"{source}: only {signals.used.sum()} rows hold a fresh command and {role}; give at least "
            f"{constants.FEWEST_ROWS} rows, exported as they were sampled"
        )
    return signals


def _decimated(
    recording: Recording, command: NDArray, value: NDArray, setpoint: NDArray | None
) -> LoopSignals:
    """Signals of a recording, without gaps, in rows as long as its swings allow."""
    size, period = decimation_of(command, value)
    n = len(command) // size
    ends = slice(size - 1, n * size, size)
    role = value_role(recording)
    missing = ~(np.isfinite(recording["command"]) & np.isfinite(recording[role]))
    return LoopSignals(
        time=block_means(recording.time, size),
        command=command[ends],
        value=block_means(value, size),
        setpoint=None if setpoint is None else block_means(setpoint, size),
        used=(block_means(missing.astype(float), size) < 0.5) & ~_held(command[ends], value[ends]),
        is_flow=role == "flow",
        span=span_of(command),
        recorded_command=command[: n * size],
        decimation=size,
        recorded_sample_time=recording.sample_time,
        sample_time=recording.sample_time * size,
        period=period * recording.sample_time,
        gain_signs=_gain_signs(command, value, setpoint, role == "flow"),
    )


def _gain_signs(command: NDArray, value: NDArray, setpoint: NDArray | None, is_flow: bool) -> tuple[int, ...]:
    """Signs of the process gain that are tried.

    A larger opening gives more flow, unless the controller surely shows the other sign.
    """
    process = process_gain_sign(command, value, setpoint)
    if process.sure:
        return (process.sign,)
    return (1,) if is_flow else (1, -1)


def swing_rows(values: NDArray) -> float:
    """Rows in a period of the strongest swing: the peak of frequency times power; infinite without one.

    Frequency times power is the power in an octave, so a slow wander does not hide a swing.
    """
    power = np.convolve(swing_spectrum(values), np.ones(3) / 3.0, mode="same")
    # white noise has the most power in the quickest octave
    power = np.maximum(power - _NOISE_FLOOR * np.median(power), 0.0) * np.arange(len(power))
    power[:_FEWEST_SWINGS] = 0.0
    peak = int(np.argmax(power))
    return len(values) / peak if peak else np.inf


def decimation_of(command: NDArray, value: NDArray) -> tuple[int, float]:
    """How many rows are averaged, and the period of the faster of the two signals [rows as recorded].

    As many as leave some 30 rows to a period, and 600 in all.
    """
    period = min(swing_rows(command), swing_rows(value))
    most = len(command) // _ROWS_KEPT
    return max(1, min(int(period / _ROWS_PER_SWING), most) if np.isfinite(period) else most), period


def _held(command: NDArray, value: NDArray) -> NDArray[np.bool_]:
    """Rows held by a historian, and the first row after: it shows in one step what moved in many."""
    same = np.concatenate([[False], (np.diff(command) == 0.0) & (np.diff(value) == 0.0)])
    held = np.zeros(len(same), dtype=bool)
    for begin, end in runs(same):
        if end - begin >= constants.HELD_ROWS:
            held[begin : end + 1] = True
    return held


def _require_command(source: str, command: NDArray) -> None:
    """Refuse a command outside 0 to 100 %, or at its limit."""
    low, high = constants.COMMAND_RANGE
    if command.min() < low or command.max() > high:
        raise InputError(
            f"{source}: the command runs from {command.min():.1%} to {command.max():.1%} of the travel, and "
            "a valve's command stays between 0 and 100 %; correct its unit, or name the column of the command"
        )
    share = max(np.mean(command <= 0.001), np.mean(command >= 0.999))
    if share > constants.MOST_AT_LIMIT:
        raise InputError(
            f"{source}: the command is at its limit in {share:.0%} of the rows, where no loop controls; "
            "give a time in which it does"
        )


def _require_value(
    source: str, role: str, value: NDArray, setpoint: NDArray | None, command: NDArray
) -> None:
    """Refuse a value that does not move, and a flow near zero."""
    if np.ptp(value) <= 1e-9 * np.abs(value).max():
        raise InputError(
            f"{source}: {role} holds one value ({value[0]:.3g}) in all rows; give a time in "
            "which it is measured"
        )
    if role != "flow":
        return
    most = max(np.abs(value).max(), 0.0 if setpoint is None else np.abs(setpoint).max())
    usual = float(np.median(np.abs(value)))
    if usual < constants.NEAR_ZERO_FLOW * most:
        raise InputError(
            f"{source}: the flow is near zero ({usual:.2g} in the middle, {most:.2g} at most or asked for) "
            f"while the command runs from {command.min():.1%} to {command.max():.1%}; give a time in which "
            "it flows"
        )
