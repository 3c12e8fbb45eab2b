# SPDX-License-Identifier: BSD-3-Clause
"""Simulations that the recordings are held against.

``sheet``: the data sheet alone, calibrated on the sound run, with the push of the fluid on the stem, which a
sheet leaves out and every sound run shows. ``learnt``: the same, and what it leaves over of the sound run's
position learnt by an LS-SVM; no constant of the benchmark's generator but those on the sheet is used.
``nominal``: the generator's own sound run under the same command (column X_nominal), for whom the benchmark's
model is that of his valve: it commits an inverse crime, but for the noise.
The flow is that of the sheet in all three, from the position as recorded.
"""

import numpy as np
from sklearn.model_selection import GridSearchCV, TimeSeriesSplit
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from sklvalve import LSSVMRegressor, Recording, Valve
from sklvalve.damadics import valve_sheet
from sklvalve.mismatch import CATALOGUE
from sklvalve.simulation import ValveSimulation

#: How far back the learnt rest looks at the command, and at the pressure drop [s].
LAGS = (0, 1, 2, 3, 4, 5, 6, 8, 10, 13)
_GRID = {"lssvmregressor__C": [10.0, 100.0, 1000.0], "lssvmregressor__gamma": [0.005, 0.02, 0.1]}
_STEM_LOAD = tuple(effect for effect in CATALOGUE if effect.key == "stem_load")


class Sheet:
    """Data sheet with the fluid's push on the stem, calibrated on a sound run."""

    nominal, effects = False, _STEM_LOAD
    #: Whether all that differs from it is new since the sound run.
    sound = False

    def recording(self, frame):
        """Frame of `make_damadics` as a recording."""
        return Recording.from_frame(frame, Valve.from_dict(valve_sheet(nominal=self.nominal)))

    def fit(self, recording):
        """Calibrate on a sound recording."""
        self.physics = ValveSimulation(effects=self.effects).fit(recording)
        return self

    def opening(self, recording):
        """Opening under the command of a recording, of shape (n,) [1]."""
        return self.physics.simulate(recording)["opening"]

    def flow(self, recording):
        """Flow at the recorded opening, of shape (n,) [t/h]."""
        return 3.6 * self.physics.simulate(recording)["flow"]

    def for_finder(self):
        """What a `MissingPhysicsFinder` is to hold against a recording."""
        return ValveSimulation(effects=self.effects)


class Learnt(Sheet):
    """The same, and the rest of the position learnt on the sound run."""

    sound = True

    def fit(self, recording):
        """Calibrate, and learn what is left."""
        super().fit(recording)
        after = max(LAGS)
        left = recording["opening"] - super().opening(recording)
        search = GridSearchCV(
            make_pipeline(StandardScaler(), LSSVMRegressor()), _GRID, cv=TimeSeriesSplit(3, gap=after)
        )
        self.rest = search.fit(self._inputs(recording)[after:], left[after:]).best_estimator_
        return self

    def opening(self, recording):
        """Opening under the command of a recording, of shape (n,) [1]."""
        return super().opening(recording) + self.rest.predict(self._inputs(recording))

    def for_finder(self):
        """What a `MissingPhysicsFinder` is to hold against a recording."""
        return lambda recording: {"opening": self.opening(recording)}

    def _inputs(self, recording):
        drop, stem = recording["p1"] - recording["p2"], super().opening(recording)
        columns = [(recording["command"], LAGS), (drop, LAGS[:6]), (stem, LAGS[:3])]
        return np.column_stack([_before(values, lag) for values, lags in columns for lag in lags])


class Nominal(Sheet):
    """The generator's own sound run, given as a column."""

    nominal, effects, sound = True, (), True

    def opening(self, recording):
        """Opening under the command of a recording, of shape (n,) [1]."""
        return recording["simulated_opening"]

    def for_finder(self):
        """What a `MissingPhysicsFinder` is to hold against a recording: what is in it."""


SIMULATIONS = {"sheet": Sheet, "learnt": Learnt, "nominal": Nominal}


def _before(values, lag):
    """Values of some samples before; the first stands for what was before it."""
    return np.concatenate([np.full(lag, values[0]), values[: len(values) - lag]])
