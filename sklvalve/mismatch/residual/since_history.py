# SPDX-License-Identifier: BSD-3-Clause
"""What a hypothesis leaves over beyond the noise that its history has: slowly, in pulses, or to and fro."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.residual.goodness_of_fit import FEWEST, LeftOver
from sklvalve.mismatch.search.relevance import effect_strength
from sklvalve.simulation.calibration import drop_is_unknown

if TYPE_CHECKING:
    from sklvalve.history import ValveHistory
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem

# what drives a channel: where the history has not been, it says nothing of what a simulation leaves over
_DRIVERS = {"opening": ("command",), "flow": ("opening", "drop")}
# rows of the blocks whose means are looked at
_LENGTHS = tuple(2**k for k in range(9))
# an innovation further off counts as this many standard deviations: a stroke that came late is no level
_FURTHEST = 4.0
# standard deviation of the logarithm of a block's power by the errors of a noise model, however long known
_MODEL_ERROR = 0.15
_STILL = 1e-12


@dataclass(frozen=True)
class LeftSince(LeftOver):
    """What is left over beyond the history's noise, in the channel and in blocks where it stands out most.

    Attributes
    ----------
    channel : str
    size : float
        Rms of the residual's means over the blocks, share of span [1].
    noise, allowed : float
        What the history lets expect of it, share of span [1].
    many : float
        Number of blocks.
    deviations : float
        How far it stands out, in standard deviations of what two recordings of one noise differ by.
    """

    deviations: float

    def strength(self, counts: float) -> float:
        """How strong it is, as `effect_strength` has it of an effect.

        Parameters
        ----------
        counts : float
            What counts in the channel, share of span [1].
        """
        beyond = np.sqrt(max(self.size**2 - self.allowed**2, 0.0))
        # without a kink where nothing stands out, so that no two recordings are alike
        return effect_strength(float(np.logaddexp(0.0, self.deviations)), float(beyond) / counts)


def left_since(problem: Problem, model: Model) -> LeftSince | None:
    r"""What a hypothesis leaves over beyond the history's noise, where it stands out most.

    The residual passes the filter that makes white noise of the history's. Then the mean of any L rows has a
    variance of one L-th; what comes back within about L rows makes it larger. Of blocks of one to 256 rows

    .. math:: z = \frac{\ln R_L}{\sqrt{2 / n + 2 / h + 0.15^2}}

    is largest where it stands out most, with R the variance over its expectation, and n and h the numbers of
    blocks now and in the history. Now only rows count that are where the history has been.

    Parameters
    ----------
    problem : Problem
        With a history.
    model : Model
        Whose calibration is one that the history lets expect.

    Returns
    -------
    left : LeftSince or None
        None without a history, where too few rows are known, or where nothing tells the pressure drop that a
        flow comes of.
    """
    if problem.history is None:
        return None
    by_channel = [_in_channel(problem, problem.history, model, c) for c in problem.channels]
    seen = [each for each in by_channel if each is not None]
    return max(seen, key=lambda left: left.deviations, default=None)


def _in_channel(problem: Problem, history: ValveHistory, model: Model, channel: str) -> LeftSince | None:
    if channel == "flow" and drop_is_unknown(problem.recording):
        return None
    left = problem.residuals(model)[channel]
    known = history.range_.met(problem.recording, _DRIVERS[channel]) & np.isfinite(left)
    white = np.clip(problem.noise[channel].whiten(left), -_FURTHEST, _FURTHEST)
    before = sum(window.rows for window in history.windows_)
    seen = []
    for length in _LENGTHS:
        means, counts = _means(white, known, length)
        if len(means) < FEWEST:
            break
        # a signal that stands still leaves nothing over
        ratio = max(float(np.mean(counts * means**2)), _STILL)
        spread = np.sqrt(2.0 / len(means) + 2.0 * length / before + _MODEL_ERROR**2)
        size = float(np.sqrt(np.mean(_means(left, known, length)[0] ** 2))) / problem.spans[channel]
        usual = size / np.sqrt(ratio)
        seen.append(LeftSince(channel, size, usual, usual, len(means), float(np.log(ratio) / spread)))
    return max(seen, key=lambda each: each.deviations, default=None)


def _means(values: np.ndarray, known: np.ndarray, length: int) -> tuple[np.ndarray, np.ndarray]:
    """Means over blocks of so many rows of which more than half are known, and how many are."""
    many = len(values) // length
    rows, kept = (each[: many * length].reshape(many, length) for each in (values, known))
    counts = kept.sum(axis=1)
    enough = counts > 0.5 * length
    return np.where(kept, rows, 0.0).sum(axis=1)[enough] / counts[enough], counts[enough]
