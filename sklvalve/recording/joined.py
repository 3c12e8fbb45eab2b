# SPDX-License-Identifier: BSD-3-Clause
"""Several recordings of one valve, joined one behind the other into one."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from sklvalve.recording.dead_bands import DeadBand
from sklvalve.recording.errors import InputError
from sklvalve.recording.recording import Piece, Recording
from sklvalve.recording.same_valve import sheet_difference
from sklvalve.recording.timebase import seconds_at

# between recordings of which nobody knows how far apart they are [s], and in rows
_APART, _ROWS_APART = 3600.0, 100
# of the times that two recordings share, the share of equal rows from which on they are the same hours
_DOUBLE = 0.5


def join_recordings(recordings: Iterable[Recording]) -> Recording:
    """Join recordings of one valve, each a piece of the whole with its own file and its own noise.

    Recordings whose times follow each other on one clock keep their distances, and are put in the order of
    time. Times in seconds that overlap, as where every recording begins at 0, tell no distance: such
    recordings stay in the order given, an hour apart.

    Parameters
    ----------
    recordings : iterable of Recording
        Of the same signals and the same data sheet; units and columns may differ.

    Returns
    -------
    joined : Recording
        The only one, as it is, where one is given. Signals are in SI; the units to be shown are the first's.

    Raises
    ------
    InputError
        If there is none, they differ in signals or data sheet, rows are given twice, or dated ones overlap.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.recording import Recording, join_recordings
    >>> one, other = (
    ...     Recording.from_frame({"time": np.arange(3.0), "command": command})
    ...     for command in ([0.1, 0.2, 0.3], [0.6, 0.5, 0.4])
    ... )
    >>> both = join_recordings([one, other])
    >>> both.time.tolist()
    [0.0, 1.0, 2.0, 3602.0, 3603.0, 3604.0]
    >>> [piece.begins for piece in both.pieces]
    [0.0, 3602.0]
    """
    several = list(recordings)
    if not several:
        raise InputError("no recording was given; give at least one")
    if len(several) == 1:
        return several[0]
    for k, other in enumerate(several):
        _require_alike(several[0], other)
        if any(_is_same(r, other) for r in several[:k]):
            raise InputError(f"{other.source} is given twice; give each recording once")
    several, begins, assumed = _laid_out(several)
    first = several[0]
    return replace(
        first,
        time=np.concatenate([begin + r.time - r.time[0] for begin, r in zip(begins, several, strict=True)]),
        stamps=np.concatenate([r.stamps.astype(object) for r in several]),
        signals={role: np.concatenate([r[role] for r in several]) for role in first},
        constants=frozenset.intersection(*(r.constants for r in several)),
        source=", ".join(r.source for r in several),
        sha256=None,
        pieces=tuple(
            Piece(r.source, r.sha256, float(begin), assumed) for begin, r in zip(begins, several, strict=True)
        ),
        bands=_joined_bands(several, begins),
    )


def _joined_bands(several: list[Recording], begins: list[float]) -> dict[str, tuple[DeadBand, ...]]:
    """Dead bands of recordings by role, each on the common clock and within its own recording."""
    bands: dict[str, tuple[DeadBand, ...]] = {}
    for begin, recording in zip(begins, several, strict=True):
        first, last = recording.time[0], recording.time[-1]
        for role, each in recording.bands.items():
            moved = tuple(
                DeadBand(begin + max(b.begins, first) - first, begin + min(b.ends, last) - first, b.size)
                for b in each
            )
            bands[role] = bands.get(role, ()) + moved
    return bands


def _is_same(one: Recording, other: Recording) -> bool:
    return one.sha256 is not None and one.sha256 == other.sha256 and one.stamps[0] == other.stamps[0]


def _require_alike(one: Recording, other: Recording) -> None:
    """Same signals, same kind of flow, same sheet of the valve."""
    for has, lacks in ((one, other), (other, one)):
        missing = [role for role in has if role not in lacks]
        if missing:
            raise InputError(
                f"{lacks.source}: there is no {missing[0]}, which {has.source} holds; recordings that are "
                "joined must hold the same signals: record it, or leave it out of all"
            )
    if one.mass_flow != other.mass_flow:
        raise InputError(
            f"{other.source} holds a flow by {'mass' if other.mass_flow else 'volume'} and {one.source} by "
            f"{'mass' if one.mass_flow else 'volume'}; give both in the same kind of unit"
        )
    differs = sheet_difference(one.valve, other.valve)
    if differs is not None:
        raise InputError(
            f"{other.source}: the data sheet gives {differs.field} as {differs.other!r}, and that of "
            f"{one.source} as {differs.one!r}; recordings that are joined must be of one valve"
        )


def _laid_out(several: list[Recording]) -> tuple[list[Recording], list[float], bool]:
    """Recordings in their order, where on a common clock each begins [s], and whether that is assumed."""
    dated = isinstance(several[0].stamps[0], str)
    mixed = [r for r in several if isinstance(r.stamps[0], str) != dated]
    if mixed:
        raise InputError(
            f"{mixed[0].source}: times are {'seconds' if dated else 'dates'}, and those of "
            f"{several[0].source} are {'dates' if dated else 'seconds'}; give all in one form"
        )
    offsets = [seconds_at(r.stamps[0], several[0].stamps[0], 0.0) for r in several]
    order = np.argsort(offsets, kind="stable")
    sorted_ = [several[i] for i in order]
    begins = [offsets[i] - offsets[order[0]] for i in order]
    ends = [begin + float(r.time[-1] - r.time[0]) for begin, r in zip(begins, sorted_, strict=True)]
    overlap = [k for k in range(1, len(several)) if begins[k] <= ends[k - 1]]
    if not overlap:
        return sorted_, begins, False
    if dated:
        before, after = sorted_[overlap[0] - 1], sorted_[overlap[0]]
        raise InputError(
            f"{after.source} begins at {after.stamps[0]}, before {before.source} ends at "
            f"{before.stamps[-1]}; leave out the rows that are double"
        )
    for k, one in enumerate(several):
        for other in several[k + 1 :]:
            _require_other_rows(one, other)
    placed = [0.0]
    for r in several[:-1]:
        gap = max(_APART, _ROWS_APART * np.nan_to_num(r.sample_time))
        placed.append(placed[-1] + float(r.time[-1] - r.time[0]) + gap)
    return several, placed, True


def _require_other_rows(one: Recording, other: Recording) -> None:
    """Two exports of the same hours must not count twice."""
    _, here, there = np.intersect1d(one.stamps, other.stamps, return_indices=True)
    both = np.ones(len(here), dtype=bool)
    for role in one:
        if role not in one.constants:
            both &= one[role][here] == other[role][there]
    if both.sum() > _DOUBLE * max(len(here), 1):
        raise InputError(
            f"{other.source} and {one.source} hold {both.sum()} rows that are equal, time and values; "
            "leave out the rows that are double"
        )
