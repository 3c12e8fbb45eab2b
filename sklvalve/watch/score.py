# SPDX-License-Identifier: BSD-3-Clause
r"""One day held against the valve's history: how large each effect would be, to first order.

The simulation stands where the history has it, with the noise of the history. Its calibration may answer
within what the history lets expect. Beside it each effect of the catalogue is added at the size at which its
fits begin, :math:`c` the change that it makes of the whitened residuals :math:`e`; the share of it that the
day bears out, with its standard deviation, is

.. math:: s = -\frac{c^T M e}{c^T M c}, \qquad \sigma_s = (c^T M c)^{-1/2},

:math:`M` taking out what the calibration can answer. A diagnosis fits sizes and names; this only asks every
day the same questions, for a hundredth of its time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.history import ValveHistory
from sklvalve.mismatch.data.gate import blocking
from sklvalve.mismatch.data.masking import masked
from sklvalve.mismatch.data.preparation import candidates, prepared_problem
from sklvalve.mismatch.decide.stretches import stretches_of
from sklvalve.mismatch.inference.hypothesis import Model, Term
from sklvalve.mismatch.inference.linearised import Linearised
from sklvalve.mismatch.search.screening import Trial
from sklvalve.recording import Recording
from sklvalve.recording.screening import screen_recording
from sklvalve.watch.units import other_unit

if TYPE_CHECKING:
    from sklvalve.mismatch.effects.base import Effect
    from sklvalve.mismatch.inference.problem import Problem

#: Rows of a day that are looked at, in stretches spread evenly over it.
ROWS = 5_760
# a size whose standard deviation is so many times the relevant size says nothing
_BLIND = 10.0


@dataclass(frozen=True)
class Share:
    """How much of an effect a day bears out.

    Parameters
    ----------
    size : float
        Change that the share makes of its channel, rms where it acts, share of span [1]; negative where the
        day bears out the opposite.
    deviation : float
        Standard deviation of the size by the noise of the day alone.
    """

    size: float
    deviation: float


@dataclass(frozen=True)
class Score:
    """What one day says.

    Parameters
    ----------
    rows : int
        Rows that were recorded.
    sample_time : float
        [s]
    shares : dict of str to Share
        Key of an effect -> how much of it the day bears out.
    left : dict of str to float
        Channel -> rms of what the calibrated simulation leaves over, share of span [1].
    mend : str
        Why nothing can be told before the data are mended; empty where it can.
    """

    rows: int
    sample_time: float
    shares: dict[str, Share] = field(default_factory=dict)
    left: dict[str, float] = field(default_factory=dict)
    mend: str = ""


def scored(recording: Recording, history: ValveHistory, effects: Sequence[str] | str = "all") -> Score:
    """Hold one day against the valve's history.

    Parameters
    ----------
    recording : Recording
        Rows of the day.
    history : ValveHistory
    effects : "all" or sequence of str, default="all"
        Names of effects to be asked for.

    Returns
    -------
    score : Score
    """
    stretches = stretches_of(recording, ROWS)
    data = screen_recording(stretches)
    problem = prepared_problem(stretches, tolerance=history.tolerance, history=history)
    model = problem.simulate((), history.values_)
    # the history knows the flow better than the sheet, by which the screening suspects a unit
    mend = _unit_of_flow(problem, model) or blocking(data)
    if mend:
        return Score(len(recording), float(recording.sample_time), mend=mend)
    _, kept = masked(stretches, stretches, data)
    if kept is not stretches:
        problem = prepared_problem(kept, tolerance=history.tolerance, history=history)
        model = problem.simulate((), history.values_)
    able, _ = candidates(problem, effects, data)
    problem = problem.with_noise_of(model, cautious=True)
    shares, left = _asked(problem, problem.judged(model), able)
    return Score(len(recording), float(recording.sample_time), shares, left)


def _unit_of_flow(problem: Problem, model: Model) -> str:
    return other_unit(problem.recording, model.predictions["flow"]) if "flow" in problem.channels else ""


def _asked(
    problem: Problem, model: Model, effects: Sequence[Effect]
) -> tuple[dict[str, Share], dict[str, float]]:
    """Shares of all effects, and what is left of each channel once the calibration has answered."""
    touched = {e.key: problem.channels_touched(e) for e in effects}
    lines = {t: Linearised(problem, model, t) for t in dict.fromkeys(touched.values()) if t}
    shares = {}
    for effect in effects:
        line = lines.get(touched[effect.key])
        if line is not None:
            share = _share(Trial(problem, model, line, Term(effect)), problem, model)
            if share is not None:
                shares[effect.key] = share
    left: dict[str, float] = {}
    for line in lines.values():
        _, steps = line.answered(line.errors)
        answered = line.predictions(model.predictions, steps)
        for c in line.channels:
            gap = problem.recording[c] - answered[c]
            left.setdefault(c, float(np.sqrt(np.nanmean(gap**2)) / problem.spans[c]))
    return shares, left


def _share(trial: Trial, problem: Problem, model: Model) -> Share | None:
    """Share of an effect at the start that tells most; None where it would change nothing that is seen."""
    best: Share | None = None
    for predictions, errors in trial.simulated(trial.starts()):
        share, deviation = trial.line.share_of(errors)
        beside = Model(model.terms, model.chain, {}, model.predictions | predictions, np.nan, {})
        size = max(problem.change(beside, model).values())
        if not np.isfinite(deviation) or deviation * size > _BLIND * problem.tolerance.flow_effect:
            continue
        if best is None or deviation * size < best.deviation:
            best = Share(share * size, deviation * size)
    return best
