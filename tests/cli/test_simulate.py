# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve simulate``: what it writes, that a diagnosis takes it, and what it refuses."""

import json
import os

import numpy as np
import pytest

from sklvalve.cli import main
from sklvalve.cli.simulate import _EPILOG
from sklvalve.damadics import SCENARIOS, make_damadics, valve_sheet
from sklvalve.recording import Valve, read_recording, read_valve
from tests.cli.refusal import refused

pd = pytest.importorskip("pandas", reason='needs pip install "sklvalve[io]"')

SHORT = ["simulate", "--duration", "60"]


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SKLVALVE_DEBUG", "1")  # a fault of the package fails a test as what it is
    return tmp_path


@pytest.mark.parametrize("name", ["run.csv", "run.csv.gz", "run.parquet"])
def test_the_recording_and_its_sheet_are_written_and_read(here, capsys, name):
    if name.endswith("parquet"):
        pytest.importorskip("pyarrow", reason='needs pip install "sklvalve[io]"')
    assert main([*SHORT, "--seed", "3", "--out", f"new/folder/{name}"]) == 0
    assert sorted(os.listdir("new/folder")) == sorted([name, "valve.toml"])
    assert f"{name} (60 rows, no fault)" in capsys.readouterr().out
    frame = make_damadics(duration=60.0, random_state=3)
    recording = read_recording(f"new/folder/{name}", "new/folder/valve.toml")
    roles = ["command", "opening", "p1", "p2", "temperature", "flow", "simulated_opening"]
    assert list(recording) == roles
    np.testing.assert_allclose(recording["p1"], 1e3 * frame["P1"], rtol=1e-6)
    np.testing.assert_allclose(recording["opening"], 1.0 - 0.01 * frame["X"], atol=1e-6)
    assert read_valve("new/folder/valve.toml") == Valve.from_dict(
        valve_sheet(nominal=True, tag="DAMADICS actuator 3")
    )


def test_one_seed_gives_the_same_bytes(here):
    for folder, seed in (("a", "1"), ("b", "1"), ("c", "2")):
        assert main([*SHORT, "--seed", seed, "--out", f"{folder}/run.csv.gz"]) == 0
    first, again, other = ((here / folder / "run.csv.gz").read_bytes() for folder in "abc")
    assert first == again
    assert first != other


def test_a_fault_of_ones_own(here, capsys):
    words = ["--fault", "f19", "--strength", "-0.5", "--begins", "20"]
    assert main([*SHORT, *words, "--without-noise", "--extended", "--out", "run.csv"]) == 0
    assert "f19, flow sensor fault, of -0.5 from 20 s on, at once" in capsys.readouterr().out
    table = pd.read_csv("run.csv")
    np.testing.assert_array_equal(table["fault"], np.where(table["time"] < 20.0, 0.0, -0.5))
    free = (table["time"] >= 20.0) & (table["F"] < 40.0)
    assert free.any()
    np.testing.assert_allclose(table["F"][free], 1.5 * table["true_F"][free], rtol=1e-6)


def test_a_fault_that_grows_and_a_scenario(here, capsys):
    assert main(["simulate", "--fault", "f4", "--profile", "short", "--begins", "0", "--out", "run.csv"]) == 0
    assert "of 1 from 0 s on, grown in 900 s" in capsys.readouterr().out
    table = pd.read_csv("run.csv")
    np.testing.assert_allclose(table["fault"], np.minimum(table["time"] / 900.0, 1.0), rtol=1e-6)
    assert len(table) == 1500
    assert main(["simulate", "--scenario", "f7_small", "--out", "run.csv"]) == 0
    assert pd.read_csv("run.csv")["fault"].iloc[-1] == 0.25


def test_the_loop_and_the_other_actuators(here):
    assert main([*SHORT, "--loop", "--out", "loop/run.csv"]) == 0
    assert "PV" in pd.read_csv("loop/run.csv").columns
    assert "simulated_opening" not in read_valve("loop/valve.toml").roles
    assert main([*SHORT, "--actuator", "1", "--out", "one/run.csv"]) == 0
    assert read_valve("one/valve.toml").kv_rated == 550.0


def test_the_help_lists_every_scenario():
    listed = {}
    for line in _EPILOG.splitlines():
        sizes, _, faults = line.strip().partition("  ")
        if faults.strip().startswith("f"):
            for size in sizes.removesuffix(" alone").split(", "):
                listed.setdefault(size, []).extend(faults.split())
    assert {f"{fault}_{size}" for size, faults in listed.items() for fault in faults} == set(SCENARIOS)


REFUSED = {
    "no file": (SHORT, "--out"),
    "unknown kind": ([*SHORT, "--out", "run.xls"], "expected a file named .csv, .csv.gz or .parquet"),
    "no name": ([*SHORT, "--out", ""], "expected the name"),
    "unknown scenario": ([*SHORT, "--out", "r.csv", "--scenario", "f1_smal"], "did you mean 'f1_small'?"),
    "unknown fault": ([*SHORT, "--out", "r.csv", "--fault", "f20"], "no such fault; give one of f1 to f19"),
    "too strong": (
        [*SHORT, "--out", "r.csv", "--fault", "f1", "--strength", "1.5"],
        "strength of f1 must lie in [0, 1], got 1.5; change --strength, or leave it out",
    ),
    "wrong sign": (
        [*SHORT, "--out", "r.csv", "--fault", "f1", "--strength", "-0.5"],
        "strength of f1 must lie in [0, 1], got -0.5",
    ),
    "no number": ([*SHORT, "--out", "r.csv", "--fault", "f1", "--strength", "much"], "--strength"),
    "begins before": ([*SHORT, "--out", "r.csv", "--fault", "f1", "--begins", "-1"], "begin at 0 or later"),
    "never begins": ([*SHORT, "--out", "r.csv", "--fault", "f1", "--begins", "inf"], "end after it begins"),
    "no such growth": (
        [*SHORT, "--out", "r.csv", "--fault", "f7", "--profile", "incipient"],
        "no incipient f7; give a speed instead, one of short, medium, long\n",
    ),
    "unknown profile": ([*SHORT, "--out", "r.csv", "--fault", "f1", "--profile", "slow"], "--profile"),
    "strength of nothing": ([*SHORT, "--out", "r.csv", "--strength", "0.5"], "name the fault too"),
    "strength of a scenario": (
        [*SHORT, "--out", "r.csv", "--scenario", "f1_big", "--strength", "0.5"],
        "name the fault too",
    ),
    "both": ([*SHORT, "--out", "r.csv", "--scenario", "f1_big", "--fault", "f1"], "not allowed with"),
    "no duration": (["simulate", "--out", "r.csv", "--duration", "0"], "1 or more"),
    "endless": (["simulate", "--out", "r.csv", "--duration", "inf"], "1 or more"),
    "too short": (["simulate", "--out", "r.csv", "--scenario", "f1_big", *SHORT[1:]], "begins after 900 s"),
    "unknown actuator": ([*SHORT, "--out", "r.csv", "--actuator", "4"], "--actuator"),
    "loop of another": ([*SHORT, "--out", "r.csv", "--loop", "--actuator", "1"], "belongs, or a LevelLoop"),
    "half a second": ([*SHORT, "--out", "r.csv", "--settled", "0.5"], "expected whole seconds, 0 or more"),
    "settled before": ([*SHORT, "--out", "r.csv", "--settled=-1"], "expected whole seconds, 0 or more"),
    "under a file": ([*SHORT, "--out", "file/r.csv"], "is a file"),
    "in place of a folder": ([*SHORT, "--out", "taken.csv"], "no plain file"),
    "another valve's sheet": ([*SHORT, "--out", "other/r.csv"], "describes another valve"),
}


@pytest.mark.parametrize(("arguments", "words"), REFUSED.values(), ids=REFUSED)
def test_what_is_refused_is_told_in_one_sentence_and_leaves_nothing(here, capsys, arguments, words):
    (here / "file").write_text("")
    os.makedirs("taken.csv")
    os.makedirs("other")
    (here / "other" / "valve.toml").write_text('[valve]\ntag = "FV-101"\n')
    refused(arguments, words, capsys)
    assert sorted(os.listdir(here)) == ["file", "other", "taken.csv"]
    assert os.listdir("other") == ["valve.toml"]


def test_an_unwritable_folder(here, capsys, monkeypatch):
    def denied(base):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("sklvalve.cli.staging.make_held", denied)
    assert main([*SHORT, "--out", "run.csv"]) == 2
    assert "cannot be written (Permission denied)" in capsys.readouterr().err
    assert os.listdir(here) == []


def test_nothing_half_written_where_the_disk_is_full(here, capsys, monkeypatch):
    def full(*arguments, **settings):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(pd.DataFrame, "to_csv", full)
    assert main([*SHORT, "--out", "run.csv"]) == 2
    assert "No space left on device" in capsys.readouterr().err
    assert os.listdir(here) == []


def test_without_pandas_the_extra_is_named(here, capsys, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    assert main([*SHORT, "--out", "run.csv"]) == 2
    assert 'pip install "sklvalve[io]"' in capsys.readouterr().err
    assert os.listdir(here) == []


@pytest.mark.slow
def test_a_diagnosis_takes_the_files(here):
    for module in ("jinja2", "matplotlib", "skops"):
        pytest.importorskip(module, reason='needs pip install "sklvalve[all]"')
    assert main(["simulate", "--scenario", "f18_small", "--out", "run.csv"]) == 0
    assert main(["diagnose", "run.csv", "--valve", "valve.toml", "--out", "out"]) == 0
    found = json.loads((here / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    assert found["verdict"] == "named"
    assert found["location"]["onset"] == pytest.approx(900.0, abs=5.0)
    (effect,) = found["effects"]
    # one equation for both: neither may come without the other, and which comes first says nothing
    assert {member["name"] for member in effect["members"]} == {"bypass_open", "seat_leakage"}
    # a quarter of the bypass's 19.75 m3/h
    (size,) = effect["parameters"].values()
    assert size["value"] == pytest.approx(0.25 * 19.75, rel=0.02)
