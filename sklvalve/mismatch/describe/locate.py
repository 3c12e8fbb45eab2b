# SPDX-License-Identifier: BSD-3-Clause
"""Where in the operating range, and when, what was found acts."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.describe.bands import simultaneous_bands
from sklvalve.mismatch.describe.boxes import boxes_of, covered, rows_in
from sklvalve.mismatch.describe.cells import cells_of
from sklvalve.mismatch.describe.episodes import Evidence, TimeProfile, growing_time_profile, time_profile_of
from sklvalve.mismatch.inference.hypothesis import Model, Term
from sklvalve.simulation.fitting import left_of
from sklvalve.simulation.simulation import learnt_rest

if TYPE_CHECKING:
    from sklvalve.mismatch.describe.bands import Band
    from sklvalve.mismatch.describe.boxes import Box
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.residual.unknown import Unknown

# boxes that hold nearly every row say nothing of where
_EVERYWHERE = 0.95
# the flow follows from opening and pressures: only where these say clearly less is it told
_DERIVED = 0.8
# of the most that it does: where it does less it is not said to act
_ACTS = 0.25
_CANDIDATES = 61


@dataclass(frozen=True, eq=False)
class Cause:
    """One thing found, as a change of the simulation.

    Attributes
    ----------
    term : Term or None
        None for what no effect explains.
    before, after, settled : dict
        Channel -> residual without it, with it throughout, and of all that was found as it was fitted; of the
        channels that it changes.
    simulated : dict
        Channel -> the simulation without it.
    """

    term: Term | None
    before: dict[str, np.ndarray]
    after: dict[str, np.ndarray]
    settled: dict[str, np.ndarray]
    simulated: dict[str, np.ndarray]


def acting_rows(problem: Problem, model: Model, without: Model) -> np.ndarray:
    """Rows in which a model differs from the one without its effect by a good part of the most it does."""
    flagged = np.zeros(len(problem.recording), dtype=bool)
    for channel in problem.channels:
        gap = np.abs(np.nan_to_num(model.predictions[channel] - without.predictions[channel]))
        for rows, size in problem.by_recording(channel, model, without):
            if problem.counts({channel: size}):
                flagged[rows] |= _acting(gap[rows])
    return flagged


def _acting(gap: np.ndarray) -> np.ndarray:
    """Rows in which a change is a good part of the most it is."""
    return gap > max(_ACTS * np.quantile(gap, 0.99), 1e-12)


def causes_of(problem: Problem, model: Model, unknown: Unknown | None = None) -> list[Cause]:
    """What was found, thing by thing, each switched off and on in the same simulation.

    Parameters
    ----------
    problem : Problem
    model : Model
        With all effects found.
    unknown : Unknown, default=None
        What no effect explains.

    Returns
    -------
    causes : list of Cause
        Without those that the simulation does not hold.
    """
    left, causes = problem.residuals(model), []
    if unknown is not None:
        c = unknown.channel
        left = left | {c: left[c] - learnt_rest(unknown.correction, model.chain, model.values)}
        residual = {c: problem.residuals(model)[c]}
        causes.append(Cause(None, residual, {c: left[c]}, {c: left[c]}, {c: model.predictions[c]}))
    for term in model.terms:
        others = tuple(m for m in model.terms if m is not term)
        without = problem.simulate(others, model.values)
        acting = problem.simulate((*others, Term(term.effect)), model.values)
        before, after, settled, simulated = {}, {}, {}, {}
        for c in problem.channels_touched(term.effect):
            gap = acting.predictions[c] - without.predictions[c]
            if np.nanmax(np.abs(gap), initial=0.0) <= 1e-12 * problem.spans[c]:
                continue
            settled[c] = left[c]
            before[c] = left[c] + model.predictions[c] - without.predictions[c]
            after[c] = before[c] - gap
            simulated[c] = without.predictions[c]
        if before:
            causes.append(Cause(term, before, after, settled, simulated))
    return causes


def time_profile_of_cause(problem: Problem, model: Model, cause: Cause) -> TimeProfile:
    """When one of the things found acts: a `TimeProfile`."""
    clock = model.chain.clock
    if cause.term is None:
        # learnt from all rows alike: nothing tells when it began
        return TimeProfile("throughout", [(0, len(clock))], [(None, None)])
    acts = model.chain.active(cause.term.effect)
    acts = np.ones(len(clock), dtype=bool) if acts is None else acts
    noise = {c: problem.noise[c] for c in cause.before}
    slopes = _slopes_of_calibration(problem, model, cause.term.effect.key, list(cause.before))
    evidence = Evidence(noise, cause.before, cause.after, cause.settled, slopes)
    if not cause.term.effect.grows:
        # what begins inside an instrument shows behind its response
        response = int(np.ceil(problem.tolerance.response / problem.recording.sample_time))
        return time_profile_of(evidence, acts, late=response)
    return growing_time_profile(evidence, clock, acts, np.linspace(0, 0.97 * len(clock), _CANDIDATES))


def _slopes_of_calibration(
    problem: Problem, model: Model, key: str, channels: list[str]
) -> np.ndarray | None:
    """Derivatives of the whitened residuals of some channels with regard to all but one effect."""
    columns: list[tuple[int, dict[str, np.ndarray], np.ndarray]] = []
    misfits = problem.misfits(model, channels)
    still, priors = np.zeros(len(model.chain.clock)), [0] * len(misfits)
    for i, misfit in enumerate(misfits):
        z, here = misfit.vector.pack(model.values), [c for c in channels if c in misfit.channels]
        base = misfit.predictions(z)
        white = {c: problem.noise[c].whiten(left_of(problem.recording, base, c)) for c in here}
        prior = misfit.vector.prior_residuals(z)
        priors[i] = len(prior)
        moved, reach = misfit.neighbours(z)
        for name, at, r in zip(misfit.vector.names, moved, reach, strict=True):
            if name.startswith(f"{key}."):
                continue
            beside = misfit.predictions(at)
            parts = {
                c: (problem.noise[c].whiten(left_of(problem.recording, beside, c)) - white[c]) / r
                for c in here
            }
            columns.append((i, parts, (misfit.vector.prior_residuals(at) - prior) / r))
    # groups share no parameter: what one moves leaves the others' channels and priors as they are
    stacked = [
        np.concatenate(
            [parts.get(c, still) for c in channels]
            + [pull if i == k else np.zeros(priors[k]) for k in range(len(misfits))]
        )
        for i, parts, pull in columns
    ]
    return np.stack(stacked, axis=1) if stacked else None


def regions_of(
    problem: Problem,
    model: Model,
    causes: list[Cause],
    time_profiles: list[TimeProfile],
    *,
    alpha: float,
    random_state: int = 0,
) -> list[dict[str, Any]]:
    """Boxes of the operating range in which what was found leaves its simultaneous band.

    Parameters
    ----------
    problem : Problem
    model : Model
    causes : list of Cause
    time_profiles : list of TimeProfile
        When each of them acts: other rows say nothing of where.
    alpha : float
        Chance of any box where there is only noise.
    random_state : int, default=0

    Returns
    -------
    regions : list of dict
        ``signal, low, high, direction, share``, and ``and`` with a second range where two signals bound the
        box; empty where what was found acts everywhere, nowhere clearly enough, or in rows that no boxes
        describe better than all rows of the recording do (a lag acts after every stroke).
    """
    parts, places = [], []
    for cause, time_profile in zip(causes, time_profiles, strict=True):
        acts = time_profile.acts(len(problem.recording))
        for c in cause.before:
            cells = cells_of(model.chain, model.values, c, cause.simulated[c])
            residual, before = (np.where(acts, e[c], np.nan) for e in (cause.settled, cause.before))
            parts.append((problem.noise[c], residual, [before], cells))
            gap = np.where(acts, np.abs(np.nan_to_num(cause.before[c] - cause.after[c])), 0.0)
            places.append((c, None if cause.term is None else (_acting(gap), acts)))
    regions: list[dict[str, Any]] = []
    bands = simultaneous_bands(parts, alpha=alpha, random_state=random_state)
    for (channel, rows), (several,) in zip(places, bands, strict=True):
        boxes = boxes_in(several, len(problem.recording), rows)
        shown = problem.recording.get(channel)
        if covered(boxes) > _EVERYWHERE:
            continue
        regions += [box.region(shown if channel == box.cells.signals[0] else None) for box in boxes]
    return [r for i, r in enumerate(regions) if r not in regions[:i]]


def boxes_in(bands: list[Band], n: int, rows: tuple[np.ndarray, np.ndarray] | None = None) -> list[Box]:
    """Boxes of one partition, in bands of all partitions of a residual.

    Parameters
    ----------
    bands : list of Band
    n : int
    rows : pair of ndarray of bool, default=None
        Those in which an effect, as it was fitted, makes a difference, and those of the time in which it acts
        at all: the boxes are those that describe the first best, and none where all rows of that time do so
        as well. Where no effect explains what was found, the partition tells most of it.
    """
    bands = [band for band in bands if np.any(band.beyond > 0.0)]
    if not bands:
        return []

    def trust(band: Band) -> float:
        return _DERIVED if band.cells.signals == ("flow",) else 1.0

    if rows is not None:
        acting, during = rows

        def describes(boxes: list[Box]) -> float:
            inside = rows_in(boxes, n) & during
            return np.sum(inside & acting) / max(np.sum(inside | acting), 1)

        _, best = max(((trust(b) * describes(boxes_of(b)), boxes_of(b)) for b in bands), key=lambda e: e[0])
        return best if describes(best) > np.sum(acting) / max(np.sum(during), 1) else []

    def tells(band: Band) -> float:
        # each mean is a parameter
        return trust(band) * band.gain - 0.5 * band.cells.count * np.log(max(n, 2))

    return boxes_of(max(bands, key=tells))


def location_of(
    problem: Problem,
    model: Model,
    unknown: Unknown | None,
    blocks: list[str],
    *,
    alpha: float,
    random_state: int = 0,
    aside: Collection[str] = (),
) -> dict[str, Any]:
    """The location that diagnosis.json tells of what was found.

    Parameters
    ----------
    problem : Problem
    model : Model
        With all effects found.
    unknown : Unknown or None
    blocks : list of str
    alpha : float
    random_state : int
    aside : collection of str
        Keys of effects of which place and time are not asked.

    Returns
    -------
    location : dict
        ``blocks, regions, onset, intervals``; ``onset_ci95`` [s] where there is an onset; ``course``, what it
        does over time; ``intervals_ci95``, a pair of ranges for each interval, None where an end is that of
        the recording.
    """
    clock = model.chain.clock - model.chain.clock[0]
    causes = [
        c for c in causes_of(problem, model, unknown) if c.term is None or c.term.effect.key not in aside
    ]
    time_profiles = [time_profile_of_cause(problem, model, cause) for cause in causes]
    regions = regions_of(problem, model, causes, time_profiles, alpha=alpha, random_state=random_state)
    location: dict[str, Any] = {"blocks": blocks, "regions": regions}
    if not time_profiles:
        return location | {"onset": None, "intervals": [[0.0, float(clock[-1])]]}
    return location | _times_of(clock, time_profiles)


def _times_of(clock: np.ndarray, time_profiles: list[TimeProfile]) -> dict[str, Any]:
    """The entries of a location that say when what was found acts."""
    episodes = _joined(time_profiles)
    marks = [(float(clock[a]), float(clock[min(b, len(clock) - 1)])) for a, b, _ in episodes]
    first = episodes[0][0]
    times: dict[str, Any] = {"onset": float(clock[first]) if first > 0 else None}
    times["intervals"] = [list(pair) for pair in marks]
    kinds = {time_profile.kind for time_profile in time_profiles}
    times["course"] = kinds.pop() if len(kinds) == 1 else "in several ways"
    bounds = [[_seconds(clock, r) for r in ranges] for _, _, ranges in episodes]
    if bounds[0][0] is not None:
        times["onset_ci95"] = bounds[0][0]
    if any(r is not None for pair in bounds for r in pair):
        times["intervals_ci95"] = bounds
    return times


def _joined(time_profiles: list[TimeProfile]) -> list[tuple]:
    """Spells of all courses, those that overlap as one: (first row, row behind the last, both ranges)."""
    every = [
        (*spell, *ranges)
        for time_profile in time_profiles
        for spell, ranges in zip(time_profile.episodes, time_profile.ranges, strict=True)
    ]
    joined: list = []
    for begin, end, early, late in sorted(every, key=lambda e: e[:2]):
        if joined and begin <= joined[-1][1]:
            before = joined[-1]
            last = (end, late) if end > before[1] else (before[1], before[2][1])
            joined[-1] = (before[0], last[0], (before[2][0], last[1]))
        else:
            joined.append((begin, end, (early, late)))
    return joined


def _seconds(clock: np.ndarray, rows: Sequence[int] | None) -> list[float] | None:
    return None if rows is None else [float(clock[min(int(k), len(clock) - 1)]) for k in rows]
