# SPDX-License-Identifier: BSD-3-Clause
"""``import`` and ``init`` alone make of real exports what the reader takes, as plants write them."""

import csv
import gzip
import json

import numpy as np
import pytest

from sklvalve.cli import main
from sklvalve.recording import join_recordings, read_recording, require_diagnosable
from sklvalve.recording.diagnosable import is_loop, require_rows


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder, the current one."""
    pytest.importorskip("pandas", reason='needs pip install "sklvalve[io]"')
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SKLVALVE_DEBUG", "1")
    return tmp_path


def _rows(data_folder, *names):
    path = data_folder.joinpath(*names)
    if not path.is_file():
        pytest.skip(f"needs {'/'.join(names)} among the recordings of SKLVALVE_DATA")
    with gzip.open(path, "rt", encoding="utf-8", newline="") as file:
        return list(csv.reader(file))


def _accepted(recording):
    """What diagnose asks for before it begins."""
    if is_loop(recording):
        require_rows(recording)
    else:
        require_diagnosable(recording)


@pytest.mark.parametrize("name", ["CHEM2", "CHEM23", "PAP2", "PAP7"])
def test_loops_of_the_stiction_data_base(here, data_folder, name):
    rows = _rows(data_folder, "isdb", f"{name}.csv.gz")
    path = data_folder / "isdb" / f"{name}.csv.gz"
    assert main(["import", str(path), "--out", "r.csv"]) == 0
    for given, out in (("r.csv", "valve.toml"), (str(path), "other.toml")):
        assert main(["init", given, "--yes", "--out", out]) == 0
        recording = read_recording(given, out)
        assert set(recording) == {"command", "process_value"}
        assert len(recording) == len(rows) - 1
        np.testing.assert_allclose(recording["command"], [0.01 * float(row[1]) for row in rows[1:]])
        _accepted(recording)


REFINERY = {
    "titles, units and a path": (
        "Refinery: Unit 2111\nReport generated,2024-11-12 08:15:00\nStart time,2024-09-04 21:55:00\n"
        "Interval,10,s\n\n",
        "Timestamp,{0}.OP,{0}.PV,{0}.SP,{0}.MODE,PUMP7.Status\n",
        "dd/mm/yyyy hh:mm:ss,%,m3/h,m3/h,,\n\n",
        "\\\\SRV\\PLANT\\2111FIC40102C",
    ),
    "padded by a spreadsheet": (
        "Refinery,,,,,\nDate,12.11.2024,,,,\n,,,,,\n",
        "Date and time,{0}.OP,{0}.PV,{0}.SP,{0}.MODE,{0}.Status\n",
        "",
        "Plant/Pressure reduction/2111FIC40102C",
    ),
}


@pytest.mark.parametrize(("titles", "names", "units", "tag"), REFINERY.values(), ids=REFINERY)
def test_a_refinery_window_as_a_plant_exports_it(here, data_folder, capsys, titles, names, units, tag):
    header, *rows = _rows(data_folder, "refinery_loops", "loops.csv.gz")
    assert header == ["id", "t", "op", "pv", "sp", "auto"]
    window = [row for row in rows if row[0] == "loop_02"]
    text = titles + "\n" + names.replace("Date and time", "Timestamp").format(tag) + units
    for k, (_, stamp, op, pv, sp, auto) in enumerate(window):
        mode = "AUTO" if auto == "1" else "MAN"
        text += f"{stamp},{op},{'Bad' if k == 30 else pv},{sp},{mode},{int(k % 9 == 0)}\n"
    (here / "export.csv").write_text(text + "-- end of report --\n")
    assert main(["import", "export.csv", "--out", "r.csv"]) == 0
    assert main(["init", "r.csv", "--yes"]) == 0
    assert "Next: sklvalve diagnose r.csv --valve valve.toml" in capsys.readouterr().out
    recording = read_recording("r.csv", "valve.toml")
    assert set(recording) == {"command", "flow", "setpoint"}
    assert len(recording) == len(window) == 751
    np.testing.assert_allclose(recording["command"], [0.01 * float(row[2]) for row in window], rtol=1e-6)
    flow = np.array([float(row[3]) for row in window]) / 3600.0
    missing = np.isnan(recording["flow"])
    assert np.flatnonzero(missing).tolist() == [30]
    np.testing.assert_allclose(recording["flow"][~missing], flow[~missing], rtol=1e-6)
    _accepted(recording)


@pytest.mark.slow
@pytest.mark.parametrize("form", ["as it is", "without names of runs", "counted from nought", "a file each"])
def test_six_runs_of_an_actuator_one_behind_the_other(here, data_folder, capsys, form):
    header, *rows = _rows(data_folder, "belimo_actuator", "campaign_20hz.csv.gz")
    names = list(dict.fromkeys(row[1] for row in rows))[3:9]
    runs = [[row for row in rows if row[1] == name] for name in names]
    kept = [0, *range(6, 12)] if form != "as it is" else [*range(len(header))]
    head = [header[place] for place in kept]
    if form in ("counted from nought", "a file each"):
        head[0] = "time_s"
        for run in runs:
            first = np.datetime64(run[0][0].removesuffix("+00:00"))
            for row in run:
                passed = np.datetime64(row[0].removesuffix("+00:00")) - first
                row[0] = f"{passed / np.timedelta64(1, 's'):.3f}"
    text = ""
    for number, run in enumerate(runs):
        if number == 0 or form == "a file each":
            text += ",".join(head) + "\n"
        text += "".join(",".join(row[place] for place in kept) + "\n" for row in run)
    (here / "export.csv").write_text(text)
    assert main(["import", "export.csv", "--out", "run.csv"]) == 0
    shown = capsys.readouterr().out
    assert "The clock starts again 5 times: 6 runs, each a recording of its own." in shown
    assert len(json.loads((here / "run.import.json").read_text())["runs"]) == 6
    assert main(["init", "run_1.csv", "--yes"]) == 0
    recordings = [read_recording(f"run_{number}.csv", "valve.toml") for number in range(1, 7)]
    for run, recording in zip(runs, recordings, strict=True):
        assert set(recording) == {"command", "opening", "temperature"}
        commands = {float(row[6]) for row in run}
        assert recording["command"].min() == pytest.approx(0.01 * min(commands))
        assert recording["command"].max() == pytest.approx(0.01 * max(commands))
        assert len(recording) == pytest.approx(len(run), rel=0.03)
        _accepted(recording)
    if form in ("counted from nought", "a file each"):
        assert len(join_recordings(recordings).pieces) == 6
