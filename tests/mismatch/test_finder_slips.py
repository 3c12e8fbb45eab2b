# SPDX-License-Identifier: BSD-3-Clause
"""Stiction named by its slips: what is told, what stays, what is saved, and when slips name nothing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch import CATALOGUE, MissingPhysicsFinder, load_model, save_model
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.search.events import P_VALUE, beside_events, effects_to_search
from sklvalve.mismatch.signals.stick_slip import find_slips
from sklvalve.report import to_text
from sklvalve.simulation import ValveSimulation

from .conftest import agree, record

JUMP = 0.05


@pytest.fixture(scope="module")
def slipping():
    """A stem that rests until the error is somewhere about 2 %, and jumps past its command."""
    sound = record(random_state=4)
    rng = np.random.default_rng(5)
    rows = np.arange(len(sound))
    command = 0.5 + 0.15 * np.sin(rows / 60.0) + 0.05 * np.sin(rows / 17.0)
    stem = np.empty(len(rows))
    held = command[0]
    for row in rows:
        # no friction is the same twice, so no free run keeps the moments of the slips
        if abs(command[row] - held) > rng.uniform(0.015, 0.035):
            held += np.sign(command[row] - held) * rng.normal(JUMP, 0.002)
        stem[row] = held
    sensor = 0.0005 * rng.standard_normal(len(rows))
    moved = replace(sound, signals=sound.signals | {"command": command, "opening": stem + sensor})
    simulation = ValveSimulation().fit(sound)
    flow = simulation.predict(moved) + sound["flow"] - simulation.predict(sound)
    return replace(moved, signals=moved.signals | {"flow": flow})


@pytest.fixture(scope="module")
def found(slipping):
    return MissingPhysicsFinder().fit(slipping)


@pytest.mark.slow
def test_rules_and_table_agree_with_a_name_told_by_slips(found):
    agree(found.diagnosis_.content)


@pytest.mark.slow
def test_slips_name_stiction_with_its_jump(found):
    content = found.diagnosis_.content
    assert found.diagnosis_.verdict == "named"
    assert found.diagnosis_.effects == (("stiction", "friction"),)
    (entry,) = content["effects"]
    told = entry["parameters"]["jump"]
    assert told["value"] == pytest.approx(JUMP, abs=0.003)
    assert told["ci95"][0] <= told["value"] <= told["ci95"][1]
    assert content["mismatch"]["p_value"] <= P_VALUE
    assert content["location"]["blocks"] == ["actuator"]
    assert "the moments of the slips are not predicted" in " ".join(to_text(content).split())


def test_simulation_stays_as_it_is(found, slipping):
    nominal, corrected = (
        s.simulate(slipping) for s in (found.nominal_simulation_, found.corrected_simulation_)
    )
    np.testing.assert_array_equal(corrected["opening"], nominal["opening"])
    error = found.diagnosis_.content["fit"]["opening"]["rmse"]
    assert error["corrected"] == pytest.approx(error["nominal"], rel=1e-9)


def test_rows_that_slip_are_flagged(found, slipping):
    flagged = found.diagnosis_.traces["flagged"]
    rows = find_slips(slipping["command"], slipping["opening"]).rows
    assert flagged[rows].all()
    assert flagged[rows + 1].all()
    assert flagged.sum() <= 6 * len(rows)


def test_model_with_slips_is_read_back(found, slipping, tmp_path):
    pytest.importorskip("skops", reason='needs pip install "sklvalve[skops]"')
    save_model(tmp_path / "model.skops", found)
    read = load_model(tmp_path / "model.skops")["corrected"]
    assert [e.key for e in read.effects] == ["stiction_slips"]
    np.testing.assert_array_equal(read.predict(slipping), found.corrected_simulation_.predict(slipping))


@pytest.mark.slow
@pytest.mark.parametrize(
    "less",
    [
        {"alpha": 0.5 * P_VALUE},
        {"effects": ["seat_leakage"]},
        {"effects": ["stiction", "seat_leakage"]},
        {"max_effects": 0},
    ],
    ids=["below their own chance", "none that slips", "one of two that slip", "no effect wanted"],
)
def test_slips_alone_name_nothing(slipping, less):
    diagnosis = (
        MissingPhysicsFinder(**({"effects": ["stiction", "friction", "seat_leakage"]} | less))
        .fit(slipping)
        .diagnosis_
    )
    assert all("jump" not in entry["parameters"] for entry in diagnosis.content["effects"])


def test_what_moves_the_stem_does_not_stand_beside_its_events():
    """Also where it is no part of the actuator: something in the seat that stops the plug."""
    effects = {e.key: e for e in CATALOGUE}
    found = ("clogging_closing", "friction", "backlash_linkage", "clogging", "flow_meter_bias")
    kept = [key for key in found if beside_events([SimpleNamespace(term=Term(effects[key]))])]
    assert kept == ["clogging", "flow_meter_bias"]
    assert "clogging_closing" not in [e.key for e in effects_to_search(CATALOGUE, "events")]
