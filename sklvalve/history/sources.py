# SPDX-License-Identifier: BSD-3-Clause
"""Which recordings a history was learnt from, and by what their rows are known again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from sklvalve.recording import Recording
from sklvalve.simulation.chain import clock_of

# one row in so many is kept as a mark, chosen by its own content: every export of a row chooses the same ones
_ONE_IN = 32
# recordings hold the same rows from this share of equal marks on, and from so many of them
_DOUBLE, _FEWEST = 0.1, 3
_ODD = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)


@dataclass(frozen=True, eq=False)
class Source:
    """One recording that a history was learnt from.

    Parameters
    ----------
    name : str
        Name of its file, without the folder.
    sha256 : str or None
        Checksum of the file.
    rows : int
    first, last : float or str
        Time of its first and its last row, as recorded.
    marks : ndarray of shape (k,), uint64
        Checksums of about one row in 32, in ascending order.
    """

    name: str
    sha256: str | None
    rows: int
    first: Any
    last: Any
    marks: np.ndarray

    @property
    def spans(self) -> tuple[datetime, datetime] | None:
        """Moments of its first and last row; None where its times are seconds."""
        if not isinstance(self.first, str) or not isinstance(self.last, str):
            return None
        return datetime.fromisoformat(self.first.strip()), datetime.fromisoformat(self.last.strip())

    def comparable(self, other: Source) -> bool:
        """Whether the times of both are dates of one kind, with an offset from UTC or without."""
        mine, theirs = self.spans, other.spans
        if mine is None or theirs is None:
            return False
        return (mine[0].tzinfo is None) == (theirs[0].tzinfo is None)

    def follows(self, other: Source) -> bool:
        """Whether it begins after the other has ended; False where nothing tells."""
        mine, theirs = self.spans, other.spans
        return self.comparable(other) and mine is not None and theirs is not None and mine[0] > theirs[1]

    def is_same(self, other: Source) -> bool:
        """Whether both are the same file from the same row on, or hold the same rows."""
        if self.sha256 is not None and self.sha256 == other.sha256 and self.first == other.first:
            return True
        equal = len(np.intersect1d(self.marks, other.marks, assume_unique=True))
        return equal >= max(_FEWEST, _DOUBLE * min(len(self.marks), len(other.marks)))


def sources_of(recording: Recording) -> Iterator[Source]:
    """Each recording of which one was joined; the recording itself where it is in one piece.

    Parameters
    ----------
    recording : Recording

    Yields
    ------
    source : Source
    """
    begins = [piece.begins for piece in recording.pieces]
    for low, high in recording.spans:
        part = recording.slice(low, high)
        source, sha256 = recording.source, recording.sha256
        if begins:
            piece = recording.pieces[int(np.searchsorted(begins, part.time[0], side="right")) - 1]
            source, sha256 = piece.source, piece.sha256
        first, last = (_plain(part.stamps[row]) for row in (0, -1))
        yield Source(Path(source).name, sha256, len(part), first, last, marks_of(part))


def shared(one: Sequence[Source], other: Sequence[Source]) -> Source | None:
    """The first recording of the other that one holds already; None where there is none."""
    return next((theirs for theirs in other for mine in one if mine.is_same(theirs)), None)


def marks_of(recording: Recording) -> np.ndarray:
    """Checksums of some rows of a recording, time and values, chosen by their own content.

    Parameters
    ----------
    recording : Recording
        In one piece.

    Returns
    -------
    marks : ndarray of shape (k,), uint64
        In ascending order, each once.
    """
    mixed = _stirred(np.round(1e3 * clock_of(recording)).astype(np.int64).view(np.uint64))
    for role in sorted(recording):
        # in single precision, so that a conversion of units leaves no trace; a gap is a gap
        values = np.where(np.isnan(recording[role]), np.float32(np.nan), recording[role].astype(np.float32))
        bits = np.ascontiguousarray(values + np.float32(0.0), dtype=np.float32).view(np.uint32)
        mixed = _stirred(mixed * _ODD[0] ^ bits.astype(np.uint64))
    return np.unique(mixed[mixed % np.uint64(_ONE_IN) == 0])


def _stirred(words: np.ndarray) -> np.ndarray:
    """Each word with its bits mixed (the finaliser of splitmix64)."""
    with np.errstate(over="ignore"):
        words = (words ^ (words >> np.uint64(30))) * _ODD[1]
        words = (words ^ (words >> np.uint64(27))) * _ODD[2]
    return words ^ (words >> np.uint64(31))


def _plain(stamp: Any) -> Any:
    return stamp if isinstance(stamp, str) else float(stamp)
