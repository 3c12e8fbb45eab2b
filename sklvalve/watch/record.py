# SPDX-License-Identifier: BSD-3-Clause
"""What is kept of a day, of a call for attention, and of an inspection."""

from __future__ import annotations

import datetime as dt
from dataclasses import asdict, dataclass
from typing import Any

from sklvalve.watch.score import Score, Share

#: Verdict of a look that found nothing: the days differ, and the physics does not.
NOTHING = "no_mismatch"
# of a call whose later rows cannot be diagnosed
REFUSED = "refused"


@dataclass(frozen=True)
class DayRecord:
    """One day of one valve, as it was read and held against the history.

    Parameters
    ----------
    day : date
    stamp, checksum : str
        Of the files it was read from (`DayFiles`).
    since : str
        Label of the history that it was held against (`Epoch`).
    score : Score
    said : str
        What was unusual about how the day came; empty where nothing was.
    """

    day: dt.date
    stamp: str
    checksum: str
    since: str
    score: Score
    said: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self) | {"day": self.day.isoformat()}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> DayRecord:
        """The record that `to_dict` told."""
        score = dict(data["score"])
        score["shares"] = {key: Share(**share) for key, share in score["shares"].items()}
        return cls(**(data | {"day": dt.date.fromisoformat(data["day"]), "score": Score(**score)}))


@dataclass(frozen=True)
class Finding:
    """A valve that calls for attention, and what a diagnosis of the days that tell has named.

    Parameters
    ----------
    valve : str
    since : str
        Label of the history that was found to have changed (`Epoch`).
    called : str
        Day on which it was diagnosed: by the two days before it the evidence had reached its limit.
    onset : str
        Likeliest first day of the change.
    shape : {"step", "ramp"}
    evidence, limit : float
    key : str
        Series with most of the evidence.
    verdict, headline : str
        Of the diagnosis; ``refused`` where a call could not be diagnosed again, and why.
    names : tuple of str
        Classes that it names, members of one joined by ``/``.
    report : str
        Path of the full report within the state; empty where no diagnosis could be made.
    """

    valve: str
    since: str
    called: str
    onset: str
    shape: str
    evidence: float
    limit: float
    key: str
    verdict: str
    headline: str
    names: tuple[str, ...] = ()
    report: str = ""

    @property
    def members(self) -> frozenset[str]:
        """All names of its classes."""
        return frozenset(name for each in self.names for name in each.split("/"))

    def shared_with(self, other: Finding) -> frozenset[str]:
        """Names that another diagnosis gives as well; none unless these are of each of its classes."""
        shared = self.members & other.members
        return shared if all(shared & set(each.split("/")) for each in self.names) else frozenset()


@dataclass(frozen=True)
class Inspection:
    """Somebody has looked at a valve, or mended it: from this day on its history begins anew.

    Parameters
    ----------
    valve : str
    day : str
    note : str
        What was found or done.
    """

    valve: str
    day: str
    note: str = ""


@dataclass(frozen=True)
class Epoch:
    """Time between two inspections of a valve, with one history.

    Parameters
    ----------
    begins : date or None
        None before the first inspection.
    """

    begins: dt.date | None = None

    @property
    def label(self) -> str:
        """How files of it are named."""
        return "first" if self.begins is None else self.begins.isoformat()
