# SPDX-License-Identifier: BSD-3-Clause
"""What a hypothesis leaves over, slowly, beside what the same simulation left over of the healthy valve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.simulation.calibration import drop_is_unknown
from sklvalve.simulation.slow_residual import moves_little, slow_means

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem

# a healthy simulation is wrong by about this share of what counts as an effect
_WRONG = 0.1
_FEWEST = 8


@dataclass(frozen=True)
class Since:
    """How much more is left over than there was in the history.

    Parameters
    ----------
    channel : str
        The one in which it is most.
    times : float
        Rms of what is slowly left over, in multiples of that of the history [1].
    size : float
        Rms of it where it acts, share of span [1].
    """

    channel: str
    times: float
    size: float


def left_since(problem: Problem, model: Model) -> Since | None:
    r"""How many times what the history left over a hypothesis leaves over.

    .. math:: \frac{r}{\sqrt{h^2 + (0.1 c)^2}}

    with r and h the rms of the residual's means over stretches in which the signal moves little, now and in
    the median window of the history, and c what counts in the channel.

    Parameters
    ----------
    problem : Problem
        With a history.
    model : Model
        Whose calibration is one that the history lets expect.

    Returns
    -------
    since : Since or None
        Of the channel in which it is most; None without a history, where too little rests, or where nothing
        tells the pressure drop that a flow comes of.
    """
    found = [_in_channel(problem, model, c) for c in problem.channels if problem.history is not None]
    return max((each for each in found if each is not None), key=lambda each: each.times, default=None)


def _in_channel(problem: Problem, model: Model, channel: str) -> Since | None:
    if problem.history is None or (channel == "flow" and drop_is_unknown(problem.recording)):
        return None
    span, before = problem.spans[channel], problem.history.slowly_left(channel)
    means = slow_means(problem.residuals(model)[channel], moves_little(model.predictions[channel], span))
    means = means[np.isfinite(means)]
    if len(means) < _FEWEST or not np.isfinite(before):
        return None
    usual = float(np.hypot(before, _WRONG * problem.least(channel) * span))
    size = np.abs(means)
    acting = size > 0.25 * np.quantile(size, 0.99)
    return Since(
        channel,
        float(np.sqrt(np.mean(means**2))) / usual,
        float(np.sqrt(np.mean(means[acting] ** 2))) / span if acting.any() else 0.0,
    )
