# SPDX-License-Identifier: BSD-3-Clause
"""A recording: what was measured, by role, in SI, on one time base."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sklvalve.recording._assembly import Parts, assemble, frame_columns, named_roles, roles_in_units
from sklvalve.recording._selecting import Selecting
from sklvalve.recording._showing import Showing
from sklvalve.recording.dead_bands import DeadBand
from sklvalve.recording.errors import InputError, hint
from sklvalve.recording.signal import ROLES, Signal, si_signal
from sklvalve.recording.timebase import read_time
from sklvalve.recording.valve import Valve

# A role that was not recorded is written as the role that is its nearest kin
_KIN = {
    "opening": ("simulated_opening", "command"),
    "simulated_opening": ("opening", "command"),
    "flow": ("simulated_flow",),
    "simulated_flow": ("flow",),
}


@dataclass(frozen=True)
class Piece:
    """One of the recordings that were joined.

    Parameters
    ----------
    source : str
        Its file.
    sha256 : str or None
        Checksum of the file.
    begins : float
        Where on the common clock its first row stands [s].
    assumed : bool, default=False
        Whether that is not known, because the times of the recordings begin anew.
    """

    source: str
    sha256: str | None
    begins: float
    assumed: bool = False


@dataclass(frozen=True, eq=False, repr=False)
class Recording(Selecting, Showing):
    """Signals of one valve by role, in SI, on one time base; gaps are NaN and stay so.

    Parameters
    ----------
    time : ndarray of shape (n,)
        Seconds from the first sample of the recording [s]; a slice keeps the clock of the whole.
    stamps : ndarray of shape (n,)
        The times as recorded: numbers [s] or ISO 8601 texts.
    signals : dict of ndarray of shape (n,)
        Role -> values in SI: opening and command [1] (0 = shut, 1 = open), pressures [Pa, absolute],
        temperature [K], flow [m3/s], or [kg/s] where `mass_flow`.
    valve : Valve
        What is known of the valve, and how the signals were recorded.
    constants : frozenset of str
        Roles that the valve gives as a constant instead of a column.
    mass_flow : bool, default=False
        Whether flow was recorded by mass.
    source : str
        File, or ``"data frame"``.
    sha256 : str or None
        Checksum of the file.
    pieces : tuple of Piece
        The recordings of which this one was joined (`join_recordings`); empty for a single one.
    bands : dict
        Role -> dead bands of its historian, a tuple of `DeadBand`. Empty unless a diagnosis found any.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.recording import Recording
    >>> frame = {"time": np.arange(5.0), "command": np.full(5, 0.5), "flow": [1e-3, 1e-3, np.nan, 2e-3, 2e-3]}
    >>> recording = Recording.from_frame(frame)
    >>> len(recording), recording.sample_time, "opening" in recording
    (5, 1.0, False)
    >>> recording.until(2.0)["flow"]
    array([0.001, 0.001,   nan])
    >>> recording[1.0:3.0]["flow"]
    array([0.001,   nan, 0.002])
    >>> recording
    <Recording data frame: 5 rows, 1 s apart, from 0 s to 4 s; command [1], flow [m3/s]>
    """

    time: NDArray[np.float64]
    stamps: NDArray
    signals: dict[str, NDArray[np.float64]]
    valve: Valve = field(default_factory=Valve)
    constants: frozenset[str] = frozenset()
    mass_flow: bool = False
    source: str = "data frame"
    sha256: str | None = None
    pieces: tuple[Piece, ...] = ()
    bands: dict[str, tuple[DeadBand, ...]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.time)

    def __contains__(self, role: object) -> bool:
        return role in self.signals

    def __iter__(self) -> Iterator[str]:
        return iter(self.signals)

    @overload
    def get(self, role: str) -> NDArray[np.float64] | None: ...
    @overload
    def get(self, role: str, default: NDArray[np.float64]) -> NDArray[np.float64]: ...
    @overload
    def get(self, role: str, default: None) -> NDArray[np.float64] | None: ...

    def get(self, role: str, default: NDArray[np.float64] | None = None) -> NDArray[np.float64] | None:
        """Values of a role, or `default` where it was not recorded."""
        return self.signals.get(role, default)

    @property
    def sample_time(self) -> float:
        """Median step between samples [s]; NaN for fewer than two samples."""
        return float(np.median(np.diff(self.time))) if len(self) > 1 else float("nan")

    def signal(self, role: str) -> Signal:
        """How a role stands in the recording, or would by its nearest kin; in SI where there is none."""
        if role not in ROLES:
            raise InputError(f"{role!r} is no role; {hint(role, ROLES)}")
        for candidate in (role, *_KIN.get(role, ())):
            if candidate in self.valve.roles:
                return self.valve.roles[candidate]
        return si_signal(role, mass_flow=self.mass_flow)

    def unit(self, role: str) -> str:
        """Unit in which the recording holds a role, or would by its nearest kin (see `in_recorded_units`)."""
        return self.signal(role).unit

    def in_recorded_units(self, role: str, values: ArrayLike) -> NDArray[np.float64]:
        """Values as the recording would hold them: its unit, its sense, its gauge.

        Parameters
        ----------
        role : str
            Role of the values. A role that was not recorded takes the form of its nearest kin (an opening
            that of the command), else SI.
        values : array-like of shape (n,)
            Values in SI.

        Returns
        -------
        recorded : ndarray of shape (n,)

        Raises
        ------
        InputError
            If the role is not known.
        """
        return self.signal(role).from_si(values)

    def per_si(self, role: str) -> float:
        """What a difference of one in SI is in the recorded unit; negative in the other sense."""
        zero, one = self.in_recorded_units(role, np.array([0.0, 1.0]))
        return float(one - zero)

    def resolution(self, role: str) -> float:
        """Smallest step between two distinct recorded values of a role, in SI; 0 where all are equal.

        The step is measured on the numbers as they were written, so that the conversion to SI leaves no trace
        in it.
        """
        recorded = self.in_recorded_units(role, self[role])
        recorded = recorded[np.isfinite(recorded)]
        if not len(recorded):
            return 0.0
        largest = np.abs(recorded).max()
        digits = 10 - int(np.ceil(np.log10(largest))) if largest > 0.0 else 10
        distinct = np.unique(np.round(recorded, digits))
        step = np.diff(distinct).min() * self.signal(role).slope if len(distinct) > 1 else 0.0
        return float(f"{step:.11g}")

    @classmethod
    def from_frame(
        cls,
        frame: object,
        valve: Valve | None = None,
        *,
        units: Mapping[str, object] | None = None,
    ) -> "Recording":
        """Recording of a data frame, or of a mapping of column names to arrays.

        Parameters
        ----------
        frame : pandas or polars DataFrame, or mapping
            Without a valve, or with one that names no roles, the columns are role names and hold SI values
            unless `units` says otherwise (other columns are left out); otherwise the valve says which column
            is which, and in which unit. Times come from the valve's time column (``"time"``), or from an
            index of that name, of dates or of time differences. Dates keep their time zone.
        valve : Valve or None
        units : mapping or None, default=None
            Role -> unit of its column, such as ``{"flow": "m3/h", "p1": "bar"}``, pressures being absolute;
            or role -> what a section of valve.toml says of it, such as ``{"unit": "bar", "gauge": True}``.
            Roles that it does not name are in SI.

        Returns
        -------
        recording : Recording

        Raises
        ------
        InputError
            If there is no time, no role, or a column cannot be used; if a unit is none of its role's; if
            `units` are given beside a valve that names roles.

        Examples
        --------
        >>> from sklvalve.recording import Recording
        >>> frame = {"time": [0.0, 1.0], "p1": [5.0, 6.0], "command": [50.0, 25.0]}
        >>> recording = Recording.from_frame(frame, units={"p1": "bar", "command": "%"})
        >>> recording["p1"].tolist(), recording["command"].tolist()
        ([500000.0, 600000.0], [0.5, 0.25])
        """
        sheet = valve or Valve()
        columns, where = frame_columns(frame, sheet.time), "data frame"
        if units is not None:
            sheet = replace(sheet, roles=roles_in_units(columns, units, sheet, where))
        elif not sheet.roles:
            sheet = replace(sheet, roles=named_roles(columns, where))
        return cls.from_columns(columns, sheet, where)

    @classmethod
    def from_columns(
        cls, columns: Mapping[str, object], valve: Valve, source: str, sha256: str | None = None
    ) -> "Recording":
        """Recording of columns by name, laid out as the valve says; `source` is what messages call them."""
        parts: Parts = assemble(columns, valve, source)
        base = read_time(parts.time, f"{source}: column {valve.time!r}")
        return cls(
            base.seconds, base.stamps, parts.signals, valve, parts.constants, parts.mass_flow, source, sha256
        )
