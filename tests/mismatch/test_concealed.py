# SPDX-License-Identifier: BSD-3-Clause
"""Whole recordings of an independent simulator, against what was concealed in them."""

import json
import re
from functools import cache

import numpy as np
import pytest

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.recording import read_recording
from sklvalve.report.headline import headline
from sklvalve.report.words import BLOCKS, class_clause, spoken

pytestmark = pytest.mark.slow

# how the first sentence of a report tells the size, in which unit, and how far it may be off
SIZES = {
    "choked_flow": (r"F_L ([\d.]+)", 1.0, 0.02),
    "supply_pressure_drop": (r"loss of supply pressure ([\d.]+) %", 0.01, 0.02),
}
# s; the air is lost over minutes, so that the stem shows it late or a wandering rest early
ONSET = 500.0


@cache
def _found(folder):
    return MissingPhysicsFinder().fit(read_recording(folder / "recording.csv.gz", folder / "valve.toml"))


def _truth(folder):
    return json.loads((folder / "truth.json").read_text())


@pytest.mark.parametrize("name", ["choked_flow", "nothing_closed_loop"])
def test_concealed_recording(data_folder, name):
    folder = data_folder / "concealed" / name
    truth, finder = _truth(folder), _found(folder)
    diagnosis = finder.diagnosis_
    assert diagnosis.verdict == truth["verdict"]
    assert len(diagnosis.effects) == len(truth["effects"])
    for effect in truth["effects"]:
        assert any(effect in members for members in diagnosis.effects)
    assert diagnosis.content["location"]["blocks"] == truth["blocks"]
    # rows of which it has seen nothing
    later = read_recording(folder / "later.csv.gz", folder / "valve.toml")
    nominal, corrected = (
        np.sqrt(np.nanmean((simulation.predict(later) - later["flow"]) ** 2))
        for simulation in (finder.nominal_simulation_, finder.corrected_simulation_)
    )
    assert corrected < (0.5 * nominal if truth["effects"] else 1.001 * nominal)
    assert corrected < 0.02 * np.nanmax(later["flow"])


@pytest.mark.parametrize("name", ["choked_flow", "nothing_closed_loop", "supply_drop"])
def test_first_sentence_of_the_report_agrees_with_what_was_concealed(data_folder, name):
    folder = data_folder / "concealed" / name
    truth = _truth(folder)
    said = headline(_found(folder).diagnosis_.to_dict())
    begins = {"no_mismatch": "Nothing", "named": ("The simulation lacks ", "Likely fault: ", "A fault, or ")}
    assert said.startswith(begins[truth["verdict"]])
    for block in BLOCKS:
        # a name may say already where it sits: an air leak of the actuator
        assert (BLOCKS[block].removeprefix("in ") in said) is (block in truth["blocks"])
    for effect in truth["effects"]:
        assert class_clause([{"name": effect}]) in said or spoken(effect) in said
        told, unit, off = SIZES[effect]
        (size,) = re.findall(told, said)
        assert abs(unit * float(size) - truth["strengths"][effect]) < off
    if truth["effects"] and truth["onset"]:
        (onset,) = re.findall(r"from (\d+) s on", said)
        assert abs(float(onset) - truth["onset"]) < ONSET
    elif truth["effects"]:
        assert "from the start" in said
