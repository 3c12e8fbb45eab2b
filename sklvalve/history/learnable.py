# SPDX-License-Identifier: BSD-3-Clause
"""What must hold of recordings before a valve is learnt from them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from sklvalve.history.allowance import Allowance
from sklvalve.history.sources import Source, shared, sources_of
from sklvalve.recording import InputError, Recording, join_recordings, require_diagnosable
from sklvalve.recording.diagnosable import FEWEST_ROWS, is_loop
from sklvalve.recording.errors import shown
from sklvalve.recording.measured import as_measured
from sklvalve.simulation.simulation import as_recording
from sklvalve.simulation.tolerance import Tolerance

#: Rows from which a valve can be learnt; fewer say less than its data sheet.
FEWEST_TO_LEARN = 600
_GIVE = "give a Recording of the valve, or a list of them"


def recordings_of(X: Any, valve: Any = None) -> list[Recording]:
    """List of the recordings that a history is given.

    Parameters
    ----------
    X : Recording, DataFrame with role names as columns, in SI, or iterable of these
    valve : Valve, default=None
        Sheet of frames.

    Returns
    -------
    recordings : list of Recording

    Raises
    ------
    InputError
        If there is none, or something is no recording.
    """
    alone = isinstance(X, Recording | str | bytes) or hasattr(X, "keys")
    if not alone and not isinstance(X, Iterable):
        raise InputError(f"a history is learnt from recordings, and got {shown(X)}; {_GIVE}")
    several = [_recording_of(each, valve) for each in ([X] if alone else X)]
    if not several:
        raise InputError(f"a history is learnt from recordings, and the list is empty; {_GIVE}")
    return several


def require_learnable(recordings: Sequence[Recording]) -> None:
    """Refuse recordings from which nothing, or something wrong, would be learnt of their valve.

    Parameters
    ----------
    recordings : sequence of Recording

    Raises
    ------
    InputError
        If they do not belong together, are of a loop without pressures, hold too few rows, or signals that
        stand still or are all gaps.
    """
    for each in recordings:
        require_no_loop(each)
    joined = join_recordings(recordings)
    if len(joined) < FEWEST_TO_LEARN:
        raise InputError(
            f"{joined.source}: a history of {len(joined)} rows is too short to learn a valve from; give "
            f"recordings of at least {FEWEST_TO_LEARN} rows in all"
        )
    try:
        require_diagnosable(joined)
    except InputError as error:
        raise InputError(f"no history can be learnt from this: {error}") from None


def measured_of(recordings: Iterable[Recording], fewest: int = FEWEST_TO_LEARN) -> list[Recording]:
    """Recordings as their sensors measured them, without those that say nothing of the valve.

    Parameters
    ----------
    recordings : iterable of Recording
    fewest : int, default=600
        Rows that must be left.

    Returns
    -------
    measured : list of Recording
        Each as `as_measured` leaves it.

    Raises
    ------
    InputError
        If they say too little.
    """
    recordings = list(recordings)
    measured = [each for each in map(as_measured, recordings) if each is not None]
    rows = sum(len(each) for each in measured)
    if rows < fewest:
        raise InputError(
            f"{', '.join(each.source for each in recordings)}: where opening and flow do not hold one value "
            f"from the first row to the last, there are {rows} rows, too few to learn a valve from; give "
            f"recordings of at least {fewest} rows in which both move"
        )
    return measured


def is_learnable(recording: Recording) -> bool:
    """Whether a valve can be learnt from one recording.

    Parameters
    ----------
    recording : Recording
    """
    try:
        require_learnable([recording])
        measured_of([recording])
    except InputError:
        return False
    return True


def require_no_loop(recording: Recording) -> None:
    """Refuse a recording of a loop that is known by command and value only.

    Parameters
    ----------
    recording : Recording

    Raises
    ------
    InputError
        If it is one.
    """
    if is_loop(recording):
        raise InputError(
            f"{recording.source}: a history is of use to a simulation of the valve only, and this recording "
            "holds a command and a value without pressures or opening; record these, or diagnose it without "
            "a history"
        )


def require_further(recordings: Sequence[Recording], known: Sequence[Source]) -> list[Source]:
    """Refuse recordings that are too short to add anything, or are in a history already.

    Parameters
    ----------
    recordings : sequence of Recording
    known : sequence of Source
        Those of the history.

    Returns
    -------
    sources : list of Source
        Of the recordings.

    Raises
    ------
    InputError
        Naming the recording.
    """
    found: list[Source] = []
    for each in recordings:
        if len(each) < FEWEST_ROWS:
            raise InputError(
                f"{each.source}: {len(each)} rows are too few to add to a history; give recordings of at "
                f"least {FEWEST_ROWS} rows each"
            )
        sources = list(sources_of(each))
        again = shared([*known, *found], sources)
        if again is not None:
            raise InputError(
                f"{again.name}: the history holds these rows already; give each recording once, or leave out "
                "the rows that are double"
            )
        found += sources
    return found


def require_sound_settings(tolerance: Any, allowance: Any) -> None:
    """Refuse a tolerance or an allowance with which nothing can be learnt.

    Parameters
    ----------
    tolerance : Tolerance or None
    allowance : Allowance or None

    Raises
    ------
    InputError
        If one is of another type, or holds what is no number above 0.
    """
    for name, given, kind in (("tolerance", tolerance, Tolerance), ("allowance", allowance, Allowance)):
        if given is None:
            continue
        if not isinstance(given, kind):
            raise InputError(
                f"the {name} of a history must be of type {kind.__name__}, got {shown(given)}; write "
                f"{kind.__name__}(...) with the numbers that differ"
            )
        for key, value in asdict(given).items():
            if not isinstance(value, int | float | np.number) or not 0.0 < value < np.inf:
                raise InputError(
                    f"{key} of the {name} must be a number above 0, got {shown(value)}; correct it, or leave "
                    "it out"
                )


def require_sound_start(start: Any) -> None:
    """Refuse values to begin with that are no numbers.

    Parameters
    ----------
    start : dict or None
        Parameter name -> value.

    Raises
    ------
    InputError
    """
    if start is None:
        return
    if not isinstance(start, dict):
        raise InputError(
            f"the start of a history must be a dict of parameter names and values, got {shown(start)}; give "
            "values_ of a history or of a simulation, or leave it out"
        )
    for name, value in start.items():
        if not isinstance(value, int | float | np.number) or not -np.inf < value < np.inf:
            raise InputError(
                f"{name} of the start of a history must be a finite number, got {shown(value)}; correct it, "
                "or leave the start out"
            )


def _recording_of(each: Any, valve: Any) -> Recording:
    if not isinstance(each, Recording) and not hasattr(each, "keys"):
        more = ": read the file with read_recording first" if isinstance(each, str | bytes) else ""
        raise InputError(f"a history is learnt from recordings, and got {shown(each)}{more}; {_GIVE}")
    return as_recording(each, valve=valve)
