# SPDX-License-Identifier: BSD-3-Clause
"""When a recording stopped being what its simulation makes of it: the date of a change that needs no name.

What a simulation leaves over of a signal is regressed on all that a simulation gets wrong of a valve that
stays as it is: its trim, its lags, its lost motion, its pressure, a steady drift. A change is what this
leaves and a step at one time explains: of the level, or of the level and of how far the signal follows its
simulation. All of it is whitened by a noise that is learnt from what is left when the change is taken away,
or a wander would take it up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2

from sklvalve.mismatch.constants import LEAST_P_VALUE
from sklvalve.mismatch.signals.step_search import StepSearch
from sklvalve.recording.gaps import filled
from sklvalve.simulation.calibration import drop_is_unknown
from sklvalve.simulation.noise_of_pieces import noise_of

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.recording import Recording

# rows at either end of a recording, or of one that was joined, of which nothing is said
_FEWEST = 20
# times tried first, and those around the best one that are tried row by row
_PLACES, _NEAR = 240, 1.5
# share of a recording before which no change is looked for: what was there before is not known well enough
_FIRST = 0.08
# cells of the simulated signal within which rows before and after are equal
_CELLS = 25
# independent times among those tried: for the largest of so many statistics its chance is taken
_INDEPENDENT = 60.0
# knots of the curve over the simulated signal, and lags [rows] of what answers late
_KNOTS, _LAGS = 6, (2, 8, 32, 128)
# what a simulation gets wrong gains so many times more than chance: with it 1 of 104 healthy channels of two
# drawn plants (40 recordings with opening and flow, 24 of a slow motor) has a p-value of 0.01 or less
_MODEL = 2.5
# a change counts from so many times what an effect must be
_COUNTS = 2.0
# share of the level of a diagnosis that this look at a recording has, beside what the others have
_OF_ALPHA = 0.1


@dataclass(frozen=True)
class Change:
    """A change of one signal.

    Attributes
    ----------
    channel : str
    row : int
        First row of the changed signal.
    within : (int, int)
        Rows that hold it with 95 %.
    size : float
        What it adds to the signal from then on, at equal simulated values [SI].
    response : float
        Change of the slope of recorded over simulated signal; -1 where it does not follow any more [1].
    p_value : float
        Chance of as clear a change, at any time, where there is none.
    spread : float
        How many times more than by chance steps at other times gain; the p-value allows for it.
    """

    channel: str
    row: int
    within: tuple[int, int]
    size: float
    response: float
    p_value: float
    spread: float = 1.0


def find_change(problem: Problem, model: Model) -> Change | None:
    """The clearest change that a simulation leaves over, of all its channels.

    Parameters
    ----------
    problem : Problem
    model : Model
        Calibrated; what is looked for is what it leaves over.

    Returns
    -------
    change : Change or None
        None where no time could be tried. Whether it counts is the caller's matter.
    """
    return min(find_changes(problem, model), key=lambda each: each.p_value, default=None)


def find_changes(problem: Problem, model: Model) -> list[Change]:
    """The clearest change of each channel that a simulation leaves over, as `find_change` has it.

    Each p-value is that among all the channels.
    """
    # what an unrecorded drop does to a flow is no change of the valve
    unseen = ("flow",) if drop_is_unknown(problem.recording) else ()
    tried = [change_in(problem, model, c) for c in problem.channels if c not in unseen]
    many = len(problem.channels)
    return [replace(each, p_value=min(many * each.p_value, 1.0)) for each in tried if each is not None]


def stands_out(problem: Problem, change: Change, alpha: float, counts: float = _COUNTS) -> bool:
    """Whether a change is rare enough, and large enough to count."""
    least = counts * problem.least(change.channel) * problem.spans[change.channel]
    return change.p_value <= _OF_ALPHA * alpha and abs(change.size) >= least


def change_in(problem: Problem, model: Model, channel: str) -> Change | None:
    """The clearest change of one channel; None where it has too few rows."""
    left = problem.residuals(model)[channel]
    shown, n = model.predictions[channel], len(problem.recording)
    if np.isfinite(left).sum() < 8 * _FEWEST:
        return None
    places = _places(problem.recording.spans, n)
    places = places[_comparable(left, shown, places)]
    if not len(places):
        return None
    search, row, gain, response_too = _searched(problem, model, channel, left, places)
    made, _ = search.split(row, response_too)
    spread = _MODEL * search.inflation(places)
    freedom = 2 if response_too else 1
    p_value = min(_INDEPENDENT * float(chi2.sf(gain / spread, freedom)), 1.0)
    within = search.interval(row, response_too, spread)
    size = size_of(left, shown, row)
    if size is None or (not response_too and size * np.mean(made[row:]) <= 0.0):
        return None
    slope = search.response / max(float(np.nanstd(shown)), 1e-12) if response_too else 0.0
    return Change(channel, row, within, size, slope, max(p_value, LEAST_P_VALUE), spread)


def _searched(
    problem: Problem, model: Model, channel: str, left: np.ndarray, places: np.ndarray
) -> tuple[StepSearch, int, float, bool]:
    """The search by a noise that is learnt without the change, and what it finds (`StepSearch.best`)."""
    shown, steady = model.predictions[channel], _steady_columns(problem, model, channel)
    about = shown - np.nanmean(shown)
    about /= max(float(np.nanstd(about)), 1e-12)
    settings = problem.noise_settings(channel)

    def by_noise_of(residual: np.ndarray, cautious: bool) -> StepSearch:
        step = model.chain.step
        noise = noise_of(problem.recording, residual, shown, step, channel, cautious=cautious, **settings)
        return StepSearch(noise, left, steady, about)

    residual = left
    for cautious in (True, False):
        # of a long recording the columns of one search are in memory
        search = by_noise_of(residual, cautious)
        row, _, response_too = search.best(places)
        residual = search.split(row, response_too)[1]
        del search
    last = by_noise_of(residual, cautious=False)
    return last, *last.best(places)


def size_of(left: np.ndarray, shown: np.ndarray, row: int) -> float | None:
    """Median by which a signal differs after a row from before, at equal simulated values [SI].

    None where most of what comes after has no equal before: that is another place, and no other time.
    """
    if not _comparable(left, shown, np.array([row]))[0]:
        return None
    seen, after, cell = np.isfinite(left), np.arange(len(left)) >= row, _cells(shown)
    differences, weights = [], []
    for k in np.unique(cell[seen & after]):
        old, new = left[seen & ~after & (cell == k)], left[seen & after & (cell == k)]
        if len(old) >= _FEWEST:
            differences.append(np.median(new) - np.median(old))
            weights.append(len(new))
    return float(np.average(differences, weights=weights))


def _comparable(left: np.ndarray, shown: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Whether most of what comes after each row has its equals before, at equal simulated values."""
    seen, cell = np.isfinite(left), _cells(shown)
    before = np.zeros((len(left) + 1, _CELLS), dtype=np.int32)
    np.cumsum((cell[:, None] == np.arange(_CELLS)) & seen[:, None], axis=0, out=before[1:])
    old, new = before[rows], before[-1] - before[rows]
    equal = np.sum(np.where(old >= _FEWEST, new, 0), axis=1)
    return (equal > 0) & (equal >= 0.5 * new.sum(axis=1))


def _cells(shown: np.ndarray) -> np.ndarray:
    """Which of some cells of the simulated signal each row lies in."""
    edges = np.linspace(np.nanmin(shown), np.nanmax(shown) + 1e-12, _CELLS + 1)
    return np.clip(np.searchsorted(edges, shown, side="right") - 1, 0, _CELLS - 1)


def _places(spans: Sequence[tuple[int, int]], n: int) -> np.ndarray:
    """Rows at which a change is tried first; not where one recording was joined to the next."""
    places = [
        np.linspace(
            low + max(_FEWEST, _FIRST * (high - low)), high - _FEWEST, max(int(_PLACES * (high - low) / n), 4)
        )
        for low, high in spans
        if high - low > 4 * _FEWEST
    ]
    # the last rows of a recording tell of a change by their number: they are tried densely
    low, high = spans[-1]
    if high - low > 4 * _FEWEST:
        places.append(np.linspace(high - 0.04 * (high - low), high - _FEWEST, 40))
    rows = np.concatenate(places).astype(int) if places else np.empty(0, dtype=int)
    return np.unique(rows[rows >= _FEWEST])


def _steady_columns(problem: Problem, model: Model, channel: str) -> np.ndarray:
    """What a simulation gets wrong of a valve that stays as it is, as columns over the rows."""
    recording, n = problem.recording, len(problem.recording)
    shown = filled(model.predictions[channel])
    columns = [np.linspace(-1.0, 1.0, n), *_bent(recording, channel, shown), *_late(shown), _last_way(shown)]
    for role in ("p1", "p2", "temperature", "supply_pressure"):
        if role in recording and role not in problem.channels:
            columns.append(filled(recording[role]))
    # each recording has a level of its own; centred, these would lose the one that all have
    levels = [((np.arange(n) >= low) & (np.arange(n) < high)).astype(float) for low, high in recording.spans]
    columns = [*levels, *(c for c in columns if np.any(c))]
    made = np.empty((n, len(columns)))
    for k, column in enumerate(columns):
        made[:, k] = column if k < len(levels) else _standardised(column)
    return made


def _standardised(column: np.ndarray) -> np.ndarray:
    """A column about its mean, in its standard deviations; one of a single value stays as it is."""
    centred = column - (column.mean() if np.ptp(column) > 0.0 else 0.0)
    return centred / max(float(np.std(centred)), 1e-30) if np.std(centred) > 0.0 else centred


def _bent(recording: Recording, channel: str, shown: np.ndarray) -> list[np.ndarray]:
    """Curves over the signals that a simulation of a channel follows."""
    columns = []
    for driver in _drivers(recording, channel, shown):
        columns.append(driver)
        knots = np.quantile(driver, np.linspace(0.0, 1.0, _KNOTS + 2)[1:-1])
        columns += [np.maximum(driver - k, 0.0) for k in np.unique(knots)]
    return columns


def _late(shown: np.ndarray) -> list[np.ndarray]:
    """What answers late leaves over, for lags of some lengths."""
    n = len(shown)
    delayed = [np.concatenate([np.full(min(lag, n), shown[0]), shown[: max(n - lag, 0)]]) for lag in _LAGS]
    return [shown - each for each in delayed]


def _drivers(recording: Recording, channel: str, shown: np.ndarray) -> list[np.ndarray]:
    """Signals over which a simulation of a channel may be bent."""
    role = "opening" if channel == "flow" and "opening" in recording else "command"
    return [shown, *([filled(recording[role])] if role in recording else [])]


def _last_way(shown: np.ndarray) -> np.ndarray:
    """Which way a signal went last, beyond a hundredth of its range: lost motion leaves that over."""
    least, held, way = 0.01 * np.ptp(shown), shown[0], 0.0
    ways = np.zeros(len(shown))
    for k, value in enumerate(shown):
        if abs(value - held) > least:
            way, held = float(np.sign(value - held)), value
        ways[k] = way
    return ways
