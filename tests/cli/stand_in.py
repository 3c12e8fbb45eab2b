# SPDX-License-Identifier: BSD-3-Clause
"""A stand-in for the diagnosis, so that the commands can be tried in no time."""

import pickle
from typing import ClassVar

import numpy as np

from sklvalve.history import ValveHistory
from sklvalve.recording import join_recordings
from tests.report import examples


class Simulation:
    """Flow in proportion to the opening, where there is one."""

    def __init__(self, valve, gain):
        self.valve, self.gain = valve, gain

    def simulate(self, recording):
        predicted = {}
        command, opening = recording.get("command"), recording.get("opening")
        if command is not None:
            predicted |= {"opening": command, "flow_from_command": self.gain * command}
        driver = command if opening is None else opening
        if driver is not None:
            predicted["flow"] = self.gain * driver
        return predicted


class Finder:
    """Finds what `found` says, and keeps how it was asked."""

    found = staticmethod(examples.named)
    asked: ClassVar[dict] = {}

    def __init__(self, random_state=0, verbose=0, callback=None, history=None):
        self.random_state, self.callback, self.history = random_state, callback, history

    def history_of(self, recordings):
        self.fit(join_recordings(recordings))
        return ValveHistory().fit(recordings)

    def fit(self, recording, until=None):
        type(self).asked = {"rows": len(recording), "until": until, "seed": self.random_state}
        if self.callback:
            self.callback("calibrating", 0.5)
        self.diagnosis_ = examples.diagnosis(self.found(), n=400)
        self.nominal_simulation_ = Simulation(recording.valve, 0.008)
        self.corrected_simulation_ = Simulation(recording.valve, 0.01)
        return self


def save_model(path, finder):
    parts = {"corrected": finder.corrected_simulation_, "nominal": finder.nominal_simulation_}
    with open(path, "wb") as file:
        pickle.dump(parts | {"diagnosis": finder.diagnosis_.to_dict()}, file)


def load_model(path):
    with open(path, "rb") as file:
        return pickle.load(file)


VALVE = """
[valve]
tag = "FV-101"
[recording]
time = "t"
[recording.command]
column = "CV"
unit = "%"
sense = "closing"
[recording.opening]
column = "X"
unit = "%"
[recording.flow]
column = "F"
unit = "m3/h"
[recording.p1]
column = "P1"
unit = "kPa"
[recording.p2]
constant = 100.0
unit = "kPa"
"""


def columns(n=40):
    travel = np.linspace(0.0, 100.0, n)
    return {
        "t": 100.0 + np.arange(n),
        "CV": 100.0 - travel,
        "X": travel,
        "F": 0.36 * travel,
        "P1": np.full(n, 500.0),
    }


def csv_text(table):
    lines = [",".join(table)]
    lines += [
        ",".join("" if value != value else str(value) for value in row)
        for row in zip(*table.values(), strict=True)
    ]
    return "\n".join(lines) + "\n"
