# SPDX-License-Identifier: BSD-3-Clause
"""Simulations that the recordings are held against; both learn nothing but from a sound run.

``learnt``: the stem by an LS-SVM of command and pressure drop, as a user has it who knows the data sheet and
has a sound run; of the generator's constants only those of the sheet are used.
``nominal``: the stem of the generator's own sound run under the same command (column X_nominal), for whom the
benchmark's model is that of his valve: but for the noise of the sensors an inverse crime.
The flow is in both that of the sheet by IEC 60534-2-1, calibrated on the sound run, at the recorded position.
"""

import numpy as np
from sklearn.model_selection import GridSearchCV, TimeSeriesSplit
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from sklvalve import LSSVMRegressor, Recording, Valve
from sklvalve.damadics import valve_sheet
from sklvalve.simulation import ValveSimulation

# how far back the learnt stem looks at the command, and at the pressure drop [s]
_COMMANDS, _DROPS = (0, 1, 2, 3, 5, 8, 13), (0, 1, 2, 3, 4, 5, 6, 7)
#: Rows of which the first have no full past.
LOOKS_BACK = max(_COMMANDS)
_GRID = {"lssvmregressor__C": [100.0, 1000.0], "lssvmregressor__gamma": [0.01, 0.03, 0.1]}


def black_box(inputs, target):
    """LS-SVM of consecutive rows, tuned on blocks of them."""
    model = make_pipeline(StandardScaler(), LSSVMRegressor())
    search = GridSearchCV(model, _GRID, cv=TimeSeriesSplit(3, gap=LOOKS_BACK))
    return search.fit(inputs, target).best_estimator_


def stem_inputs(recording):
    """Command and pressure drop, now and before, that tell the stem, of shape (n, 15)."""
    signals = (recording["command"], _COMMANDS), (recording["p1"] - recording["p2"], _DROPS)
    return np.column_stack([_before(values, lag) for values, lags in signals for lag in lags])


class Nominal:
    """The stem as the recording has it of the generator, the flow of the sheet."""

    nominal = True

    def recording(self, frame):
        """Frame of `make_damadics` as a recording."""
        return Recording.from_frame(frame, Valve.from_dict(valve_sheet(nominal=self.nominal)))

    def fit(self, recording):
        """Calibrate on a sound recording."""
        self.physics = ValveSimulation().fit(recording)
        return self

    def opening(self, recording):
        """Opening under the command of a recording, of shape (n,) [1]."""
        return recording["simulated_opening"]

    def flow(self, recording):
        """Flow at the recorded opening, of shape (n,) [t/h]."""
        return 3.6 * self.physics.simulate(recording)["flow"]

    def for_finder(self):
        """What a `MissingPhysicsFinder` is to hold against a recording; None is what the recording has."""


class Learnt(Nominal):
    """The stem as learnt on the sound run, the flow of the sheet."""

    nominal = False

    def fit(self, recording):
        """Calibrate, and learn the stem."""
        super().fit(recording)
        self.stem = black_box(stem_inputs(recording)[LOOKS_BACK:], recording["opening"][LOOKS_BACK:])
        return self

    def opening(self, recording):
        """Opening under the command of a recording, of shape (n,) [1]."""
        return self.stem.predict(stem_inputs(recording))

    def for_finder(self):
        """What a `MissingPhysicsFinder` is to hold against a recording."""
        return lambda recording: {"opening": self.opening(recording)}


SIMULATIONS = {"learnt": Learnt, "nominal": Nominal}


def _before(values, lag):
    """Values of some samples before; the first stands for what was before it."""
    return np.concatenate([np.full(lag, values[0]), values[: len(values) - lag]])
