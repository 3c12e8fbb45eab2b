# SPDX-License-Identifier: BSD-3-Clause
"""Which recordings a history was learnt from."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.history.sources import Source
from sklvalve.simulation.state import number

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory

_KEYS = {"name", "sha256", "rows", "first", "last"}
_SHA256 = re.compile(r"[0-9a-f]{64}")
_LONGEST = 1000


def told(history: ValveHistory) -> dict[str, Any]:
    """Names, checksums, times and rows; marks of all one behind the other, and how many each has."""
    sources = history.recordings_
    return {
        "each": [{key: getattr(source, key) for key in sorted(_KEYS)} for source in sources],
        "marks": np.concatenate([np.empty(0, np.uint64), *(source.marks for source in sources)]),
        "counts": np.array([len(source.marks) for source in sources], dtype=np.int64),
    }


def put_back(history: ValveHistory, part: dict[str, Any]) -> None:
    """Set the recordings again."""
    marks = np.split(part["marks"], np.cumsum(part["counts"])[:-1])
    history.recordings_ = [Source(**each, marks=m) for each, m in zip(part["each"], marks, strict=True)]


def require_sound(part: dict[str, Any], whole: dict[str, Any], effects: Sequence[Any]) -> None:
    """Refuse recordings that are none; ``ValueError``."""
    several, marks, counts = part.get("each"), part.get("marks"), part.get("counts")
    if not isinstance(several, list | tuple) or not several:
        raise ValueError("it names no recordings")
    for each in several:
        _require_sound_source(each)
    if not isinstance(marks, np.ndarray) or marks.dtype != np.uint64 or marks.ndim != 1:
        raise ValueError("the marks of its rows are none")
    if not isinstance(counts, np.ndarray) or counts.dtype.kind != "i" or counts.shape != (len(several),):
        raise ValueError("the marks of its rows are not counted")
    if (counts < 0).any() or (counts > len(marks)).any() or int(counts.sum()) != len(marks):
        raise ValueError("the marks of its rows are miscounted")


def _require_sound_source(each: Any) -> None:
    if not isinstance(each, dict) or set(each) != _KEYS:
        raise ValueError("a recording of it is none")
    if not isinstance(each["name"], str) or len(each["name"]) > _LONGEST:
        raise ValueError("a recording of it has no name")
    if each["sha256"] is not None and not _SHA256.fullmatch(str(each["sha256"])):
        raise ValueError("the checksum of a recording is none")
    number(each["rows"], "the rows of a recording", 1)
    for key in ("first", "last"):
        if not isinstance(each[key], str):
            number(each[key], "the time of a recording", -1e300, 1e300)
    dates = [isinstance(each[key], str) for key in ("first", "last")]
    try:
        read = Source(**each, marks=np.empty(0, np.uint64)).spans
    except ValueError:
        raise ValueError("the time of a recording is none") from None
    if any(dates) != all(dates) or (read and (read[0].tzinfo is None) != (read[1].tzinfo is None)):
        raise ValueError("the times of a recording are of two kinds")
