# SPDX-License-Identifier: BSD-3-Clause
"""What happens in the last rows of a recording: the search is done on those before, the event on its own.

An effect that acts in one row of fifty is an outlier to a robust fit, and to a noise model a wander. The rows
before it tell how the valve works and how its signals scatter. Held against that the last rows are judged by
themselves: whether the stem seized, the passage was blocked, the meter failed, or what else began then.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.judgement import Judgement, with_learnt
from sklvalve.mismatch.decide.stretches import with_every_row
from sklvalve.mismatch.effects import CATALOGUE, LATE
from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.inference.hypothesis import Model, Term, is_in, penalised_likelihood
from sklvalve.mismatch.residual.change import find_change, stands_out
from sklvalve.mismatch.search.relevance import may_be_instead
from sklvalve.mismatch.search.rivals import Finding, weighed
from sklvalve.mismatch.search.screening import screened
from sklvalve.recording import Recording
from sklvalve.simulation.noise import NoiseModel
from sklvalve.simulation.parallel_map import parallel_map

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.residual.change import Change

# from this share of a recording on a change is taken for an event of its end: what begins before is found by
# the search itself, whose onsets end at 0.96
_LATE = 0.94
# so many times what an effect must be, a change ends what a valve did
_ENDS = 4.0
# of a fit of what explains the last rows
_STEPS = 8
# an event has settled where its signal is this near to what it ends at, share of its size
_SETTLED = 0.15
# and behind so many of the meter's lags
_LAGS = 4.0
# an event is named where so much of what the last rows leave over (rms) is gone with it
_EXPLAINS = 0.5


def late_event(problem: Problem, model: Model, alpha: float) -> Change | None:
    """A change in the last rows of a recording; None where nothing clear changes there.

    Parameters
    ----------
    problem : Problem
    model : Model
        Calibrated to all rows, or to those before.
    alpha : float
        Level of a diagnosis.

    Returns
    -------
    event : Change or None
    """
    if len(problem.recording.spans) > 1:
        return None
    change = find_change(problem, model)
    if change is None or change.row < _LATE * len(problem.recording):
        return None
    return change if stands_out(problem, change, alpha, _ENDS) else None


def before(recording: Recording, event: Change) -> Recording:
    """The same recording with opening and flow blank from an event on."""
    late = np.arange(len(recording)) >= event.within[0]
    signals = {
        role: np.where(late, np.nan, values) if role in ("opening", "flow") else values
        for role, values in recording.signals.items()
    }
    return replace(recording, signals=signals)


def with_late_event(
    problem: Problem,
    judged: Judgement,
    event: Change,
    effects: Sequence[Effect],
    alpha: float,
) -> Judgement | None:
    """A judgement on the rows before an event, with the event.

    Parameters
    ----------
    problem : Problem
        Of the whole recording, with the same trim.
    judged : Judgement
        Of the rows before.
    event : Change
        As the calibrated simulation tells it.
    effects : sequence of Effect
        Candidates of the search.
    alpha : float
        Level of the diagnosis.

    Returns
    -------
    judged : Judgement or None
        Of the whole recording; named where the event is, else cannot_tell where nothing was found before.
        None where what was found before makes up for the event.
    """
    searched = judged.problem
    noise = {c: _throughout(searched.noise[c], event.within[0]) for c in problem.channels}
    problem = problem.with_noise(noise).with_sound_values(searched.sound_values)
    nominal = problem.simulate((), judged.nominal.values)
    model = problem.simulate(judged.model.terms, judged.model.values)
    # of a simulation with all that was found before an event has its date and its size
    sized = late_event(problem, model, alpha)
    if sized is None:
        return None
    event = sized
    settled = _settled(problem, model, event)
    others = [with_every_row(problem, f) for f in judged.findings]
    assert judged.p_value is not None
    p_value = min(judged.p_value, event.p_value)
    apart = {c: _without(noise[c], event.within[0], settled) for c in problem.channels}
    finding = _named(problem.with_noise(apart), model, event, settled, _may_be_new(judged, effects))
    judged = replace(
        judged,
        problem=problem,
        p_value=p_value,
        nominal=nominal,
        change=event,
        event=event,
        findings=others,
    )
    if finding is None:
        verdict = "cannot_tell" if judged.verdict == "no_mismatch" else judged.verdict
        judged = replace(judged, verdict=verdict, model=model if others else nominal)
    else:
        model = problem.least_squares(finding.rivals[0].model)
        asked = rules.without(judged.rules, rules.OF_A_FIT)
        judged = replace(judged, verdict="named", model=model, findings=[finding, *others], rules=asked)
    return with_learnt(judged)


def _may_be_new(judged: Judgement, effects: Sequence[Effect]) -> Sequence[Effect]:
    """Effects that may have begun with an event, beside those that end what a valve does.

    There are none where the rows before differ by what has no name: that may come and go, and be the event.
    """
    return effects if judged.verdict in ("no_mismatch", "named") else ()


def _throughout(noise: NoiseModel, row: int) -> NoiseModel:
    """Noise of the rows before an event for those behind it as well, which were gaps to it."""
    known = noise.white[:row]
    usual = float(np.median(known[np.isfinite(known)]))
    white = np.where((np.arange(len(noise.white)) >= row) & ~np.isfinite(noise.white), usual, noise.white)
    return _of(noise, white)


def _without(noise: NoiseModel, low: int, high: int) -> NoiseModel:
    """The same noise with some rows as gaps."""
    rows = np.arange(len(noise.white))
    return _of(noise, np.where((rows >= low) & (rows < high), np.inf, noise.white))


def _of(noise: NoiseModel, white: np.ndarray) -> NoiseModel:
    slow = noise.slow_time, noise.slow_size, noise.sensor
    return NoiseModel(white, noise.step, noise.fast_time, noise.fast_size, *slow)


def _settled(problem: Problem, model: Model, event: Change) -> int:
    """First row in which an event has come about: how it does so no effect knows, and nothing hangs on it."""
    left = problem.residuals(model)[event.channel][event.row :]
    end = np.nanmedian(left[len(left) // 2 :])
    near = np.flatnonzero(np.abs(left - end) <= _SETTLED * abs(event.size))
    # what comes about behind the meter's lag shows behind it, and a lag may stand for a slow stem
    lag = _LAGS * model.values.get("meter_lag", 0.0) / problem.recording.sample_time
    most = len(left) // 3
    first = int(near[0]) if len(near) else most
    return event.row + min(max(first, int(np.ceil(lag))), most)


def _named(
    problem: Problem, model: Model, event: Change, settled: int, effects: Sequence[Effect]
) -> Finding | None:
    """The finding of what explains the last rows; None where nothing that was tried does."""
    onset = float(model.chain.clock[event.row])
    ends, usable = _may_have_begun(problem, model, event, effects)
    base = problem.judged(model)
    # no race: few rows speak, and many effects explain them as well
    rough = screened(problem, base, usable, onset=onset, always=usable)
    end_keys = {e.key for e in ends}
    fits = parallel_map(lambda m: problem.fit(m.terms, start=m, max_steps=_STEPS), rough)
    without = problem.fit(model.terms, start=model, max_steps=_STEPS)
    places = [
        (m.terms[-1], m)
        for m in fits
        if m.terms[-1].effect.key in end_keys or may_be_instead(problem, m, without)
    ]
    if not places:
        return None
    places = _no_coincidence(problem, places, end_keys, event.channel, settled)
    # the noise is that of the rows before: learnt anew it would hang on how the event came about
    gains = [m.log_likelihood - without.log_likelihood for _, m in places]
    rivals = weighed(problem, places, without, gains)
    best = rivals[0].model
    finding = Finding(
        rivals[0].term, rivals, best.log_likelihood - without.log_likelihood, problem.change(best, base)
    )
    left = [_left(problem, m, event.channel, settled) for m in (best, base)]
    counts = penalised_likelihood(problem, best) > penalised_likelihood(problem, without)
    return finding if counts and left[0] <= _EXPLAINS * left[1] else None


def _may_have_begun(
    problem: Problem, model: Model, event: Change, effects: Sequence[Effect]
) -> tuple[list[Effect], list[Effect]]:
    """Effects that end what a valve does, and all that may explain the last rows."""
    stuck: list[Effect] = [e for e in CATALOGUE if e.standstill and e.possible(model.chain)]
    ends: list[Effect] = [e for e in (*stuck, *LATE) if event.channel in problem.channels_touched(e)]
    began = [e for e in effects if e.may_begin and not e.grows and e.key not in {s.key for s in ends}]
    began = [e for e in began if event.channel in problem.channels_touched(e)]
    return ends, [e for e in (*ends, *began) if not is_in(e, model.terms)]


def _no_coincidence(
    problem: Problem, places: list[tuple[Term, Model]], end_keys: set[str], channel: str, first: int
) -> list[tuple[Term, Model]]:
    """Places where a flow ends at zero: what ends it explains that, any other size meets it by chance.

    By a chance of twice what counts: no more than one in a hundred, so that such explanations are left out.
    """
    ends_at = np.nanmedian(problem.recording[channel][first:])
    if channel != "flow" or abs(ends_at) > problem.least(channel) * problem.spans[channel]:
        return places
    return [place for place in places if place[0].effect.key in end_keys] or places


def _left(problem: Problem, model: Model, channel: str, first: int) -> float:
    """Rms of what a hypothesis leaves over from a row on [SI]."""
    residual = problem.residuals(model)[channel][first:]
    return float(np.sqrt(np.nanmean(residual**2)))
