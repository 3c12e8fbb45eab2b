# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve diagnose``: what a simulation leaves out, as JSON, a report and a corrected model."""

from argparse import Namespace, RawDescriptionHelpFormatter
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from sklvalve.cli.as_json import add_json_argument, as_json
from sklvalve.cli.history_files import (
    add_allow_argument,
    add_history_argument,
    learnt_history,
    read_history,
    require_history,
)
from sklvalve.cli.known import add_valve_argument, known_valve, mended_by_a_draft, tell, to_fill_in
from sklvalve.cli.parser import folder, seed
from sklvalve.cli.terminal import show, text_width

if TYPE_CHECKING:
    from sklvalve.cli.staging import Staging
    from sklvalve.history import ValveHistory
    from sklvalve.mismatch import Diagnosis, MissingPhysicsFinder
    from sklvalve.recording import Recording

RESULTS = ("diagnosis.json", "report.html", "corrected_model.skops")
_EXTRAS = {"jinja2": "report", "matplotlib": "report", "skops": "skops"}
_NO_MODEL = (
    "No corrected_model.skops: with only a command and a value recorded there is no simulation of the valve "
    "to correct."
)
_EXAMPLES = """examples:
  sklvalve diagnose recording.csv
  sklvalve diagnose recording.csv --valve fv101.toml --out results
  sklvalve diagnose recording.csv --until 2024-06-28T12:00:00
  sklvalve diagnose march.csv --valve fv101.toml --history january.csv february.csv
  sklvalve diagnose monday.csv tuesday.csv --valve fv101.toml --json > found.json
"""


def add_parser(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "diagnose",
        help="find out which physics the simulation of a valve leaves out",
        description="Compare a recording with the valve's simulation, name what the simulation leaves out, "
        "and write diagnosis.json, report.html and corrected_model.skops.",
        epilog=_EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "recording",
        metavar="RECORDING",
        nargs="+",
        help="a .csv, .csv.gz or .parquet file; several of one valve are diagnosed together",
    )
    add_valve_argument(parser)
    add_history_argument(parser)
    add_allow_argument(parser)
    parser.add_argument(
        "--out",
        type=folder,
        default="results",
        metavar="DIR",
        help="folder for the results (default: %(default)s)",
    )
    parser.add_argument(
        "--until",
        metavar="TIME",
        help="in the recording's own time (of several, the last one's): rows after it are kept for the final "
        "figures, which no step has used",
    )
    parser.add_argument("--seed", type=seed, default=0, metavar="N", help="of the random draws (default: 0)")
    parser.add_argument(
        "--exit-code",
        action="store_true",
        help="end with status 1 unless the verdict is no_mismatch and nothing that --history had has changed",
    )
    add_json_argument(parser, "diagnosis.json")
    parser.set_defaults(run=run)


def run(args: Namespace) -> int:
    """Diagnose a recording."""
    from sklvalve._telling import changed_before
    from sklvalve.cli.staging import Staging
    from sklvalve.mismatch.loop import is_loop, loop_signals
    from sklvalve.recording import join_recordings, read_recording, require_diagnosable
    from sklvalve.report import to_text

    require_extras()
    first = args.recording[0]
    known = known_valve(args.valve, first)
    with mended_by_a_draft(known, first):
        read = [read_recording(path, known.valve) for path in args.recording]
    recording = join_recordings(read)
    rows = _rows_until(recording, args.until)
    used = recording.slice(0, rows)
    loop = is_loop(used)
    with mended_by_a_draft(known, first):
        if loop:
            loop_signals(used)
        else:
            require_diagnosable(used)
        history = read_history(args.history, known.valve, args.allow)
        require_history(history, used)
    with Staging(args.out, RESULTS) as staging:
        tell(known)
        finder = diagnose(
            recording,
            staging,
            until=rows,
            seed=args.seed,
            assumed=known.assumed,
            history=history,
            allowed=args.allow,
        )
        written = staging.commit()
    found = finder.diagnosis_.to_dict()
    if args.json:
        show(as_json(found))
    else:
        show(to_text(found, width=text_width()))
        show(f"\nWritten: {', '.join(str(path) for path in written)}")
        if loop:
            show(_NO_MODEL)
        if hint := to_fill_in(known, first, loop=loop):
            show(hint)
    return int(args.exit_code and (found["verdict"] != "no_mismatch" or bool(changed_before(found))))


def diagnose(
    recording: "Recording",
    staging: "Staging",
    *,
    until: int | None,
    seed: int,
    assumed: Sequence[dict[str, object]] = (),
    history: "ValveHistory | list[Recording] | None" = None,
    allowed: Sequence[tuple[str, float]] = (),
) -> "MissingPhysicsFinder":
    """Diagnose a recording and lay the results down in a staging folder; a loop has no corrected model.

    What was `assumed` of the valve goes before the findings about the data. With a `history` the diagnosis
    tells what has changed since, beyond what is `allowed`.
    """
    from threadpoolctl import threadpool_limits

    from sklvalve.cli.progress import progress
    from sklvalve.mismatch import MissingPhysicsFinder, save_model
    from sklvalve.report import write_report

    # thousands of fits of small matrices: on a busy machine the threads of BLAS wait for each other, and the
    # same work took three to ten times as long with two of them as with one
    with progress() as callback, threadpool_limits(1, user_api="blas"):
        learner = MissingPhysicsFinder(random_state=seed, callback=callback)
        known = learnt_history(history, learner, allowed)
        finder = MissingPhysicsFinder(random_state=seed, callback=callback, history=known)
        finder.fit(recording, until=until)
        if assumed:
            finder.diagnosis_ = _with_assumed(finder.diagnosis_, assumed)
        files = [piece.source for piece in recording.pieces] or [recording.source]
        tag, source = recording.valve.tag, ", ".join(Path(file).name for file in files)
        write_report(staging.path("report.html"), finder.diagnosis_, title=tag, source=source)
        if hasattr(finder, "corrected_simulation_"):
            save_model(staging.path("corrected_model.skops"), finder)
        else:
            staging.drop("corrected_model.skops")
        text = as_json(finder.diagnosis_.to_dict())
        staging.path("diagnosis.json").write_text(text + "\n", encoding="utf-8")
    return finder


def _with_assumed(diagnosis: "Diagnosis", assumed: Sequence[dict[str, object]]) -> "Diagnosis":
    from sklvalve.mismatch import Diagnosis

    content = diagnosis.to_dict()
    told = [{key: each[key] for key in ("finding", "role", "detail")} for each in assumed]
    return Diagnosis(content | {"data": told + content.get("data", [])}, diagnosis.traces)


def require_extras() -> None:
    """Say what is not installed before the work instead of after it.

    Raises
    ------
    ImportError
        Naming the extra.
    """
    for module, extra in _EXTRAS.items():
        try:
            import_module(module)
        except ImportError:
            raise ImportError(
                f'the results of a diagnosis need {module}: pip install "sklvalve[{extra}]"'
            ) from None


def _rows_until(recording: "Recording", time: str | None) -> int | None:
    """Rows that serve for finding; both sides of the time must hold some, and the first side enough."""
    from sklvalve.recording import InputError
    from sklvalve.recording.diagnosable import FEWEST_ROWS

    if time is None:
        return None
    recording.after(time)
    rows = len(recording.until(time))
    if rows < FEWEST_ROWS < len(recording):
        stand = "stands" if rows == 1 else "stand"
        enough = recording.stamps[FEWEST_ROWS - 1]
        raise InputError(
            f"--until {time}: only {rows} of {len(recording)} rows of {recording.source} {stand} at or "
            f"before it, too few to find anything in; give {enough} or a later time"
        )
    return rows
