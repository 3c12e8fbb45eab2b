# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve simulate --loop``: a recording without a simulated stem, which is found sound where it is."""

import json
import os

import numpy as np
import pytest

from sklvalve.cli import main
from sklvalve.damadics import LevelLoop, make_damadics
from tests.cli.refusal import refused

pd = pytest.importorskip("pandas", reason='needs pip install "sklvalve[io]"')

SHORT = ["simulate", "--duration", "60"]


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SKLVALVE_DEBUG", "1")  # a fault of the package fails a test as what it is
    return tmp_path


def test_a_loop_is_recorded_once_it_has_settled(capsys):
    assert main([*SHORT, "--loop", "--seed", "3", "--out", "run.csv"]) == 0
    assert "(60 rows, begun 300 s after a start from rest, no fault)" in capsys.readouterr().out
    table = pd.read_csv("run.csv")
    known = make_damadics(duration=60.0, settled=300.0, loop=LevelLoop(), random_state=3)
    assert list(table) == list(known)
    np.testing.assert_allclose(table.to_numpy(float), known.to_numpy(float), rtol=1e-6)
    np.testing.assert_array_equal(table["time"], np.arange(60.0))
    assert np.ptp(table["X"]) < 20.0


def test_the_start_from_rest_may_be_kept_and_an_open_loop_keeps_it(capsys):
    assert main([*SHORT, "--loop", "--settled", "0", "--out", "kept/run.csv"]) == 0
    assert main([*SHORT, "--out", "open/run.csv"]) == 0
    assert "begun" not in capsys.readouterr().out
    for name in ("kept", "open"):
        # open, but for the noise
        assert pd.read_csv(f"{name}/run.csv")["X"].iloc[0] < 1.0
    assert main([*SHORT, "--settled", "100", "--out", "later/run.csv"]) == 0
    table = pd.read_csv("later/run.csv")
    assert {"X", "X_nominal"} <= set(table)
    assert table["X"].iloc[0] > 30.0


def test_a_fault_begins_on_the_clock_of_the_recording():
    words = ["--fault", "f18", "--strength", "0.5", "--begins", "20"]
    assert main([*SHORT, *words, "--loop", "--out", "run.csv"]) == 0
    table = pd.read_csv("run.csv")
    np.testing.assert_array_equal(table["fault"], np.where(table["time"] < 20.0, 0.0, 0.5))


def test_both_kinds_of_recordings_in_one_folder_are_refused_as_what_they_are(capsys):
    assert main([*SHORT, "--out", "run/open.csv"]) == 0
    capsys.readouterr()
    words = "describes this valve's recordings of the other kind, --loop or not, and would be replaced"
    refused([*SHORT, "--loop", "--out", "run/loop.csv"], words, capsys)
    assert sorted(os.listdir("run")) == ["open.csv", "valve.toml"]
    refused([*SHORT, "--actuator", "1", "--out", "run/one.csv"], "describes another valve", capsys)


def test_a_fault_that_grows_to_less_than_one_is_told_so(capsys):
    words = ["--fault", "f19", "--strength=-1e-1", "--profile", "short", "--begins", "10"]
    assert main(["simulate", "--duration", "200", *words, "--out", "run.csv"]) == 0
    assert "of -0.1 from 10 s on, grown in 90 s" in capsys.readouterr().out
    assert pd.read_csv("run.csv")["fault"].iloc[-1] == -0.1


def diagnosed(arguments):
    for module in ("jinja2", "matplotlib", "skops"):
        pytest.importorskip(module, reason='needs pip install "sklvalve[all]"')
    assert main(["simulate", "--loop", *arguments, "--out", "run.csv"]) == 0
    assert main(["diagnose", "run.csv", "--valve", "valve.toml", "--out", "out"]) == 0
    with open("out/diagnosis.json", encoding="utf-8") as file:
        return json.load(file)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_sound_loop_is_found_sound(seed):
    assert diagnosed(["--seed", str(seed)])["verdict"] == "no_mismatch"


@pytest.mark.slow
def test_an_open_bypass_within_the_loop_is_among_what_is_named_and_nothing_else_is():
    found = diagnosed(["--scenario", "f18_small"])
    assert found["verdict"] == "named"
    (effect,) = found["effects"]
    assert "bypass_open" in {member["name"] for member in effect["members"]}
