# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve screen``: what is wrong with the data themselves."""

from argparse import Namespace, RawDescriptionHelpFormatter
from typing import TYPE_CHECKING

from sklvalve.cli.as_json import add_json_argument, as_json
from sklvalve.cli.known import add_valve_argument, known_valve, mended_by_a_draft, tell
from sklvalve.cli.terminal import show

if TYPE_CHECKING:
    from sklvalve.recording import Recording

_EXAMPLES = """examples:
  sklvalve screen recording.csv
  sklvalve screen recording.csv --valve fv101.toml --json > findings.json
"""


def add_parser(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "screen",
        help="report what is wrong with the data",
        description="Look for gaps, frozen, clipped, coarse or compressed signals, swapped or mistaken units "
        "and shifted clocks; nothing is changed.",
        epilog=_EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument("recording", metavar="RECORDING", help="a .csv, .csv.gz or .parquet file")
    add_valve_argument(parser)
    add_json_argument(parser, "the findings")
    parser.set_defaults(run=run)


def run(args: Namespace) -> int:
    """Screen a recording."""
    from sklvalve.recording import read_recording, screen_recording

    known = known_valve(args.valve, args.recording)
    with mended_by_a_draft(known, args.recording):
        recording = read_recording(args.recording, known.valve)
    tell(known)
    findings = screen_recording(recording)
    if args.json:
        show(as_json(_content(recording, [*known.assumed, *findings])))
    else:
        _tell(recording, known.assumed, findings)
    return 0


def _content(recording: "Recording", findings: list[dict[str, object]]) -> dict[str, object]:
    return {
        "schema": "sklvalve.screen/1",
        "recording": recording.source,
        "rows": len(recording),
        "first": recording.stamps[0],
        "last": recording.stamps[-1],
        "roles": list(recording),
        "data": findings,
    }


def _tell(
    recording: "Recording", assumed: list[dict[str, object]], findings: list[dict[str, object]]
) -> None:
    from textwrap import fill

    from sklvalve.report.words import role_words

    held = ", ".join(role_words(role) for role in recording)
    first, last = recording.stamps[0], recording.stamps[-1]
    show(fill(f"{recording.source}: {len(recording)} rows from {first} to {last}, holding {held}.", 96))
    for found in [*assumed, *findings]:
        kind, role = str(found["finding"]).replace("_", " "), found["role"]
        signal = role_words(None if role is None else str(role))
        sentence = f"{signal} ({kind}): {found['detail']}{_rows(found['rows'])}."
        show(fill(sentence[:1].upper() + sentence[1:], 96, initial_indent="- ", subsequent_indent="  "))
    if not findings:
        show("Nothing is wrong with the data.")


def _rows(spans: object, limit: int = 3) -> str:
    """Rows of a finding, counted from 1 as a person counts."""
    if not isinstance(spans, list) or not spans:
        return ""
    shown = [
        f"{start + 1} to {stop}" if stop > start + 1 else f"{start + 1}" for start, stop in spans[:limit]
    ]
    more = f" and {len(spans) - limit} more places" if len(spans) > limit else ""
    return f"; row{'s' if len(spans) > 1 or spans[0][1] > spans[0][0] + 1 else ''} {', '.join(shown)}{more}"
