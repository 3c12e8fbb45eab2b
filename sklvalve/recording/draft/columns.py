# SPDX-License-Identifier: BSD-3-Clause
"""Columns of a recording by what they hold: the time, numbers, and what is neither."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.columns import to_numbers
from sklvalve.recording.errors import InputError, hint
from sklvalve.recording.tags import (
    NameReading,
    UnitReading,
    read_name,
    read_time_name,
    read_unit,
    split_unit,
)
from sklvalve.recording.timebase import read_time


@dataclass(frozen=True)
class Column:
    """A column of numbers, and what its name says.

    Parameters
    ----------
    name : str
    values : ndarray of shape (n,), float64
        As recorded; NaN where a cell is empty.
    reading : NameReading
    unit : UnitReading or None
        Known unit in the name.
    """

    name: str
    values: NDArray[np.float64]
    reading: NameReading
    unit: UnitReading | None

    @property
    def shown(self) -> str:
        """The column's name and its range, for a person."""
        held = self.values[np.isfinite(self.values)]
        return f"{self.name!r} (from {held.min():.4g} to {held.max():.4g})"


@dataclass(frozen=True)
class RecordingColumns:
    """Columns of a recording: which is the time, those of numbers, and names of those that hold none."""

    source: str
    time: str
    columns: tuple[Column, ...]
    others: tuple[str, ...]

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.columns[0].values)

    def column(self, name: str) -> Column:
        """The column of a name."""
        return next(column for column in self.columns if column.name == name)


def read_recording_columns(
    columns: Mapping[str, NDArray], source: str, time_column: str | None = None
) -> RecordingColumns:
    """Tell the time column from the signals.

    Parameters
    ----------
    columns : mapping of str to ndarray of shape (n,)
        As read from a file.
    source : str
        For messages.
    time_column : str or None, default=None
        Name of the column of the times; None finds it.

    Returns
    -------
    told : RecordingColumns

    Raises
    ------
    InputError
        If no column holds rising times, or not the one that is named, or none numbers.
    """
    time = _time_column(columns, source) if time_column is None else _asked(columns, source, time_column)
    numbers, others = [], []
    for name, cells in columns.items():
        if name == time or not name:
            continue
        try:
            values = to_numbers(cells, source)
        except InputError:
            others.append(name)
            continue
        if np.isfinite(values).any():
            numbers.append(Column(name, values, read_name(name), read_unit(split_unit(name)[1])))
        else:
            others.append(name)
    if not numbers:
        raise InputError(f"{source}: no column but the time holds numbers; give a recording of signals")
    return RecordingColumns(source, time, tuple(numbers), tuple(others))


def _asked(columns: Mapping[str, NDArray], source: str, name: str) -> str:
    """The column that is named as that of the times."""
    found = next((each for each in columns if each.casefold() == name.strip().casefold()), None)
    if found is None:
        raise InputError(f"--time-column {name}: {source} has no such column; {hint(name, columns)}")
    read_time(columns[found], f"{source}: column {found!r} (time)")
    return found


def _time_column(columns: Mapping[str, NDArray], source: str) -> str:
    units = {name: read_time_name(name) for name in columns}
    # T may be a temperature, and data the dates: whatever is named most plainly goes first
    named = sorted(
        (name for name, unit in units.items() if unit is not None),
        key=lambda name: not name.casefold().startswith(("time", "date")),
    )
    first = next(iter(columns))
    refusals = []
    for name in dict.fromkeys([*named, first]):
        try:
            base = read_time(columns[name], f"{source}: column {name!r} (time)")
        except InputError as error:
            refusals.append(error)
            continue
        if units[name] not in (None, "", "s") and base.stamps.dtype.kind in "fiu":
            raise InputError(
                f"{source}: column {name!r} does not count seconds, by its name, and a recording does; make "
                "it one by sklvalve import"
            )
        return name
    if named:
        raise refusals[0]
    raise InputError(
        f"{source}: no column is named time, and the first, {first!r}, holds no rising times; make it a "
        "recording by sklvalve import, or name the column of the time so"
    )
