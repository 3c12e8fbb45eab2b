# SPDX-License-Identifier: BSD-3-Clause
"""What a hypothesis leaves over beyond the noise that its history has: slowly, in pulses, or to and fro.

An effect is never simulated just as it is: a share of what it explains may be left over as well.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from sklvalve.mismatch.constants import SHARE_WRONG
from sklvalve.mismatch.residual.goodness_of_fit import FEWEST
from sklvalve.mismatch.search.relevance import standardized_effect_size
from sklvalve.simulation.calibration import drop_is_unknown

if TYPE_CHECKING:
    from sklvalve.history import ValveHistory
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem

# what drives a channel: where the history has not been, it says nothing of what a simulation leaves over
_DRIVERS = {"opening": ("command",), "flow": ("opening", "drop")}
# rows of the blocks whose means are looked at
_LENGTHS = tuple(2**k for k in range(9))
#: An innovation further off counts as this many standard deviations: a stroke that came late is no level.
FURTHEST = 4.0
# standard deviation of the logarithm of a block's power by the errors of a noise model, however long known
_MODEL_ERROR = 0.15
_STILL = 1e-12


@dataclass(frozen=True)
class LeftSince:
    """What is left over beyond the history's noise, in the channel and in blocks where it stands out most.

    Attributes
    ----------
    channel : str
    size : float
        What is left over, as a signal that comes and goes in blocks of `rows` rows, share of span [1].
    noise : float
        What the history's noise alone comes to, looked at in the same way, share of span [1].
    allowed : float
        The same with what the simulation of the effects may get wrong, share of span [1].
    many, rows : int
        Number of blocks, and of the rows of one.
    effect_size : float
        How far it stands out, and how large it is beyond the noise, as `standardized_effect_size` has it.
    """

    channel: str
    size: float
    noise: float
    allowed: float
    many: int
    rows: int
    effect_size: float

    @property
    def times(self) -> float:
        """How many times what is allowed."""
        return self.size / self.allowed

    @property
    def beyond_noise(self) -> dict[str, float]:
        """Size, and what noise comes to, shares of span [1], and the rows of a block."""
        return {"size": self.size, "noise": self.noise, "allowed": self.allowed, "rows": self.rows}


def left_since(problem: Problem, model: Model, channels: tuple[str, ...] | None = None) -> LeftSince | None:
    r"""What a hypothesis leaves over beyond the history's noise, where it stands out most.

    The residual passes the filter that makes white noise of the history's. Then the mean of any L rows has a
    variance of one L-th; what comes back within about L rows makes it R times as large. Of blocks of one to
    256 rows

    .. math::

        z = \frac{\ln (R / A)}{\sqrt{2 / n + 2 / h + 0.15^2}}, \qquad s = \frac{\sqrt{R - A}}{g},
        \qquad A = 1 + E

    are the standard deviations by which that is more than chance, n and h being the numbers of blocks now and
    in the history, and the size that a signal has which comes and goes in such blocks; of one of size 1 the
    filter makes means with a variance of :math:`g^2 / L`. Of what the effects of the hypothesis
    change a share (`SHARE_WRONG`) may be wrong: through the same filter and in the same blocks it comes to E,
    without any to nothing. What is left over stands out most where z and s together do, as those of an
    effect. Only rows count that are where the history has been.

    Parameters
    ----------
    problem : Problem
        With a history.
    model : Model
        Whose calibration is one that the history lets expect.
    channels : tuple of str, default=None
        Those that are looked at; all of them unless told.

    Returns
    -------
    left : LeftSince or None
        None without a history, where too few rows are known, or where nothing tells the pressure drop that a
        flow comes of.
    """
    history = problem.history
    if history is None:
        return None
    # a search may have learnt the noise from this very residual
    problem = problem.with_noise_of(model, cautious=True)
    channels = problem.channels if channels is None else channels
    bare = problem.baseline(model, (), model) if model.terms else None
    by_channel = [_in_channel(problem, history, model, bare, c) for c in channels]
    seen = [each for each in by_channel if each is not None]
    return max(seen, key=lambda left: left.effect_size, default=None)


def _in_channel(
    problem: Problem, history: ValveHistory, model: Model, bare: Model | None, channel: str
) -> LeftSince | None:
    """What is left over in one channel; `bare` is the hypothesis without its effects, None of one without."""
    if channel == "flow" and drop_is_unknown(problem.recording):
        return None
    left, noise = problem.residuals(model)[channel], problem.noise[channel]
    seen = np.isfinite(left)
    known = rows_known(problem, channel) & seen
    white = np.clip(noise.whiten(left), -FURTHEST, FURTHEST)
    before = sum(window.rows for window in history.windows_)
    span, counts = problem.spans[channel], problem.least(channel)
    wrong = None
    if bare is not None:
        changed = np.where(seen, model.predictions[channel] - bare.predictions[channel], np.nan)
        wrong = np.clip(noise.whiten(SHARE_WRONG * changed), -FURTHEST, FURTHEST)
    each = []
    for rows in _LENGTHS:
        many, ratio = _ratio(white, known, rows)
        if many < FEWEST:
            break
        wave = np.where(np.arange(len(left)) // rows % 2 == 0, 1.0, -1.0)
        answer = np.sqrt(_ratio(noise.whiten(np.where(seen, wave, np.nan)), known, rows)[1])
        usual = 1.0 / (answer * span)
        free = 1.0 if wrong is None else 1.0 + _ratio(wrong, known, rows)[1]
        deviations = np.log(ratio / free) / np.sqrt(2.0 / many + 2.0 * rows / before + _MODEL_ERROR**2)
        beyond = usual * np.sqrt(max(ratio - free, 0.0))
        # without a kink where nothing stands out, so that no two recordings are alike
        effect_size = standardized_effect_size(float(np.logaddexp(0.0, deviations)), float(beyond / counts))
        size, allowed = usual * np.sqrt(ratio), usual * np.sqrt(free)
        each.append(LeftSince(channel, float(size), float(usual), float(allowed), many, rows, effect_size))
    return max(each, key=lambda left: left.effect_size, default=None)


def rows_known(problem: Problem, channel: str) -> np.ndarray:
    """Rows in which what drives a channel is where the history has been.

    Parameters
    ----------
    problem : Problem
        With a history.
    channel : str
    """
    history = cast("ValveHistory", problem.history)
    return history.range_.met(problem.recording, _DRIVERS[channel])


def _ratio(white: np.ndarray, known: np.ndarray, length: int) -> tuple[int, float]:
    """Number of blocks of so many rows of which more than half are known, and how far their means vary.

    In multiples of what they would by white noise of variance 1.
    """
    many = len(white) // length
    rows, kept = (each[: many * length].reshape(many, length) for each in (white, known))
    counts = kept.sum(axis=1)
    enough = counts > 0.5 * length
    sums = np.where(kept, rows, 0.0).sum(axis=1)[enough]
    # a signal that stands still leaves nothing over
    return int(enough.sum()), max(float(np.mean(sums**2 / counts[enough])), _STILL) if enough.any() else 1.0
