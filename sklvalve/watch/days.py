# SPDX-License-Identifier: BSD-3-Clause
"""Where the rows of each day of a valve are, and these rows as a recording."""

import datetime as dt
import hashlib
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sklvalve.recording import Recording, join_recordings, read_recording
from sklvalve.recording.errors import InputError
from sklvalve.recording.reader import SUFFIXES
from sklvalve.watch.plant import Watched

_DATE = re.compile(r"(?<!\d)(\d{4})-(\d{2})-(\d{2})(?!\d)")
#: Rows of a day below which nothing is told of it.
FEWEST_ROWS = 600


@dataclass(frozen=True)
class DayFiles:
    """Files that hold one day of a valve.

    Parameters
    ----------
    day : date
    files : tuple of Path
        In the order of their names.
    """

    day: dt.date
    files: tuple[Path, ...]

    def checksum(self) -> str:
        """SHA-256 of the files' contents: a day that comes again unchanged is known by it."""
        total = hashlib.sha256()
        for file in self.files:
            with file.open("rb") as stream:
                total.update(hashlib.file_digest(stream, "sha256").digest())
        return total.hexdigest()

    def stamp(self) -> str:
        """Sizes and times of the files: what has not changed there need not be read."""
        states = [file.stat() for file in self.files]
        return " ".join(f"{s.st_size}.{s.st_mtime_ns}" for s in states)


@dataclass(frozen=True)
class Found:
    """What a valve's folder holds.

    Parameters
    ----------
    days : tuple of DayFiles
        In the order of their dates.
    unplaced : tuple of Path
        Recordings whose path names no day.
    """

    days: tuple[DayFiles, ...]
    unplaced: tuple[Path, ...] = ()


def days_of(data: Path, watched: Watched) -> Found:
    """Days of a valve that have files.

    A file belongs to the day that its path names as YYYY-MM-DD, such as ``FV-101/2026-01-31.parquet`` or
    ``FV-101/day=2026-01-31/part-0.parquet``; the folder may be named ``valve=FV-101`` as well.

    Parameters
    ----------
    data : Path
    watched : Watched

    Returns
    -------
    found : Found
    """
    days: dict[dt.date, list[Path]] = {}
    unplaced = []
    for folder in (data / watched.folder, data / f"valve={watched.folder}"):
        for file in sorted(folder.rglob("*")) if folder.is_dir() else ():
            if not file.name.lower().endswith(SUFFIXES) or file.name.startswith((".", "_")):
                continue
            day = _day_of(file.relative_to(folder))
            if day is None:
                unplaced.append(file)
            else:
                days.setdefault(day, []).append(file)
    return Found(tuple(DayFiles(day, tuple(days[day])) for day in sorted(days)), tuple(unplaced))


def read_day(files: DayFiles, watched: Watched) -> Recording:
    """Rows of one day.

    Parameters
    ----------
    files : DayFiles
    watched : Watched

    Returns
    -------
    recording : Recording

    Raises
    ------
    InputError
        If a file cannot be read, or holds rows of another day only.
    """
    read = [read_recording(file, watched.valve) for file in files.files]
    whole = read[0] if len(read) == 1 else join_recordings(read)
    whole = replace(whole, source=f"{watched.tag} {files.day}")
    return _of_the_day(whole, files.day)


def _of_the_day(recording: Recording, day: dt.date) -> Recording:
    """Rows that are stamped by the day; all where the times are seconds."""
    if not isinstance(recording.stamps[0], str):
        return recording
    mine = np.char.startswith(recording.stamps.astype(str), day.isoformat())
    if not mine.any():
        raise InputError(
            f"{recording.source}: no row is stamped by that day, the first is {recording.stamps[0]}; name "
            "the file by the day of its rows"
        )
    rows = np.flatnonzero(mine)
    return recording.slice(int(rows[0]), int(rows[-1]) + 1)


def _day_of(path: Path) -> dt.date | None:
    for part in reversed(path.parts):
        if named := _DATE.search(part):
            try:
                return dt.date(*map(int, named.groups()))
            except ValueError:
                continue
    return None
