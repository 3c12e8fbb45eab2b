# SPDX-License-Identifier: BSD-3-Clause
"""Where a calibration begins: near enough that its fits end in the right valley."""

import numpy as np
from scipy.stats import qmc

from sklvalve.simulation.calibration import apparent_kv
from sklvalve.simulation.fitting import MAJORITY, SOFT, PlainNoise, fit_chain
from sklvalve.simulation.parameters import ParameterVector

_DRAWS = 64
# a row this near its simulation is met, share of travel [1]
_CLOSE = 0.003


def first_values(chain, parameters, *, flow=True, begin=None, rows=None):
    """Values to begin with: the actuator's landscape has side valleys, so several are tried.

    Parameters
    ----------
    chain : Chain
        The simulation to be calibrated.
    parameters : sequence of Parameter
        Those of positioner and actuator; empty where no opening is held against a command.
    flow : bool, default=True
        Whether the flow is simulated, so that a trim which no sheet gives is to be learnt.
    begin : dict, default=None
        Values that are known already.
    rows : ndarray of bool, default=None
        Rows to use.

    Returns
    -------
    values : dict
    sound : dict
        Values of an actuator that meets most rows closely and lets the others go: where something is missing
        from the simulation, the best fit to all rows bends the actuator to make up for it. Empty where no
        position is recorded.
    """
    recording, values = chain.recording, dict(begin or {})
    sound = {}
    if flow and not chain.trim.known:
        opening = recording.get("opening")
        opening = recording["command"] if opening is None else opening
        values |= chain.trim.first_values(opening, apparent_kv(recording))
    if parameters:
        best, sound = _actuator(chain, parameters, dict(begin or {}), rows)
        values |= best
    return values, sound


def _actuator(chain, parameters, begin, rows):
    vector = ParameterVector(parameters)
    low, high = vector.low, vector.high
    draws = low + (high - low) * qmc.Sobol(len(vector), seed=0).random(_DRAWS)
    losses = [_opening_loss(chain, vector.values(z)) for z in draws]
    # whether there is a scan between command and stem decides which valley is the right one
    scan = chain.recording.sample_time
    starts = [begin | {"actuator_delay": share * scan} for share in (0.02, 0.5, 1.0)]
    starts.append(vector.values(draws[int(np.argmin(losses))]))

    def fits(scale, starts, loss):
        noise = {"opening": PlainNoise(scale)}
        settings = {"rows": rows, "max_steps": 8, "loss": loss}
        made = [
            fit_chain(chain, parameters, ("opening",), noise, start=start, **settings) for start in starts
        ]
        return [fit.values for fit in sorted(made, key=lambda fit: -fit.log_likelihood)]

    # coarse enough that a wrong stroke costs more than a small error that lasts
    coarse = fits(0.02, starts, SOFT)
    return coarse[0], fits(_CLOSE, (coarse[0], *starts[:2]), MAJORITY)[0]


def _opening_loss(chain, values):
    gap = np.abs(chain.recording["opening"] - chain.opening(values))
    return float(np.nanmean(np.minimum(gap, 0.1)))
