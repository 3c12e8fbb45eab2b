# SPDX-License-Identifier: BSD-3-Clause
"""Where the calibration begins: near enough that its fits end in the right valley."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import qmc

from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.simulation.calibration import apparent_kv
from sklvalve.simulation.fitting import MAJORITY, SOFT, PlainNoise, fit_chain
from sklvalve.simulation.parameters import ParameterVector

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.simulation.fitting import Loss

_DRAWS = 64
# a row this near its simulation is met, share of travel [1]
_CLOSE = 0.003


def first_guess(problem: Problem) -> tuple[Model, dict[str, float]]:
    """Values to begin with: the actuator's landscape has side valleys, so several are tried.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    guess : Model
        With values alone.
    sound : dict
        Values of an actuator that meets most rows closely and lets the others go: where something is missing
        from the simulation, the best fit to all rows bends the actuator to make up for it. Empty where no
        position is recorded.
    """
    recording, first = problem.recording, dict(problem.held_values)
    sound: dict[str, float] = {}
    if "flow" in problem.channels and not problem.trim.known:
        opening = recording.get("opening")
        opening = recording["command"] if opening is None else opening
        first |= problem.trim.first_values(opening, apparent_kv(recording))
    if "command" in recording and not problem.coupled:
        best, sound = _actuator(problem)
        first |= best
    return Model((), problem.plain, first, {}, np.nan, {}), sound


def _actuator(problem: Problem) -> tuple[dict[str, float], dict[str, float]]:
    parameters = problem.calibration(("opening",))
    vector = ParameterVector(parameters)
    low, high = vector.low, vector.high
    draws = low + (high - low) * qmc.Sobol(len(vector), seed=0).random(_DRAWS)
    losses = [_opening_loss(problem, vector.values(z)) for z in draws]
    # whether there is a scan between command and stem decides which valley is the right one
    scan = problem.recording.sample_time
    begin = problem.held_values
    starts = [begin | {"actuator_delay": share * scan} for share in (0.02, 0.5, 1.0)]
    starts.append(vector.values(draws[int(np.argmin(losses))]))

    def fits(scale: float, starts: Iterable[dict[str, float]], loss: Loss) -> list[dict[str, float]]:
        noise = {"opening": PlainNoise(scale)}
        made = [
            fit_chain(
                problem.plain,
                parameters,
                ("opening",),
                noise,
                start=start,
                rows=problem.rows,
                max_steps=8,
                loss=loss,
            )
            for start in starts
        ]
        return [fit.values for fit in sorted(made, key=lambda fit: -fit.log_likelihood)]

    # coarse enough that a wrong stroke costs more than a small error that lasts
    coarse = fits(0.02, starts, SOFT)
    return coarse[0], fits(_CLOSE, (coarse[0], *starts[:2]), MAJORITY)[0]


def _opening_loss(problem: Problem, values: dict[str, float]) -> float:
    gap = np.abs(problem.recording["opening"] - problem.plain.opening(values))
    return float(np.nanmean(np.minimum(gap, 0.1)))
