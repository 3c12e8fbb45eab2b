# SPDX-License-Identifier: BSD-3-Clause
"""A step to some rows is judged by what it was made to lessen."""

import numpy as np
import pytest

from sklvalve import Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.inference.refitting import lines_of
from sklvalve.simulation.robust import robust_cost


@pytest.fixture(scope="module")
def bench():
    made = make_valve_recording(loop="wide", n_samples=900, n_later=0, random_state=2)
    return calibrated(prepared_problem(Recording.from_frame(made.frame, Valve.from_dict(made.valve))))


def costs(problem, line, values, rows):
    """Robust cost of whitened errors in some rows, with the distances from what is expected."""
    whitened, priors = [], []
    for misfit in problem.misfits(problem.simulate((), values), line.channels):
        z = misfit.vector.pack(values)
        whitened += [
            np.where(np.tile(rows, len(misfit.channels)), misfit.whitened(misfit.predictions(z)), 0.0)
        ]
        priors += [misfit.vector.prior_residuals(z)]
    return robust_cost(np.concatenate([*whitened, *priors]))


@pytest.mark.parametrize("share", [0.4, 0.7])
def test_a_refit_never_makes_its_own_rows_less_likely(bench, share):
    problem, nominal = bench
    rows = np.arange(len(problem.recording)) < share * len(problem.recording)
    for line in lines_of(problem, nominal):
        values = nominal.values | line.refitted(rows)
        assert costs(problem, line, values, rows) <= costs(problem, line, nominal.values, rows) * (1 + 1e-9)


def test_where_no_share_of_a_step_helps_the_values_stay(bench, monkeypatch):
    problem, nominal = bench
    rows = np.arange(len(problem.recording)) < 360
    for line in lines_of(problem, nominal):
        monkeypatch.setattr(line, "_errors_after", lambda steps, line=line: line.errors + 1e3)
        refitted = line.refitted(rows)
        assert refitted == pytest.approx({name: nominal.values[name] for name in refitted})
