# SPDX-License-Identifier: BSD-3-Clause
"""The tags of each run on one regular base, all runs with the same period."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError
from sklvalve.recording.historian.align import Aligned, Pace, align, base_of, choose_period, pace_of, silences
from sklvalve.recording.historian.clean import Points
from sklvalve.recording.historian.moments import SECOND
from sklvalve.recording.historian.settings import ImportSettings

_MOST_ROWS = 5_000_000
# periods [s]: times are kept to microseconds, and none of a plant is further from the next than years
_SHORTEST, _LONGEST = 1e-6, 1e9
# rows without any value that are kept in between; a recording may lack rows, but need not in every short gap
_LONGEST_EMPTY = 100


def common_period(runs: Sequence[dict[str, Points]], settings: ImportSettings, source: str) -> int:
    """Period of the base of all runs [us]."""
    paces = [pace for kept in runs for points in kept.values() if (pace := pace_of(points))]
    if not paces:
        raise InputError(
            f"{source}: no tag has values at two different times, so there is no course; export a longer "
            "time range"
        )
    wanted = settings.period or choose_period(paces) / SECOND
    for kept in runs:
        _require_bearable(list(kept.values()), wanted, source)
    return round(SECOND * wanted)


def on_one_base(
    kept: dict[str, Points],
    held: dict[str, tuple[bool, str]],
    period: int,
    settings: ImportSettings,
    source: str,
) -> tuple[NDArray[np.int64], float, dict[str, Aligned]]:
    """Base, the longest usual silence of all tags [us], and all tags on it."""
    paces = {tag: pace for tag, points in kept.items() if (pace := pace_of(points))}
    all_points = list(kept.values())
    base = base_of(all_points, period)
    typical = float(np.median([pace.step for pace in paces.values()])) if paces else float(period)
    quiet, silence = silences(all_points, settings.gap)
    aligned = {
        tag: align(
            points,
            paces.get(tag, Pace(typical, scanned=False)),
            base,
            hold=held[tag][0],
            multiple=settings.gap,
            quiet=quiet,
        )
        for tag, points in kept.items()
    }
    if not any(np.isfinite(each.values).any() for each in aligned.values()):
        raise InputError(
            f"{source}: no row of a base of {period / SECOND:g} s holds a value; give a shorter --period, or "
            "a larger --gap"
        )
    return base, silence, aligned


def rows_to_keep(some: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """All rows but those before and after all values, and those of long stretches without any."""
    kept = some.copy()
    places = np.flatnonzero(some)
    steps = np.diff(places)
    for gap in np.flatnonzero((steps > 1) & (steps <= _LONGEST_EMPTY)):
        kept[places[gap] : places[gap + 1]] = True
    return kept


def _require_bearable(all_points: list[Points], period: float, source: str) -> None:
    """Refuse a period [s] of too many rows, and one that no time can be told to or no count can hold."""
    times = np.concatenate([points.times[[0, -1]] for points in all_points])
    rows = (float(times.max()) - float(times.min())) / SECOND / period + 1.0
    if rows > _MOST_ROWS:
        raise InputError(
            f"{source}: from first to last time there are {rows:.7g} rows of {period:g} s, more than "
            f"{_MOST_ROWS}; give a longer --period, or export a shorter time range"
        )
    if not _SHORTEST <= period <= _LONGEST:
        raise InputError(
            f"{source}: expected a --period from {_SHORTEST:g} to {_LONGEST:g} s; got {period:g} s"
        )
