# SPDX-License-Identifier: BSD-3-Clause
"""The generator's own law, fed with measured signals: what their noise leaves to be known, and no rival."""

import numpy as np

from benchmarks.paper.valve import USUAL_TEMPERATURE
from sklvalve.mechanism import water_density


class GeneratorsLaw:
    """Capacity of the simulated valve over its opening, read off signals without noise.

    Parameters
    ----------
    clean : dict of ndarray of shape (n,)
        Signals without noise, of flow that is not choked.
    task : Task
    """

    def __init__(self, clean, task):
        self._task = task
        capacity = clean["flow"] / np.sqrt((clean["p1"] - clean["p2"]) * _density(clean["temperature"]))
        order = np.argsort(clean["opening"])
        self._openings, self._capacities = clean["opening"][order], capacity[order]

    def predict(self, X):
        """Flow [t/s] or outlet pressure [Pa] for signals as measured."""
        signals = {"temperature": np.full(len(X), USUAL_TEMPERATURE)}
        signals |= dict(zip(self._task.inputs, X.T, strict=True))
        capacity = np.interp(signals["opening"], self._openings, self._capacities)
        density = _density(signals["temperature"])
        if self._task.target == "flow":
            return capacity * np.sqrt(np.maximum(signals["p1"] - signals["p2"], 0.0) * density)
        return signals["p1"] - (signals["flow"] / capacity) ** 2 / density


def _density(kelvin):
    return water_density(kelvin, warn=False)
