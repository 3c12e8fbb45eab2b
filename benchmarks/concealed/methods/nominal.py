# SPDX-License-Identifier: BSD-3-Clause
"""The calibrated simulation without further effects under plain white noise: where the baselines begin."""

from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.inference.calibrating import first_guess
from sklvalve.recording import require_diagnosable
from sklvalve.simulation import ValveSimulation
from sklvalve.simulation.fitting import PlainNoise
from sklvalve.simulation.parallel_map import with_threads

# the last recording asked for and its calibration: several methods ask for the same one
_LAST: list = []


@dataclass(eq=False)
class Nominal:
    """A recording's calibrated simulation.

    Attributes
    ----------
    problem : Problem
        Its noise is white, of the residuals' own size.
    model : Model
    """

    problem: object
    model: object

    @property
    def residuals(self):
        """Recorded less simulated by channel, as share of the channel's span; NaN in gaps."""
        left = self.problem.residuals(self.model)
        return {c: left[c] / self.problem.spans[c] for c in left}


def white(problem, model):
    """White noise of the size of what a model leaves over, by channel."""
    left, spans = problem.residuals(model), problem.spans
    return {
        c: PlainNoise(max(float(np.sqrt(np.nanmean(left[c] ** 2))), 1e-6 * spans[c]))
        for c in problem.channels
    }


def nominal_of(recording):
    """Calibration of a recording from several starts; kept until another recording is asked for.

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
    if not (_LAST and _LAST[0] is recording):
        require_diagnosable(recording)
        _LAST.clear()
        with one_thread():
            problem = prepared_problem(recording)
            guess, _ = first_guess(problem)
            model = problem.fit((), start=guess)
            problem = problem.with_noise(white(problem, model))
            _LAST[:] = recording, Nominal(problem, problem.fit((), start=model))
    return _LAST[1]


@contextmanager
def one_thread():
    """Run what is inside in one thread: methods are compared by their processor time."""
    with threadpool_limits(1, user_api="blas"), with_threads(1):
        yield


def simulation_of(problem, model):
    """What simulates a recording as a model does: ``Recording -> {"flow", "opening"}`` in SI."""
    effects, onsets = problem.physics_of(model.terms)
    return ValveSimulation.from_parts(
        problem.valve,
        problem.trim,
        model.values,
        choking=model.chain.choking,
        effects=effects,
        onsets=onsets,
    ).simulate
