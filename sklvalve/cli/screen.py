# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve screen``: what is wrong with the data themselves."""

from argparse import Namespace


def add_parser(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "screen",
        help="say what is wrong with the data themselves",
        description="Look for gaps, frozen, clipped, coarse or compressed signals, swapped or mistaken units "
        "and shifted clocks; nothing is changed.",
    )
    parser.add_argument("recording", metavar="RECORDING", help="a .csv, .csv.gz or .parquet file")
    parser.add_argument("--valve", required=True, metavar="VALVE.toml", help="what is known of the valve")
    parser.set_defaults(run=run)


def run(args: Namespace) -> int:
    """Screen a recording."""
    from textwrap import fill

    from sklvalve.recording import read_recording, screen_recording
    from sklvalve.report.words import role_words

    recording = read_recording(args.recording, args.valve)
    findings = screen_recording(recording)
    held = ", ".join(role_words(role) for role in recording)
    first, last = recording.stamps[0], recording.stamps[-1]
    print(fill(f"{args.recording}: {len(recording)} rows from {first} to {last}, holding {held}.", 96))
    if not findings:
        print("Nothing is wrong with the data.")
    for found in findings:
        kind, role = str(found["finding"]).replace("_", " "), found["role"]
        signal = role_words(None if role is None else str(role))
        sentence = f"{signal} ({kind}): {found['detail']}{_rows(found['rows'])}."
        print(fill(sentence[:1].upper() + sentence[1:], 96, initial_indent="- ", subsequent_indent="  "))
    return 0


def _rows(spans: object, limit: int = 3) -> str:
    """Rows of a finding, counted from 1 as a person counts."""
    if not isinstance(spans, list) or not spans:
        return ""
    shown = [
        f"{start + 1} to {stop}" if stop > start + 1 else f"{start + 1}" for start, stop in spans[:limit]
    ]
    more = f" and {len(spans) - limit} more places" if len(spans) > limit else ""
    return f"; row{'s' if len(spans) > 1 or spans[0][1] > spans[0][0] + 1 else ''} {', '.join(shown)}{more}"
