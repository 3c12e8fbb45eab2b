# SPDX-License-Identifier: BSD-3-Clause
"""A flow that breaks out to one side for moments, again and again, while nothing that drives it moves.

The noise model takes such moments for outliers, and means over stretches lose them. But noise and wander go
to both sides alike, so the sides are counted: what favours one is no noise, however heavy its tails.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter, minimum_filter1d, uniform_filter1d
from scipy.stats import binom

from sklvalve.mismatch.constants import LEAST_P_VALUE
from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.recording import Recording
from sklvalve.recording.dead_bands import flow_moved_by, step_of
from sklvalve.recording.runs import runs
from sklvalve.simulation.calibration import drop_is_unknown

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

# moments are medians of so many rows, so that one row makes none, about the median of so many around
_MOMENT, _AROUND = 5, 121
# they break out beyond so many robust standard deviations, half of what counts, and so many steps of reading
_OUT, _OF_WHAT_COUNTS, _STEPS = 3.5, 0.5, 1.5
# share of the flow that a step of the opening moves at most, in steps [1]: an equal percentage trim, ln 50
_STEEPEST = 4.0
# two moments are one where no more than so many rows lie between
_APART = 10
# rows count in which the simulated flow moves by less than this share of its span so many rows before and
# behind, and in which it is more than this one: where a meter ends, or is cut off, noise has one side
_SETTLING, _MOVES, _FLOWS = 10, 0.02, 0.05
_FEWEST_ROWS = 300
# share of the level of the test that this look at a recording has, beside what the others have
_OF_ALPHA = 0.25
_NORMAL = 1.4826


@dataclass(frozen=True)
class Pulses:
    """Moments in which a flow breaks out.

    Attributes
    ----------
    rows : ndarray of shape (n,), bool
        Those of the moments to the side of most.
    many, against : int
        Moments to that side, and to the other one.
    falls : bool
        Whether it is the lower side.
    size : float
        Rms of the residual about its surroundings in these rows, share of span [1].
    p_value : float
        Chance of sides as unequal where either is as likely as the other, over the share of the level that
        this look has.
    """

    rows: np.ndarray
    many: int
    against: int
    falls: bool
    size: float
    p_value: float
    channel = "flow"

    @property
    def reason(self) -> str:
        """Why nothing can be named, in a sentence."""
        return (
            f"The flow deviates to one side at {self.many} moments and to the other at {self.against}: "
            "no effect of the catalogue behaves like that."
        )

    @property
    def intervals(self) -> list[tuple[int, int]]:
        """First row and the one after the last of each moment."""
        return runs(self.rows)


def find_pulses(problem: Problem, model: Model, alpha: float) -> Pulses | None:
    r"""Moments in which the flow breaks out to one side of its simulation.

    Of the residual r of the flow, :math:`h = \mathrm{median}_5(r - \mathrm{median}_{121}(r))` is taken, and
    runs of rows beyond 3.5 times its robust standard deviation are counted above and below. With n moments of
    which m are on the side of more, chance makes as many with

    .. math:: p = 2 \sum_{k \ge m} \binom{n}{k} 2^{-n}

    (the sign test), however heavy the tails of the noise, as long as it is symmetrical and its moments come
    one by one. So rows are left out near which the simulated flow moves, for a response that is timed a
    little wrong breaks out as well, and those in which hardly anything flows, for no meter reads below its
    end.

    Parameters
    ----------
    problem : Problem
    model : Model
        Fitted for the least error, without an effect on the flow.
    alpha : float
        Level of the test, of which this look has a quarter.

    Returns
    -------
    pulses : Pulses or None
        None where the sides are alike, where the moments are smaller than what counts, where too few rows
        are at rest, and where opening or drop are not recorded: then a stem or a pump may be all of it.
    """
    recording = problem.recording
    if "flow" not in problem.channels or problem.coupled or drop_is_unknown(recording):
        return None
    span = problem.spans["flow"]
    residual, shown = problem.residuals(model)["flow"] / span, model.predictions["flow"] / span
    usable = np.isfinite(residual) & _settled(shown, recording.spans)
    if usable.sum() < _FEWEST_ROWS:
        return None
    about = _about_surroundings(residual, recording.spans)
    about -= np.median(about[usable])
    scatter = _NORMAL * np.median(np.abs(about[usable]))
    limit = max(
        _OUT * scatter, _OF_WHAT_COUNTS * problem.least("flow"), _STEPS * _step_in_flow(recording, span)
    )
    above, below = (_instants(usable & (side * about > limit)) for side in (1.0, -1.0))
    most, fewest = max(len(above), len(below)), min(len(above), len(below))
    by_chance = 2.0 * float(binom.sf(most - 1, most + fewest, 0.5))
    p_value = float(np.clip(by_chance / _OF_ALPHA, LEAST_P_VALUE, 1.0))
    if p_value > alpha:
        return None
    falls = len(below) > len(above)
    rows = _whole(usable & ((-about if falls else about) > 0.5 * limit), below if falls else above)
    size = float(np.sqrt(np.mean(about[rows] ** 2)))
    return Pulses(rows, most, fewest, falls, size, p_value) if size >= problem.least("flow") else None


def _step_in_flow(recording: Recording, span: float) -> float:
    """What the steps of the readings, or what a historian held, may make of the flow, share of span [1]."""
    moved = [flow_moved_by(recording, step_of(recording, role)) for role in ("p1", "p2") if role in recording]
    return max(step_of(recording, "flow") / span, _STEEPEST * step_of(recording, "opening"), *moved, 0.0)


def _settled(shown: np.ndarray, spans: Sequence[tuple[int, int]]) -> np.ndarray:
    """Rows in which something flows, and near which the simulated flow does not move."""
    settled = np.zeros(len(shown), dtype=bool)
    for low, high in spans:
        smooth = uniform_filter1d(np.nan_to_num(shown[low:high]), _MOMENT, mode="nearest")
        width = 2 * _SETTLING + 1
        reach = maximum_filter1d(smooth, width) - minimum_filter1d(smooth, width)
        settled[low:high] = (reach < _MOVES) & (smooth > _FLOWS)
    return settled


def _about_surroundings(residual: np.ndarray, spans: Sequence[tuple[int, int]]) -> np.ndarray:
    """Medians of few rows about that of many around, each recording for itself; gaps are left out."""
    about, known = np.zeros(len(residual)), np.isfinite(residual)
    for low, high in spans:
        piece, seen = residual[low:high], known[low:high]
        if not seen.any():
            continue
        filled = np.interp(np.arange(len(piece)), np.flatnonzero(seen), piece[seen])
        left = np.where(seen, piece - median_filter(filled, _AROUND, mode="nearest"), 0.0)
        about[low:high] = median_filter(left, _MOMENT, mode="nearest")
    return about


def _instants(out: np.ndarray) -> list[int]:
    """First rows of runs of two rows or more, those close behind another one left out."""
    starts: list[int] = []
    last = -_APART - 1
    for first, end in runs(out):
        if end - first < 2:
            continue
        if first - last > _APART:
            starts.append(first)
        last = end
    return starts


def _whole(wider: np.ndarray, starts: Sequence[int]) -> np.ndarray:
    """The runs of a wider mask that hold one of these rows."""
    rows, beginnings = np.zeros(len(wider), dtype=bool), np.array(starts)
    for first, end in runs(wider):
        if np.searchsorted(beginnings, first) < np.searchsorted(beginnings, end):
            rows[first:end] = True
    return rows
