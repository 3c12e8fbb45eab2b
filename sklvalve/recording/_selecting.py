# SPDX-License-Identifier: BSD-3-Clause
"""Parts of a recording: a role's values, rows by number, rows by time."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Self, overload

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError, hint, shown
from sklvalve.recording.signal import ROLES
from sklvalve.recording.timebase import day_after, is_day, seconds_at

if TYPE_CHECKING:
    from sklvalve.recording.recording import Piece


class Selecting:
    """Methods of a `Recording` that take a part of it and change nothing."""

    time: NDArray[np.float64]
    stamps: NDArray
    signals: dict[str, NDArray[np.float64]]
    source: str
    pieces: "tuple[Piece, ...]"

    @overload
    def __getitem__(self, role: str) -> NDArray[np.float64]: ...
    @overload
    def __getitem__(self, role: slice) -> Self: ...

    def __getitem__(self, role: str | slice) -> NDArray[np.float64] | Self:
        if isinstance(role, slice):
            return self._at_times(role)
        if _is_whole(role) and not isinstance(role, bool):
            behind = None if role == -1 else int(role) + 1
            raise InputError(
                f"a recording has no row [{role}] of its own; write slice({role}, {behind}) for that row, or "
                "['flow'] for one signal"
            )
        if not isinstance(role, str):
            raise InputError(
                f"a recording is asked for one role, such as 'flow', or for times; got {shown(role)}: take "
                "to_frame() for several columns"
            )
        if role not in self.signals:
            if role not in ROLES:
                raise InputError(f"{role!r} is no role; {hint(role, ROLES)}")
            raise InputError(
                f"{self.source}: there is no {role}; the recording holds {', '.join(self.signals)}"
            )
        return self.signals[role]

    def _at_times(self, times: slice) -> Self:
        if times.step is not None:
            raise InputError("a recording is cut by two times, and has no step; leave it out")
        if any(_is_whole(end) for end in (times.start, times.stop)):
            raise InputError(
                f"[{shown(times.start)}:{shown(times.stop)}] could mean rows or seconds; write "
                "between(...) for times, or slice(...) for rows"
            )
        return self.between(times.start, times.stop)

    def slice(self, start: int | None, stop: int | None) -> Self:
        """Rows from `start` up to, not including, `stop`; the clock stays that of the whole recording."""
        if not all(end is None or (_is_whole(end) and not isinstance(end, bool)) for end in (start, stop)):
            raise InputError(
                f"slice({shown(start)}, {shown(stop)}) is no count of rows; give whole numbers, or write "
                "between(...) for times"
            )
        rows = slice(start, stop)
        signals = {role: values[rows] for role, values in self.signals.items()}
        return replace(self, time=self.time[rows], stamps=self.stamps[rows], signals=signals)  # type: ignore[type-var]

    @property
    def spans(self) -> list[tuple[int, int]]:
        """First row, and the row behind the last, of each recording that was joined and has any rows here."""
        inner = np.searchsorted(self.time, [piece.begins for piece in self.pieces[1:]])
        edges = [0, *inner.tolist(), len(self.time)]
        return [(low, high) for low, high in pairwise(edges) if high > low]

    def index_until(self, time_value: object) -> int:
        """Number of rows up to and including a time given as the recording writes its own.

        Parameters
        ----------
        time_value : float, str or datetime
            A number of the time column, or a date or an ISO 8601 text where the recording has these; of the
            last one where several were joined that know no common clock.

        Returns
        -------
        rows : int

        Raises
        ------
        InputError
            If the value is no time of this recording's kind.
        """
        seconds = self._seconds(time_value)
        # a stamp given to its last printed digit must include its own row
        return int(np.searchsorted(self.time, seconds + _least(seconds), side="right"))

    def until(self, time_value: object) -> Self:
        """Rows up to and including a time; `InputError` where there is none."""
        stop = self.index_until(time_value)
        if stop == 0:
            raise InputError(f"{self.source}: no row stands at or before time {time_value}; {self._span()}")
        return self.slice(0, stop)

    def after(self, time_value: object) -> Self:
        """Rows after a time; `InputError` where there is none."""
        start = self.index_until(time_value)
        if start == len(self.time):
            raise InputError(f"{self.source}: no row stands after time {time_value}; {self._span()}")
        return self.slice(start, None)

    def between(self, start: Any = None, stop: Any = None) -> Self:
        """Rows from one time to another, both included; ``recording[start:stop]`` is the same.

        Parameters
        ----------
        start, stop : float, str, datetime or None
            Times as the recording writes its own: numbers of its time column, or dates and ISO 8601 texts.
            A `stop` that is a day without a time of day includes that day. None is the recording's own end.

        Returns
        -------
        part : Recording
            Its clock stays that of the whole recording.

        Raises
        ------
        InputError
            If a value is no time of this recording's kind, or no row stands between the two.

        Examples
        --------
        >>> import numpy as np
        >>> from sklvalve.recording import Recording
        >>> hours = np.arange("2024-06-28T10", "2024-06-28T15", dtype="datetime64[h]")
        >>> recording = Recording.from_frame({"time": hours, "command": np.linspace(0.0, 1.0, 5)})
        >>> recording["2024-06-28T11:00":"2024-06-28T12:30"]["command"]
        array([0.25, 0.5 ])
        """
        return self.slice(*rows_between(self.time, self._seconds, start, stop, self.source, self._span))

    def _seconds(self, value: object) -> float:
        if not len(self.time):
            raise InputError(f"{self.source}: there are no rows to be cut")
        row = self.spans[-1][0]
        return seconds_at(value, self.stamps[row], float(self.time[row]))

    def _span(self) -> str:
        return f"give a time between {self.stamps[0]} and {self.stamps[-1]}"


def rows_between(
    time: NDArray[np.float64],
    seconds_of: Callable[[object], float],
    start: object,
    stop: object,
    source: str,
    span: Callable[[], str],
) -> tuple[int, int]:
    """First row at or after one time, and the row behind the last at or before another.

    Parameters
    ----------
    time : ndarray of shape (n,)
        Of each row [s].
    seconds_of : callable
        Seconds on that clock of a time as people write it.
    start, stop : object or None
        A `stop` that is a day without a time of day includes that day.
    source : str
        What the rows are of.
    span : callable
        Words for the times that they have.

    Raises
    ------
    InputError
        If no row stands between the two.
    """
    first, last = 0, len(time)
    if start is not None:
        seconds = seconds_of(start)
        first = int(np.searchsorted(time, seconds - _least(seconds), side="left"))
    if stop is not None:
        seconds = seconds_of(stop)
        if is_day(stop):
            next_day = seconds_of(day_after(stop))
            last = int(np.searchsorted(time, next_day - _least(next_day), side="left"))
        else:
            last = int(np.searchsorted(time, seconds + _least(seconds), side="right"))
    if first < last:
        return first, last
    if start is not None and stop is not None and seconds_of(start) > seconds_of(stop):
        raise InputError(
            f"{source}: {_words(start, '')} is after {_words(stop, '')}; give the earlier time first"
        )
    raise InputError(
        f"{source}: no row stands between {_words(start, 'its beginning')} and "
        f"{_words(stop, 'its end')}; {span()}"
    )


def _is_whole(end: object) -> bool:
    # to numpy a time difference is an integer
    return isinstance(end, int | np.integer) and not isinstance(end, np.timedelta64)


def _least(seconds: float) -> float:
    return 1e-9 * max(1.0, abs(seconds))


def _words(time: object, otherwise: str) -> str:
    return otherwise if time is None else shown(time) if isinstance(time, str) else str(time)
