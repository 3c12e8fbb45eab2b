# SPDX-License-Identifier: BSD-3-Clause
"""The commands with nothing stood in for: from files to a finding, and to predictions."""

import csv
import json
import os

import numpy as np
import pytest

from sklvalve.cli import main
from sklvalve.cli.diagnose import RESULTS
from sklvalve.datasets import make_valve_recording
from sklvalve.datasets.concealed import to_toml

for _module in ("pandas", "jinja2", "matplotlib", "skops"):
    pytest.importorskip(_module, reason='needs pip install "sklvalve[all]"')


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory):
    """Folder of a diagnosed recording of a clogged valve, and of what followed it."""
    folder = tmp_path_factory.mktemp("whole")
    made = make_valve_recording("clogging", 0.5, loop="wide", n_samples=1500, n_later=300, random_state=3)
    made.frame.to_csv(folder / "recording.csv", index=False)
    made.later.to_csv(folder / "later.csv", index=False)
    made.later.drop(columns=["F", "X"]).to_csv(folder / "commands.csv", index=False)
    (folder / "valve.toml").write_text(to_toml(made.valve), encoding="utf-8")
    words = ["diagnose", str(folder / "recording.csv"), "--valve", str(folder / "valve.toml")]
    assert main([*words, "--out", str(folder / "out")]) == 0
    return folder


def _predicted(folder, recording, *options):
    out = folder / "predictions.csv"
    model = str(folder / "out" / "corrected_model.skops")
    words = ["predict", str(folder / recording), "--model", model, "--out", str(out), *options]
    assert main(words) == 0
    with out.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def test_results_are_there_and_name_the_blockage(diagnosed):
    assert sorted(os.listdir(diagnosed / "out")) == sorted(RESULTS)
    found = json.loads((diagnosed / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    assert found["verdict"] == "named"
    assert "clogging" in [member["name"] for effect in found["effects"] for member in effect["members"]]
    page = (diagnosed / "out" / "report.html").read_text(encoding="utf-8")
    assert "clogging that caps the opening" in page
    assert len(page) < 2_000_000


def test_corrected_model_predicts_later_rows_better_than_the_nominal(diagnosed):
    with (diagnosed / "later.csv").open(encoding="utf-8", newline="") as file:
        recorded = np.array([float(row["F"]) for row in csv.DictReader(file)])
    corrected = _predicted(diagnosed, "later.csv")
    nominal = _predicted(diagnosed, "later.csv", "--nominal")
    assert list(corrected) == ["time", "opening", "flow", "flow_from_command"]
    errors = [np.sqrt(np.mean((table["flow"] - recorded) ** 2)) for table in (corrected, nominal)]
    assert errors[0] < 0.5 * errors[1]


def test_prediction_from_the_command_alone_is_the_free_run(diagnosed):
    full, alone = (_predicted(diagnosed, name) for name in ("later.csv", "commands.csv"))
    # the runs may start from different openings (the recorded one where there is one), and forget them but
    # for what friction keeps: a stem stays a little on the side it came from (0.5 % in a healthy valve)
    np.testing.assert_allclose(alone["opening"][150:], full["opening"][150:], atol=0.2)
    np.testing.assert_allclose(alone["flow_from_command"][150:], full["flow_from_command"][150:], rtol=0.01)


def test_without_a_recorded_opening_the_flow_is_that_from_the_command(diagnosed):
    alone = _predicted(diagnosed, "commands.csv")
    np.testing.assert_allclose(alone["flow"], alone["flow_from_command"], rtol=1e-6)
