# SPDX-License-Identifier: BSD-3-Clause
"""One clock for all files of an export: UTC where the zone is known, and back to stamps for the recording."""

from collections.abc import Callable, Sequence
from datetime import UTC, tzinfo

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError
from sklvalve.recording.historian.layout import Clock, Layout, Series
from sklvalve.recording.historian.moments import SECOND, DateOrder, Moments, date_order, read_moments
from sklvalve.recording.historian.table import Table
from sklvalve.recording.historian.zones import (
    ClockChanges,
    offsets_at,
    read_zone,
    runs_back_in_autumn,
    to_utc,
)

_MINUTE = 60 * SECOND
# rows whose times are written out together
_PART = 100_000


class Timeline:
    """Reads the clocks of all files, and writes the stamps of the recording.

    Parameters
    ----------
    files : sequence of (Table, Layout)
    zone : str or None
        Time zone of local times, and of the stamps that are written.
    day_first : bool or None
        How to read 03/04/2024; None finds it.

    Attributes
    ----------
    kind : {"seconds", "local", "offset"}
        What the export's times are.
    order : DateOrder
    changes : ClockChanges
        What clock changes made necessary so far.

    Raises
    ------
    InputError
        If a time cannot be read, files differ in their kind of time, or a zone is given to counted seconds.
    """

    def __init__(
        self, files: Sequence[tuple[Table, Layout]], zone: str | None, day_first: bool | None
    ) -> None:
        self.changes = ClockChanges()
        self._files = files
        self.zone: tzinfo | None = None if zone is None else read_zone(zone)
        source = ", ".join(str(table.file) for table, _ in files)
        if day_first is None:
            cells = {cell for _, layout in files for clock in layout.clocks for cell in clock.cells}
            self.order = date_order(cells, source)
        else:
            self.order = DateOrder(day_first)
        self._moments: dict[tuple[int, int], Moments] = {}
        for number, (table, layout) in enumerate(files):
            for place, clock in enumerate(layout.clocks):
                self._moments[number, place] = self._read(table, clock)
        self.kind = self._one_kind(zone)
        self._written_offset = self._common_offset()

    def timed(self, number: int, series: Series) -> NDArray[np.intp]:
        """Which cells of a series of file `number` have a time.

        Raises
        ------
        InputError
            If a value stands without one.
        """
        table, layout = self._files[number]
        cells = layout.clocks[series.clock].cells
        timed = np.array([bool(cells[row]) for row in series.rows], dtype=bool)
        lost = next((place for place in np.flatnonzero(~timed) if series.values[place]), None)
        if lost is not None:
            raise InputError(
                f"{table.place(int(series.rows[lost]))}: the value of {series.tag} stands without a time; "
                "write it there, or leave the line out"
            )
        return np.flatnonzero(timed)

    def read_ticks(self, number: int, clock: int) -> NDArray[np.int64]:
        """Times of file `number` as they are written [us], in UTC only where they say so; 0 where none is."""
        moments = self._moments[number, clock]
        return moments.ticks if moments.offsets is None else moments.ticks - moments.offsets

    def times(self, number: int, clock: int, rows: NDArray[np.intp]) -> NDArray[np.int64]:
        """Moments of one stream of rows of file `number` [us], in UTC where it is known.

        Raises
        ------
        InputError
            If a time does not exist, or local times run back without a zone.
        """
        table = self._files[number][0]
        moments = self._moments[number, clock]
        ticks = moments.ticks[rows]
        if moments.offsets is not None:
            return ticks - moments.offsets[rows]
        if self.kind == "local" and self.zone is not None:
            return to_utc(ticks, self.zone, lambda row: table.place(int(rows[row])), self.changes)
        if self.kind == "local":
            self._require_no_change(ticks, lambda row: table.place(int(rows[row])))
        return ticks

    def stamps(self, base: NDArray[np.int64]) -> NDArray:
        """The base as the recording writes it: seconds, or ISO 8601 with the offset from UTC, if known."""
        if self.kind == "seconds":
            return base / SECOND
        if self.kind == "local" and self.zone is None:
            return _iso(base)
        offsets = (
            offsets_at(base, self.zone)
            if self.zone is not None
            else np.full(len(base), self._written_offset, dtype=np.int64)
        )
        texts = _iso(base + offsets)
        for offset in np.unique(offsets):
            texts[offsets == offset] += _ending(int(offset), self.zone)
        return texts

    def _read(self, table: Table, clock: Clock) -> Moments:
        rows = [row for row, cell in enumerate(clock.cells) if cell]
        if not rows:
            raise InputError(f"{table.file}: column {clock.name!r} holds no times; export with time stamps")
        found = read_moments(
            [clock.cells[row] for row in rows],
            clock.unit,
            self.order.day_first,
            lambda place: table.place(rows[place]),
        )
        ticks, offsets = np.zeros((2, len(clock.cells)), dtype=np.int64)
        ticks[rows] = found.ticks
        if found.offsets is None:
            return Moments(found.kind, ticks)
        offsets[rows] = found.offsets
        return Moments(found.kind, ticks, offsets)

    def _one_kind(self, zone: str | None) -> str:
        kinds = {moments.kind: self._files[number][0] for (number, _), moments in self._moments.items()}
        called = {
            "seconds": "seconds from a start",
            "local": "times without an offset from UTC",
            "offset": "times with an offset from UTC",
        }
        if len(kinds) > 1:
            (one, here), (other, there) = list(kinds.items())[:2]
            raise InputError(
                f"{there.file}: it holds {called[other]}, but {here.file} {called[one]}; export "
                "all in one form"
            )
        kind = next(iter(kinds))
        if kind == "seconds" and zone is not None:
            raise InputError(
                f"--timezone {zone}: the times of {next(iter(kinds.values())).file} are seconds from a "
                "start, which no zone changes; leave it out"
            )
        return kind

    def _common_offset(self) -> int:
        """Offset [us] of all times where they share one, else nought, which is UTC."""
        found = [moments.offsets for moments in self._moments.values() if moments.offsets is not None]
        offsets = np.unique(np.concatenate(found)) if found else np.zeros(1, dtype=np.int64)
        return int(offsets[0]) if len(offsets) == 1 else 0

    @staticmethod
    def _require_no_change(ticks: NDArray[np.int64], place: Callable[[int], str]) -> None:
        row = runs_back_in_autumn(ticks)
        if row is not None:
            before, after = _iso(ticks[[row - 1, row]])
            raise InputError(
                f"{place(row)}: the time {after} comes after {before}, as on the night when clocks are set "
                "back; name the zone of these times, such as --timezone Europe/Warsaw"
            )


def _iso(ticks: NDArray[np.int64]) -> NDArray:
    """Texts of moments [us], to the second where that says all of them, else to the ms or us."""
    units = ((SECOND, "s"), (1000, "ms"), (1, "us"))
    unit = next(unit for step, unit in units if not (ticks % step).any())
    texts = np.empty(len(ticks), dtype=object)
    # in parts: numpy's own texts of millions of rows take several times the room of these
    for low in range(0, len(ticks), _PART):
        part = slice(low, low + _PART)
        moments = ticks[part].astype("datetime64[us]")
        texts[part] = np.datetime_as_string(moments, unit=unit)  # type: ignore[call-overload]
    return texts


def _ending(offset: int, zone: tzinfo | None) -> str:
    if offset == 0 and zone in (None, UTC):
        return "Z"
    minutes = abs(offset) // _MINUTE
    return f"{'-' if offset < 0 else '+'}{minutes // 60:02d}:{minutes % 60:02d}"
