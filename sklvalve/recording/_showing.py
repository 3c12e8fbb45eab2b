# SPDX-License-Identifier: BSD-3-Clause
"""A recording as one sees it: in a line, as a table, as a picture, as a data frame."""

from datetime import datetime
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.drawing import draw, unit_words
from sklvalve.recording.errors import one_line

if TYPE_CHECKING:
    from pandas import DataFrame

    from sklvalve.recording.recording import Recording

_HEAD = ("role", "column", "unit", "least", "middle", "largest", "gaps")
_LONGEST = 80  # letters of a name


class Showing:
    """Methods of a `Recording` that show it."""

    def __repr__(self: "Recording") -> str:  # type: ignore[misc]
        signals = ", ".join(f"{role} [{unit_words(self.signal(role))}]" for role in self.signals)
        return f"<Recording {_name(self.source)}: {_extent(self)}; {signals}>"

    def _repr_html_(self: "Recording") -> str:  # type: ignore[misc]
        head = "".join(f"<th>{name}</th>" for name in _HEAD)
        body = "".join(
            "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in _row(self, role)) + "</tr>"
            for role in self.signals
        )
        title = f"<strong>{escape(_name(self.source))}</strong>: {escape(_extent(self))}"
        return f"<div><p>{title}</p><table><tr>{head}</tr>{body}</table></div>"

    def plot(self: "Recording", roles: Any = None, *, ax: Any = None) -> NDArray:  # type: ignore[misc]
        """Draw the signals over time, as they were recorded.

        Parameters
        ----------
        roles : str, sequence of str or None, default=None
            The signals to draw; None draws all but constants.
        ax : Axes or sequence of Axes, default=None
            One for each kind of signal and unit; a new figure where None.

        Returns
        -------
        axes : ndarray of Axes
            One for each kind of signal and unit: travel, flow, pressure, and so on. Values are in recorded
            units, their sense and gauge included. Times are dates where the recording has dates, in the
            offset from UTC of its first row.

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        InputError
            If a role was not recorded, or there is nothing to draw.
        ValueError
            If `ax` does not hold as many Axes as there are kinds of signals.

        See Also
        --------
        sklvalve.report.RecordingDisplay : The picture that a report holds.
        """
        return draw(self, roles, ax)

    def to_frame(self: "Recording", *, units: str = "si") -> "DataFrame":  # type: ignore[misc]
        """Data frame with a column for each role.

        Parameters
        ----------
        units : {"si", "recorded"}, default="si"
            "si": values in SI, and the seconds from the first sample as index. "recorded": values in
            recorded units, sense and gauge included, and the times as recorded as index, dates where these
            are dates, in UTC where their offsets from it differ. ``frame.attrs["units"]`` holds the units by
            role.

        Returns
        -------
        frame : DataFrame of shape (n, n_roles)
            Its index is named ``time``.

        Raises
        ------
        ImportError
            If pandas is not installed.
        ValueError
            If `units` is neither of the two.

        Examples
        --------
        >>> from sklvalve.recording import Recording
        >>> frame = {"time": [0.0, 1.0], "flow": [36.0, 72.0]}
        >>> recording = Recording.from_frame(frame, units={"flow": "m3/h"})
        >>> recording.to_frame()["flow"].tolist()
        [0.01, 0.02]
        >>> recording.to_frame(units="recorded")["flow"].tolist()
        [36.0, 72.0]
        """
        if units not in ("si", "recorded"):
            raise ValueError(f'units must be "si" or "recorded"; got {units!r}')
        try:
            from pandas import DataFrame, Index, to_datetime
        except ImportError:
            raise ImportError('a data frame needs pandas: pip install "sklvalve[io]"') from None
        if units == "si":
            return DataFrame(dict(self.signals), index=Index(self.time, name="time"))
        values = {role: self.in_recorded_units(role, self[role]) for role in self.signals}
        times = self.stamps
        if len(times) and isinstance(times[0], str):
            moments = [datetime.fromisoformat(time.strip()) for time in times]
            # offsets change between winter and summer, and an index has one
            several = len({moment.utcoffset() for moment in moments}) > 1
            times = to_datetime(moments, utc=several)
        frame = DataFrame(values, index=Index(times, name="time"))
        frame.attrs["units"] = {role: self.unit(role) for role in self.signals}
        return frame


def _name(text: object) -> str:
    words = one_line(str(text))
    return words if len(words) <= _LONGEST else f"{words[: _LONGEST - 3]}..."


def _extent(recording: "Recording") -> str:
    """Rows, step and the two ends of the clock."""
    n = len(recording)
    if not n:
        return "no rows"
    step = f", {recording.sample_time:.6g} s apart" if n > 1 else ""
    joined = f" in {len(recording.spans)} recordings" if recording.pieces else ""
    begin, end = (_name(s if isinstance(s, str) else f"{s:.12g} s") for s in recording.stamps[[0, -1]])
    return f"{n} row{'s' if n > 1 else ''}{step}{joined}, from {begin} to {end}"


def _row(recording: "Recording", role: str) -> tuple[str, ...]:
    signal, values = recording.signal(role), recording.in_recorded_units(role, recording[role])
    known = values[np.isfinite(values)]
    column = "constant" if role in recording.constants else _name(signal.column)
    numbers = [f"{of(known):.6g}" if len(known) else "" for of in (np.min, np.median, np.max)]
    return (role, column, unit_words(signal), *numbers, str(len(values) - len(known)))
