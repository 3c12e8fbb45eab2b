# SPDX-License-Identifier: BSD-3-Clause
"""Where the calibration begins: near enough that its fits end in the right valley."""

import numpy as np
from scipy.stats import qmc

from sklvalve.mismatch.hypothesis import Model
from sklvalve.simulation.calibration import apparent_kv
from sklvalve.simulation.fitting import MAJORITY, SOFT, PlainNoise, fit_chain
from sklvalve.simulation.parameters import ParameterVector

_DRAWS = 64
# a row this near its simulation is met, share of travel [1]
_CLOSE = 0.003


def first_guess(problem):
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
    recording, first, sound = problem.recording, dict(problem.held_values), {}
    if "flow" in problem.channels and not problem.trim.known:
        opening = recording.get("opening")
        opening = recording["command"] if opening is None else opening
        first |= problem.trim.first_values(opening, apparent_kv(recording))
    if "command" in recording and not problem.coupled:
        best, sound = _actuator(problem)
        first |= best
    return Model((), problem.plain, first, {}, np.nan, {}), sound


def _actuator(problem):
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

    def fits(scale, starts, loss):
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


def _opening_loss(problem, values):
    gap = np.abs(problem.recording["opening"] - problem.plain.opening(values))
    return float(np.nanmean(np.minimum(gap, 0.1)))
