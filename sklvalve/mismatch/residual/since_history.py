# SPDX-License-Identifier: BSD-3-Clause
"""What a hypothesis leaves over, slowly, beside what the same simulation left over of the healthy valve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.residual.goodness_of_fit import FEWEST, LeftOver, effective_number
from sklvalve.mismatch.search.relevance import WRONG
from sklvalve.simulation.calibration import drop_is_unknown
from sklvalve.simulation.slow_residual import moves_little, slow_means

if TYPE_CHECKING:
    from sklvalve.history import ValveHistory
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem

# what drives a channel: where the history has not been, it says nothing of what a simulation leaves over
_DRIVERS = {"opening": ("command",), "flow": ("opening", "drop")}


def left_since(problem: Problem, model: Model) -> LeftOver | None:
    r"""What a hypothesis leaves over in the channel in which it is most, in multiples of the history's.

    .. math:: \frac{r}{\sqrt{h^2 + (0.1 c)^2}}

    with r and h the rms of the residual's means over stretches in which the signal moves little, now and in
    the median window of the history, and c what counts in the channel. Now only rows count that are where
    the history has been.

    Parameters
    ----------
    problem : Problem
        With a history.
    model : Model
        Whose calibration is one that the history lets expect.

    Returns
    -------
    left : LeftOver or None
        None without a history, where too little rests, or where nothing tells the pressure drop that a flow
        comes of.
    """
    if problem.history is None:
        return None
    by_channel = [_in_channel(problem, problem.history, model, c) for c in problem.channels]
    return max((each for each in by_channel if each is not None), key=lambda left: left.times, default=None)


def _in_channel(problem: Problem, history: ValveHistory, model: Model, channel: str) -> LeftOver | None:
    if channel == "flow" and drop_is_unknown(problem.recording):
        return None
    span = problem.spans[channel]
    before = history.slowly_left(channel) / span
    known = history.range_.met(problem.recording, _DRIVERS[channel])
    keep = known & moves_little(model.predictions[channel], span)
    means = slow_means(problem.residuals(model)[channel], keep)
    if np.isfinite(means).sum() < FEWEST or not np.isfinite(before):
        return None
    usual = float(np.hypot(before, WRONG * problem.least(channel)))
    size = float(np.sqrt(np.nanmean((means / span) ** 2)))
    return LeftOver(channel, size, before, usual, effective_number(means))
