# SPDX-License-Identifier: BSD-3-Clause
"""Effects that come and go are found with their spells, and what lasts is given none."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.cli import main
from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch import CATALOGUE, MissingPhysicsFinder, load_model, save_model
from sklvalve.mismatch.inference.hypothesis import begun, may_come_and_go
from sklvalve.mismatch.search import intermittent
from sklvalve.mismatch.search.intermittent import _SwitchSearch
from sklvalve.mismatch.search.onset import losses_of
from sklvalve.recording import Recording, Valve
from sklvalve.simulation.noise import NoiseModel
from sklvalve.simulation.noise_of_pieces import NoiseOfPieces

EFFECTS = ("flow_meter_gain", "flow_meter_bias", "clogging", "choked_flow")
SPELLS = ((500, 800), (1100, 1450))


def rows_of(episodes):
    rows = np.zeros(1800, dtype=bool)
    for begin, end in episodes:
        rows[int(begin) : int(end)] = True
    return rows


def diagnosed(episodes):
    made = make_valve_recording(n_samples=1800, n_later=300, loop="wide", random_state=5)
    frame = made.frame
    frame["F"] = frame["F"] * np.where(rows_of(episodes), 1.06, 1.0)
    finder = MissingPhysicsFinder(effects=EFFECTS).fit(
        Recording.from_frame(frame, Valve.from_dict(made.valve))
    )
    return finder, finder.diagnosis_.content


@pytest.fixture(scope="module")
def found():
    return diagnosed(SPELLS)


@pytest.mark.slow
def test_spells_are_told(found):
    entry = found[1]["effects"][0]
    assert found[1]["verdict"] == "named"
    assert "flow_meter_gain" in [m["name"] for m in entry["members"]]
    assert entry["onset"] == pytest.approx(500.0, abs=4.0)
    told, true = (rows_of(episodes) for episodes in (entry["spells"], SPELLS))
    assert np.mean(told == true) > 0.9
    # where little flows six percent of it are nothing: the first end is told by the beginning that follows
    assert all(list(spell) in np.round(entry["spells"], -1).tolist() for spell in SPELLS)
    assert entry["parameters"]["gain"]["value"] == pytest.approx(0.06, abs=0.01)


@pytest.mark.slow
def test_the_corrected_simulation_has_them_too(found):
    finder = found[0]
    recording = Recording.from_frame(
        make_valve_recording(n_samples=1800, n_later=0, loop="wide", random_state=5).frame,
        finder.corrected_simulation_.valve_,
    )
    with_, without = (
        s.simulate(recording)["flow"] for s in (finder.corrected_simulation_, finder.nominal_simulation_)
    )
    ratio, acts = with_ / np.maximum(without, 1e-6), rows_of(SPELLS)
    assert np.median(ratio[acts]) - np.median(ratio[~acts]) == pytest.approx(0.06, abs=0.02)


@pytest.mark.slow
def test_a_model_file_keeps_the_spells_and_predict_tells_when_they_begin(found, tmp_path, capsys):
    pytest.importorskip("skops")
    made = make_valve_recording(n_samples=1800, n_later=0, loop="wide", random_state=5)
    recording, model = tmp_path / "recording.csv", tmp_path / "model.skops"
    made.frame.to_csv(recording, index=False)
    save_model(model, found[0])
    assert main(["predict", str(recording), "--model", str(model), "--out", str(tmp_path / "out.csv")]) == 0
    assert "begins later: 500 of these 1800 rows are before it" in capsys.readouterr().out
    loaded, known = load_model(model)["corrected"], found[0].corrected_simulation_
    assert loaded.onsets == known.onsets


@pytest.mark.slow
def test_what_begins_and_stays_has_no_spells():
    entry = diagnosed(((700, 1800),))[1]["effects"][0]
    assert "spells" not in entry
    assert entry["onset"] == pytest.approx(700.0, abs=4.0)


def test_a_rival_acts_when_the_effect_does():
    by_key = {e.key: e for e in CATALOGUE}
    times = (10.0, 20.0, 30.0)
    assert begun(by_key["flow_meter_gain"], times).times == times
    assert begun(by_key["supply_pressure_drop"], times).times == times
    assert begun(by_key["flow_meter_gain"], None).onset is None
    assert not may_come_and_go(by_key["sedimentation"])
    assert may_come_and_go(by_key["stiction"])


@pytest.mark.parametrize("state", [True, False])
def test_what_a_switch_gains_is_the_difference_of_two_whole_losses(state):
    rng, n = np.random.default_rng(3), 700
    left, adds = rng.standard_normal((2, n))
    left[rng.random(n) < 0.1] = np.nan
    noises = [
        NoiseModel(np.full(m, 0.7), rng.choice([1.0, 4.0], m), 3.0, 0.4, 90.0, 0.6) for m in (300, n - 300)
    ]
    noise = NoiseOfPieces([(0, 300), (300, n)], noises)
    search = object.__new__(_SwitchSearch)
    search.noise, search.channels, search.rows = {"flow": noise}, ("flow",), n
    search.adds, search.left = {"flow": adds}, {"flow": left}
    # one window goes on behind the join, one ends with the recording
    rows = np.array([0, 30, 170, 299, 300, 520, 690])
    for row, gain in zip(rows, search._gains(rows, state), strict=True):
        toggled = left + (1.0 if state else -1.0) * np.where(np.arange(n) >= row, adds, 0.0)
        losses = [losses_of(noise, each)[row : row + 150].sum() for each in (left, toggled)]
        assert gain == pytest.approx(losses[0] - losses[1], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("switches", [[], list(range(0, 1700, 100))])
def test_neither_no_spell_at_all_nor_too_many_are_taken(monkeypatch, switches):
    search = SimpleNamespace(toggled=lambda term: np.array(switches, dtype=int))
    monkeypatch.setattr(intermittent, "_SwitchSearch", lambda *args: search)
    model = SimpleNamespace(terms=(None,))
    assert intermittent._with_further_episodes(None, model) is model
