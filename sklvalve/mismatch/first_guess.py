# SPDX-License-Identifier: BSD-3-Clause
"""Where the calibration begins: near enough that its fits end in the right valley."""

import numpy as np
from scipy.stats import qmc

from sklvalve.mismatch.hypothesis import Model
from sklvalve.simulation.calibration import apparent_kv
from sklvalve.simulation.fitting import PlainNoise, fit_chain
from sklvalve.simulation.parameters import ParameterVector

_DRAWS = 64


def first_guess(workbench):
    """Values to begin with: the actuator's landscape has side valleys, so several are tried.

    Parameters
    ----------
    workbench : Workbench

    Returns
    -------
    guess : Model
        With values alone.
    """
    recording, first = workbench.recording, dict(workbench.held_values)
    if "flow" in workbench.channels and not workbench.trim.known:
        opening = recording.get("opening")
        opening = recording["command"] if opening is None else opening
        first |= workbench.trim.first_values(opening, apparent_kv(recording))
    if "command" in recording and not workbench.coupled:
        first |= _actuator(workbench)
    return Model((), workbench.plain, first, {}, np.nan, {})


def _actuator(workbench):
    parameters = workbench.calibration(("opening",))
    vector = ParameterVector(parameters)
    low, high = vector.low, vector.high
    draws = low + (high - low) * qmc.Sobol(len(vector), seed=0).random(_DRAWS)
    losses = [_opening_loss(workbench, vector.values(z)) for z in draws]
    # coarse enough that a wrong stroke costs more than a small error that lasts
    coarse = {"opening": PlainNoise(0.02)}
    best, least = {}, np.inf
    # whether there is a scan between command and stem decides which valley is the right one
    scan = workbench.recording.sample_time
    begin = workbench.held_values
    scans = [vector.pack(begin | {"actuator_delay": share * scan}) for share in (0.02, 0.5, 1.0)]
    for z in (*scans, draws[int(np.argmin(losses))]):
        fit = fit_chain(
            workbench.plain,
            parameters,
            ("opening",),
            coarse,
            start=vector.values(z),
            rows=workbench.rows,
            max_steps=8,
        )
        if -fit.log_likelihood < least:
            best, least = fit.values, -fit.log_likelihood
    return best


def _opening_loss(workbench, values):
    gap = np.abs(workbench.recording["opening"] - workbench.plain.opening(values))
    return float(np.nanmean(np.minimum(gap, 0.1)))
