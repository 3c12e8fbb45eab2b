# SPDX-License-Identifier: BSD-3-Clause
"""Whole recordings of an independent simulator, against what was concealed in them."""

import json

import numpy as np
import pytest

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.recording import read_recording

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("name", ["choked_flow", "nothing_closed_loop"])
def test_concealed_recording(data_folder, name):
    folder = data_folder / "concealed" / name
    truth = json.loads((folder / "truth.json").read_text())
    valve = folder / "valve.toml"
    finder = MissingPhysicsFinder().fit(read_recording(folder / "recording.csv.gz", valve))
    diagnosis = finder.diagnosis_
    assert diagnosis.verdict == truth["verdict"]
    assert len(diagnosis.effects) == len(truth["effects"])
    for effect in truth["effects"]:
        assert any(effect in members for members in diagnosis.effects)
    assert diagnosis.content["location"]["blocks"] == truth["blocks"]
    # rows of which it has seen nothing
    later = read_recording(folder / "later.csv.gz", valve)
    nominal, corrected = (
        np.sqrt(np.nanmean((simulation.predict(later) - later["flow"]) ** 2))
        for simulation in (finder.nominal_simulation_, finder.corrected_simulation_)
    )
    assert corrected < (0.5 * nominal if truth["effects"] else 1.001 * nominal)
    assert corrected < 0.02 * np.nanmax(later["flow"])
