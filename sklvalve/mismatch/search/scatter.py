# SPDX-License-Identifier: BSD-3-Clause
"""How far what one explanation gains on another is borne out over time, event by event."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.mismatch.search.onset import row_losses

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

# what a simulation gets wrong of most effects, share of their size
SHARE_MISTAKEN = 0.15
# stretches are longer than whatever a valve remembers, and so many that a few make a scatter
_STRETCH = 60.0
_FEWEST, _MOST = 16, 96


def gain_in_spreads(problem: Problem, better: Model, other: Model) -> float:
    """Log likelihood that one fit gains on another, in standard deviations of its scatter over time.

    The scatter is the recording's own, stretch by stretch (Vuong, Econometrica 57, 1989): what one event
    gained counts as one event.

    Parameters
    ----------
    problem : Problem
    better, other : Model

    Returns
    -------
    spreads : float
    """
    losses = [row_losses(problem, m, problem.channels) for m in (better, other)]
    gained = losses[1] - losses[0]
    clock = problem.plain.clock
    # the time between recordings that were joined holds nothing
    length = min(clock[-1] - clock[0], len(clock) * problem.recording.sample_time)
    many = int(np.clip(length / _STRETCH, _FEWEST, _MOST))
    each = np.array([part.sum() for part in np.array_split(gained, many)])
    scatter = np.sqrt(many) * each.std(ddof=1)
    return float(each.sum() / scatter) if scatter > 0.0 else 0.0
