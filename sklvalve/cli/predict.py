# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve predict``: opening and flow of a recording by a corrected model."""

import csv
import math
from argparse import Namespace, RawDescriptionHelpFormatter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from sklvalve.cli.as_json import add_json_argument, as_json
from sklvalve.cli.terminal import show

if TYPE_CHECKING:
    from sklvalve.recording import Recording, Valve

# predicted column -> role whose form it takes
_COLUMNS = {"opening": "opening", "flow": "flow", "flow_from_command": "flow"}
# what the flow through a valve cannot be known without; other columns may be missing from the file
_NEEDED = ("p1", "p2", "temperature", "simulated_flow", "simulated_opening")
_EXAMPLES = """examples:
  sklvalve predict later.csv --model results/corrected_model.skops --out predictions.csv
  sklvalve predict later.csv --model results/corrected_model.skops --out before.csv --nominal
"""


def add_parser(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "predict",
        help="predict opening and flow with a corrected model",
        description="Write time, opening (free run from the command), flow (from the recorded opening; from "
        "the command where none was recorded) and flow_from_command, in the recording's own units. Where the "
        "recording holds the flow, RMSE, MAPE and Err_max of the predicted one are printed.",
        epilog=_EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument("recording", metavar="RECORDING", help="a .csv, .csv.gz or .parquet file")
    parser.add_argument(
        "--model", required=True, metavar="MODEL.skops", help="corrected_model.skops of a diagnosis"
    )
    parser.add_argument("--out", required=True, metavar="FILE.csv", help="file for the predictions")
    parser.add_argument("--nominal", action="store_true", help="predict without the effects that were found")
    add_json_argument(parser, "what was written, and the error,")
    parser.set_defaults(run=run)


def run(args: Namespace) -> int:
    """Predict a recording."""
    from sklvalve.cli.staging import Staging
    from sklvalve.mismatch import load_model
    from sklvalve.recording import InputError

    out = _target(args)
    if Path(args.model).is_dir():
        raise InputError(f"{args.model}: this is a folder; give the corrected_model.skops of a diagnosis")
    if not Path(args.model).exists():
        raise InputError(f"{args.model}: no such file; give the corrected_model.skops of a diagnosis")
    model = load_model(args.model)
    if not isinstance(model, dict):
        raise InputError(
            f"{args.model}: this holds a {type(model).__name__} and no diagnosis; give the "
            "corrected_model.skops of a diagnosis"
        )
    valve = model["corrected"].valve
    recording = read_for_prediction(args.recording, valve)
    predicted = model["nominal" if args.nominal else "corrected"].simulate(recording)
    columns = {
        name: recording.in_recorded_units(role, predicted[name])
        for name, role in _COLUMNS.items()
        if predicted.get(name) is not None
    }
    if not columns:
        raise InputError(
            f"{args.recording}: its signals ({', '.join(recording.signals)}) allow no prediction; "
            "give at least the command, or the opening with both pressures"
        )
    with Staging(out.parent, [out.name], called=f"--out {out.name} in") as staging:
        with staging.path(out.name).open("w", encoding="utf-8", newline="") as file:
            write_table(file, recording.stamps, columns)
        staging.commit()
    notes = [] if args.nominal else _not_yet(model["corrected"], recording)
    error = error_of(recording, predicted)
    if args.json:
        told = {"written": str(out), "rows": len(recording), "columns": ["time", *columns], "notes": notes}
        show(as_json({"schema": "sklvalve.predict/1"} | told | {"error": error}))
    else:
        lines = [f"Written: {out} ({len(recording)} rows of time, {', '.join(columns)})"]
        show("\n".join([*lines, *_error_words(error), *notes]))
    return 0


def error_of(recording: "Recording", predicted: dict) -> dict | None:
    """Errors of the predicted flow against the recorded one, in recorded units; None without either."""
    import numpy as np

    from sklvalve.metrics import err_max, mape, rmse
    from sklvalve.simulation.calibration import span_of

    if "flow" not in recording or predicted.get("flow") is None:
        return None
    recorded, made = (recording.in_recorded_units("flow", v) for v in (recording["flow"], predicted["flow"]))
    rows = np.isfinite(recorded) & np.isfinite(made)
    if not rows.any():
        return None
    recorded, made = recorded[rows], made[rows]
    span = span_of(recorded)
    error = {
        "rows": len(recorded),
        "unit": recording.unit("flow"),
        "rmse": rmse(recorded, made),
        "span": span,
    }
    if span > 0.0:
        # a flow that is nothing in all rows has no percentages
        error |= {"mape": mape(recorded, made), "err_max": err_max(recorded, made)}
        error["of_span"] = {
            "rmse": rmse(recorded, made, span=span),
            "mape": mape(recorded, made, span=span),
            "err_max": err_max(recorded, made, span=span),
        }
    return error


def _error_words(error: dict | None) -> list[str]:
    if error is None:
        return []
    words = f"Against the recorded flow ({error['rows']} rows): RMSE {error['rmse']:.3g} {error['unit']}"
    if "of_span" not in error:
        return [f"{words}."]
    of_span = error["of_span"]
    return [
        f"{words}, MAPE {error['mape']:.3g} %, Err_max {error['err_max']:.3g} % of the recorded value; "
        f"{of_span['rmse']:.3g} %, {of_span['mape']:.3g} %, {of_span['err_max']:.3g} % of the span of "
        f"{error['span']:.3g} {error['unit']}."
    ]


def _not_yet(simulation, recording: "Recording") -> list[str]:
    """Effects that begin after some of the rows: a clock that begins anew must not go unnoticed."""
    import numpy as np

    from sklvalve.report.words import spoken
    from sklvalve.simulation.chain import clock_of

    onsets = getattr(simulation, "onsets", None) or {}
    names = {effect.key: effect.name for effect in simulation.effects} if onsets else {}
    clock = clock_of(recording)
    # the first of its times, where it comes and goes
    before = {names[key]: int((clock < np.min(times)).sum()) for key, times in onsets.items()}
    return [
        f"{_begun(spoken(name))} begins later: {many} of these {len(clock)} rows are before it, by the "
        "clock of the diagnosed recording."
        for name, many in before.items()
        if many
    ]


def _begun(words: str) -> str:
    return words[:1].upper() + words[1:]


def read_for_prediction(path: str, valve: "Valve") -> "Recording":
    """Read a recording of a known valve, from which columns may be missing that the model can do without.

    Raises
    ------
    InputError
        If the file cannot be read, lacks pressures or temperature, or both command and opening, or holds
        values of which only nonsense can be predicted.
    """
    from sklvalve.recording import read_recording
    from sklvalve.recording.diagnosable import require_predictable
    from sklvalve.recording.reader import read_columns

    columns = read_columns(path).columns
    present = {
        role: signal
        for role, signal in valve.roles.items()
        if role in _NEEDED or signal.column is None or _holds_something(columns.get(signal.column))
    }
    if not {"command", "opening"} & present.keys():
        present = {role: signal for role, signal in valve.roles.items() if role in {*present, "command"}}
    recording = read_recording(path, replace(valve, roles=present))
    require_predictable(recording)
    # units of what is predicted are the valve's own, also of a role that this file lacks
    by_mass = any(valve.roles[role].mass_flow for role in ("flow", "simulated_flow") if role in valve.roles)
    return replace(recording, valve=valve, mass_flow=by_mass)


def write_table(file: TextIO, stamps, columns: dict) -> None:
    """Write times as recorded and numbers of seven digits; a gap is an empty cell."""
    from sklvalve.recording.spreadsheet import marked

    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["time", *map(marked, columns)])
    for row, stamp in enumerate(stamps):
        time = marked(stamp) if isinstance(stamp, str) else f"{stamp:.15g}"
        writer.writerow([time, *(_cell(values[row]) for values in columns.values())])


def _cell(value: float) -> str:
    return f"{value:.7g}" if math.isfinite(value) else ""


def _holds_something(column) -> bool:
    from sklvalve.recording.columns import is_gap

    return column is not None and not all(is_gap(item) for item in column.tolist())


def _target(args: Namespace) -> Path:
    """Path of the predictions, refused where it would be misleading or overwrite an input."""
    from sklvalve.recording import InputError

    out = Path(args.out)
    if out.suffix != ".csv":
        raise InputError(f"--out {out}: predictions are written as plain CSV; name the file .csv")
    for given in (args.recording, args.model):
        if out.exists() and Path(given).exists() and out.samefile(given):
            raise InputError(f"--out {out}: this is an input of the same command; name another file")
    return out
