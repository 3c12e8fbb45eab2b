# SPDX-License-Identifier: BSD-3-Clause
"""One real hour of actuator 3: the benchmark's simulator, the diagnosis, and what it is good for.

    python -m benchmarks.damadics.real_hour FILE

FILE is the hour as text with the columns of `COLUMNS`, percent of closing. The simulator runs freely from the
recorded command, pressures and temperature, with nothing fitted; errors are counted past the first half
minute, in which it comes from rest. The finder is then fitted on the first 45 minutes, with what three
engineers might know, and the last 15 show what the corrected simulation gains over the calibrated nominal.
Beside it an LS-SVM on the same rows: position by command and pressure drop, now and before, and flow by
pressures, temperature and position.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.damadics.simulations import LOOKS_BACK, black_box, stem_inputs
from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.damadics import ActuatorSimulator, lublin_sheet, preset, valve_sheet
from sklvalve.damadics.excitation import Recorded
from sklvalve.metrics import rmse
from sklvalve.report import summary_sentence

#: Column of the file -> signal.
COLUMNS = {
    "t_s": "time",
    "LC74_20CV_pct": "CV",
    "P74_00_kPa": "P1",
    "P74_01_kPa": "P2",
    "T74_00_degC": "T1",
    "LC74_20X_pct": "X",
    "F74_00_tph": "F",
}
_RESTS, _FITTED = 30, 2700


def read_hour(file):
    """The hour as `make_damadics` has a recording."""
    return pd.read_csv(file)[list(COLUMNS)].rename(columns=COLUMNS).astype(float)


def free_run(hour):
    """Stem [% of closing] and flow [t/h] of the benchmark's simulator under what was recorded."""
    drivers = {"CV": 1e-2 * hour["CV"], "P1": 1e3 * hour["P1"], "P2": 1e3 * hour["P2"], "T1": hour["T1"]}
    excitation = Recorded(hour["time"].to_numpy(), {name: v.to_numpy() for name, v in drivers.items()})
    run = ActuatorSimulator(preset(3), noise=False).simulate(float(len(hour)), excitation)
    return 100.0 * run["X"], run["F_tph"]


def sheets():
    """What each of three engineers knows: the plant's sheet, the benchmark's, and its simulator as well."""
    known = {
        "plant's data sheet": lublin_sheet(3),
        "benchmark's constants": valve_sheet(),
        "benchmark's simulator for the stem": valve_sheet(nominal=True),
    }
    for sheet in known.values():
        sheet["recording"]["flow"]["column"] = "F"
    return known


def gains(hour, sheet):
    """What a diagnosis of the first 45 minutes says, and rms errors on the last 15.

    Returns
    -------
    sentence : str
    errors : list of tuple
        ``(signal, unit, nominal, corrected)``.
    """
    recording = Recording.from_frame(hour, Valve.from_dict(sheet))
    finder = MissingPhysicsFinder(n_jobs=1).fit(recording, until=_FITTED)
    errors = []
    for signal, recorded, unit, factor in (
        ("opening", "opening", "%", 100.0),
        ("flow", "flow", "t/h", 3.6),
        ("flow_from_command", "flow", "t/h", 3.6),
    ):
        made = [
            s.simulate(recording)[signal] for s in (finder.nominal_simulation_, finder.corrected_simulation_)
        ]
        late = recording[recorded][_FITTED:]
        errors.append((signal, unit, *(factor * rmse(late, values[_FITTED:]) for values in made)))
    return summary_sentence(finder.diagnosis_.to_dict()), errors


def black_boxes(hour):
    """Rms errors of LS-SVMs of the first 45 minutes on the last 15, position [%] and flow [t/h]."""
    recording = Recording.from_frame(hour, Valve.from_dict(sheets()["plant's data sheet"]))
    at_once = np.column_stack([recording[role] for role in ("p1", "p2", "temperature", "opening")])
    errors = []
    for inputs, role, factor in (
        (stem_inputs(recording), "opening", 100.0),
        (at_once, "flow", 3.6),
    ):
        first, late = slice(LOOKS_BACK, _FITTED), slice(_FITTED, None)
        model = black_box(inputs[first], recording[role][first])
        errors.append(factor * rmse(recording[role][late], model.predict(inputs[late])))
    return tuple(errors)


def main(file):
    """Print the tables."""
    hour = read_hour(file)
    stem, flow = free_run(hour)
    late = slice(_RESTS, None)
    print(
        f"free run of the benchmark's simulator: X rmse {rmse(hour['X'][late], stem[late]):.3f} %, "
        f"F rmse {rmse(hour['F'][late], flow[late]):.3f} t/h"
    )
    position, of_flow = black_boxes(hour)
    print(f"LS-SVM, on the last 15 minutes: X rmse {position:.3f} %, F rmse {of_flow:.3f} t/h")
    hour["X_nominal"] = stem
    print("| known | signal | calibrated nominal | corrected | cut by |")
    print("|---|---|---|---|---|")
    said = {}
    for known, sheet in sheets().items():
        said[known], errors = gains(hour, sheet)
        for signal, unit, nominal, corrected in errors:
            cut = f"{1.0 - corrected / nominal:.0%}"
            print(f"| {known} | {signal} [{unit}] | {nominal:.2f} | {corrected:.2f} | {cut} |", flush=True)
    for known, sentence in said.items():
        print(f"{known}: {sentence}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    if not Path(sys.argv[1]).is_file():
        sys.exit(f"Expected the file of the hour, got {sys.argv[1]!r}, which is not there; name one that is.")
    main(sys.argv[1])
