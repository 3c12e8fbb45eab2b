# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve init``: a draft valve.toml from the columns of a recording, and by asking."""

import sys
from argparse import Namespace, RawDescriptionHelpFormatter
from pathlib import Path
from typing import TYPE_CHECKING

from sklvalve.cli.as_json import add_json_argument, as_json
from sklvalve.cli.known import SHEET
from sklvalve.cli.parser import column_name
from sklvalve.cli.terminal import show

if TYPE_CHECKING:
    from sklvalve.recording.draft import Draft, RecordingColumns

_EXAMPLES = """examples:
  sklvalve init recording.csv
  sklvalve init recording.csv --tag FIC101 --out fv101.toml
"""


def add_parser(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "init",
        help="draft the valve.toml of a recording",
        description="Guess from names and values which column is which signal, in which unit and sense; ask "
        "what stays open, on a terminal; and write a valve.toml that says why each line is there.",
        epilog=_EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument("recording", metavar="RECORDING", help="a .csv, .csv.gz or .parquet file")
    parser.add_argument(
        "--out", metavar="VALVE.toml", help=f"the draft (default: {SHEET} beside the recording)"
    )
    parser.add_argument(
        "--tag", metavar="TAG", help="of the valve; needed where the recording holds several valves"
    )
    parser.add_argument(
        "--time-column", type=column_name, metavar="NAME", help="column of the times (default: detected)"
    )
    parser.add_argument("--yes", action="store_true", help="ask nothing, take what is likeliest")
    parser.add_argument(
        "--force", action="store_true", help="replace a draft, or a valve.toml, that is there"
    )
    add_json_argument(parser, "the roles and what is to be filled in")
    parser.set_defaults(run=run)


def run(args: Namespace) -> int:
    """Draft a valve.toml."""
    from sklvalve.cli.asking import ask
    from sklvalve.cli.staging import Staging
    from sklvalve.recording.draft import Answers, draft_valve, read_recording_columns
    from sklvalve.recording.reader import read_columns

    out = _target(args)
    told = read_recording_columns(read_columns(args.recording).columns, args.recording, args.time_column)
    _require_tag(args.tag, told)
    answers = Answers(tag=args.tag)
    # what is asked stands on standard output, where --json leaves room for nothing else
    if not (args.yes or args.json) and sys.stdin.isatty() and sys.stdout.isatty():
        answers = ask(told, answers)
    draft = draft_valve(told, answers)
    refusal = _refusal(draft, args.recording, out)
    with Staging(
        out.parent, [out.name], called=f"--out {out.name} in", guard=lambda: _target(args)
    ) as staging:
        staging.path(out.name).write_text(draft.text, encoding="utf-8")
        staging.commit()
    if args.json:
        show(as_json(_content(draft, out, refusal)))
    else:
        _tell(draft, args.recording, out, refusal)
    return 0


def _target(args: Namespace) -> Path:
    """Path of the draft, refused where a file stands there already."""
    from sklvalve.recording import InputError

    out = Path(args.recording).parent / SHEET if args.out is None else Path(args.out)
    if out.suffix != ".toml":
        raise InputError(f"--out {out}: the draft is TOML; name the file .toml")
    if out.exists() and not args.force:
        raise InputError(
            f"{out}: it exists already and may hold what you know; name another with --out, or replace it "
            "with --force"
        )
    return out


def _require_tag(tag: str | None, told: "RecordingColumns") -> None:
    from sklvalve.recording import InputError

    if tag is None or any(tag.casefold() in column.name.casefold() for column in told.columns):
        return
    loops = dict.fromkeys(column.reading.loop for column in told.columns if column.reading.loop)
    known = f" such as {', '.join(loops)}" if loops else ""
    raise InputError(
        f"--tag {tag}: no column of {told.source} has it in its name; give a part of the names{known}, or "
        "leave it out"
    )


def _refusal(draft: "Draft", recording: str, out: Path) -> str | None:
    """Why the recording could not be diagnosed with this draft; None where it could."""
    import tomllib

    from sklvalve.recording import InputError, Valve, read_recording, require_diagnosable
    from sklvalve.recording.diagnosable import is_loop

    try:
        read = read_recording(recording, Valve.from_dict(tomllib.loads(draft.text), source=str(out)))
        if not is_loop(read):
            require_diagnosable(read)
    except InputError as error:
        return str(error)
    return None


def _content(draft: "Draft", out: Path, refusal: str | None) -> dict[str, object]:
    return {
        "schema": "sklvalve.init/1",
        "written": str(out),
        "roles": {
            role: {"column": each.column.name, "why": each.why, "sure": each.sure}
            for role, each in draft.roles.items()
        },
        "to_fill_in": list(draft.to_fill_in),
        "not_enough": refusal,
    }


def _tell(draft: "Draft", recording: str, out: Path, refusal: str | None) -> None:
    width = max((len(role) for role in draft.roles), default=0)
    for role, assignment in draft.roles.items():
        doubt = "" if assignment.sure else "  (not sure)"
        show(f"{role:<{width}}  {assignment.column.shown}: {assignment.why}{doubt}")
    if draft.to_fill_in:
        show("\nTo fill in, or to check:")
        for item in draft.to_fill_in:
            show(f"- {item}")
    show(f"\nWritten: {out}")
    if refusal is not None:
        show(f"Not yet enough for a diagnosis: {refusal}")
    later = "Then" if refusal is not None else "Next"
    show(f"{later}: sklvalve diagnose {_quoted(recording)} --valve {_quoted(str(out))} --out results")


def _quoted(path: str) -> str:
    from shlex import quote

    return quote(path)
