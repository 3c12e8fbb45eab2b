# SPDX-License-Identifier: BSD-3-Clause
"""The calibrated simulation without further effects under plain white noise: where the baselines begin."""

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from threadpoolctl import threadpool_limits

from sklvalve.mismatch.first_guess import first_guess
from sklvalve.mismatch.preparation import prepared_workbench
from sklvalve.recording import require_diagnosable
from sklvalve.simulation import ValveSimulation
from sklvalve.simulation.fitting import PlainNoise
from sklvalve.simulation.side_by_side import with_threads

_KNOWN: WeakKeyDictionary = WeakKeyDictionary()


@dataclass(eq=False)
class Nominal:
    """A recording's calibrated simulation.

    Attributes
    ----------
    workbench : Workbench
        Its noise is white, of the residuals' own size.
    model : Model
    """

    workbench: object
    model: object

    @property
    def residuals(self):
        """Recorded less simulated by channel, as share of the channel's span; NaN in gaps."""
        left = self.workbench.residuals(self.model)
        return {c: left[c] / self.workbench.spans[c] for c in left}


def white(workbench, model):
    """White noise of the size of what a model leaves over, by channel."""
    left, spans = workbench.residuals(model), workbench.spans
    return {
        c: PlainNoise(max(float(np.sqrt(np.nanmean(left[c] ** 2))), 1e-6 * spans[c]))
        for c in workbench.channels
    }


def nominal_of(recording):
    """Calibration of a recording from several starts; kept as long as the recording itself.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    nominal : Nominal

    Raises
    ------
    InputError
        If the recording lacks what a simulation is judged by.
    """
    if recording not in _KNOWN:
        require_diagnosable(recording)
        with one_thread():
            workbench = prepared_workbench(recording)
            guess, _ = first_guess(workbench)
            model = workbench.fit((), start=guess)
            workbench.use_noise(white(workbench, model))
            _KNOWN[recording] = Nominal(workbench, workbench.fit((), start=model))
    return _KNOWN[recording]


class one_thread:
    """Run what is inside in one thread: methods are compared by their processor time."""

    def __enter__(self):
        self._inside = threadpool_limits(1, user_api="blas"), with_threads(1)
        for each in self._inside:
            each.__enter__()

    def __exit__(self, *error):
        for each in reversed(self._inside):
            each.__exit__(*error)


def simulation_of(workbench, model):
    """What simulates a recording as a model does: ``Recording -> {"flow", "opening"}`` in SI."""
    effects, onsets = workbench.physics_of(model.members)
    return ValveSimulation.from_parts(
        workbench.valve,
        workbench.trim,
        model.values,
        choking=model.chain.choking,
        effects=effects,
        onsets=onsets,
    ).simulate
