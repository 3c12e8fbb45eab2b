# SPDX-License-Identifier: BSD-3-Clause
"""A fitted hypothesis fitted again to some of its rows, by one step of its linearisation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.mismatch.inference.linearised import Linearised
from sklvalve.simulation.fitting import left_of, simulate_channels

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

#: Blocks of a recording, of which every fourth is left out in turn.
BLOCKS, FOLDS = 16, 4


def lines_of(problem: Problem, model: Model) -> list[Linearised]:
    """A hypothesis linearised, channels that share no parameter each by itself."""
    lines = {}
    for channel in problem.channels:
        line = Linearised(problem, model, (channel,))
        lines[line.channels] = line
    return list(lines.values())


def refitted(
    problem: Problem, model: Model, lines: Sequence[Linearised], rows: np.ndarray
) -> dict[str, float]:
    """Values fitted to some rows only, by one step of each line."""
    values, history = dict(model.values), problem.history
    for line in lines:
        values |= _shortened(problem, model, line, rows) if history is None else line.refitted(rows)
    return values if history is None else history.expected_of(values)


def _shortened(problem: Problem, model: Model, line: Linearised, rows: np.ndarray) -> dict[str, float]:
    """Values after a step that plain squares shorten, as they did where the limit of `held_out` was measured.

    Steps by their own cost go further, where few rows tell an effect from the calibration.
    """
    least, values = _error(problem, model.predictions, line, rows), {}
    for steps in line.towards(rows):
        values = line.values(steps)
        made = simulate_channels(model.chain, model.values | values, line.channels)
        if _error(problem, made, line, rows) <= least:
            break
    return values


def blocks_in_turn(rows: int) -> np.ndarray:
    """Number of the block that each row is in, of `BLOCKS` contiguous ones."""
    return np.arange(rows) * BLOCKS // rows


def fits_without(problem: Problem, model: Model) -> Iterator[tuple[np.ndarray, Model]]:
    """A hypothesis fitted again without every fourth block in turn: the rows left out, and the fit.

    So what acts for a while only, or from an onset on, is both fitted and left out.
    """
    lines, block = lines_of(problem, model), blocks_in_turn(len(problem.recording))
    for fold in range(FOLDS):
        held = block % FOLDS == fold
        yield held, problem.simulate(model.terms, refitted(problem, model, lines, ~held))


def _error(problem: Problem, made: dict[str, np.ndarray], line: Linearised, rows: np.ndarray) -> float:
    """Squared errors of the channels of a line on some rows, each in its own size."""
    return sum(
        np.nansum(left_of(problem.recording, made, c)[rows] ** 2) / problem.spans[c] ** 2
        for c in line.channels
    )
