# SPDX-License-Identifier: BSD-3-Clause
"""Derivatives of the simulation by the parameters of every effect, and by the calibration beside it."""

import numpy as np
import pytest

from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.hypothesis import Member
from sklvalve.mismatch.workbench import Workbench
from sklvalve.simulation import Tolerance
from sklvalve.simulation.fitting import Misfit, PlainNoise

# of the rows off corners: what follows one that was rounded the other way differs a little
MOST = 0.75


@pytest.fixture(scope="module")
def bench(healthy):
    return Workbench(healthy, Tolerance(), ())


def _misfit(bench, members, rng):
    """Simulation error as a function of all parameters, and a point well inside their bounds."""
    chain, channels = bench.chain(members), bench.channels
    parameters = bench.parameters(chain, channels, members)
    misfit = Misfit(chain, parameters, channels, {c: PlainNoise(bench.spans[c]) for c in channels})
    vector = misfit.vector
    own = np.array([p.name.partition(".")[2] != "" for p in parameters])
    z = vector.pack({})
    # the calibration near where fits begin, what an effect brings anywhere within a third of its range
    near = 0.2 * vector.scale * rng.uniform(-1.0, 1.0, len(z))
    far = np.minimum(vector.high - z, z - vector.low + vector.scale) * rng.uniform(0.05, 0.3, len(z))
    inside = 0.01 * (vector.high - vector.low)
    return misfit, np.clip(z + np.where(own, far, near), vector.low + inside, vector.high - inside)


@pytest.mark.parametrize("effect", CATALOGUE, ids=lambda effect: effect.key)
def test_derivatives_are_those_of_central_differences(effect, bench):
    if getattr(effect, "motor", False) or not effect.possible(bench.plain):
        pytest.skip("this valve cannot have it")
    rng = np.random.default_rng(sum(map(ord, effect.key)))
    misfit, z = _misfit(bench, (Member(effect),), rng)
    slopes = misfit.slopes(z, misfit.errors(z))
    for j, name in enumerate(misfit.vector.names):
        h = np.zeros(len(z))
        h[j] = 1e-6 * misfit.vector.scale[j]
        before, here, behind = misfit.errors(z - h), misfit.errors(z), misfit.errors(z + h)
        central, bent = (behind - before) / (2.0 * h[j]), (behind - 2.0 * here + before) / h[j]
        size = np.abs(central).max()
        straight = (central != 0.0) & (np.abs(bent) < 1e-4 * size)
        # most rows lie off a corner, or the test says nothing
        assert size < 1e-6 or np.mean(straight[central != 0.0]) > 0.5, name
        off = np.abs(slopes[straight, j] - central[straight])
        assert not len(off) or np.quantile(off, MOST) <= 1e-6 * size + 1e-8, name
