# SPDX-License-Identifier: BSD-3-Clause
"""What is known of the valve: by the valve.toml given, by that beside the recording, or by columns alone."""

import re
import sys
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, NamedTuple

from sklvalve.cli.terminal import show

if TYPE_CHECKING:
    from sklvalve.recording import Valve
    from sklvalve.recording.draft import Draft, RecordingColumns

SHEET = "valve.toml"
# what must be told of a valve before anything can be compared: two of these
_COMPARED = ("command", "opening", "flow", "process_value")
# what a sentence speaks of that a valve.toml can mend, and what lies in a cell of the recording instead
_OF_THE_SHEET = re.compile(r"\b(roles?|units?|sense|gauge|name the columns?)\b|\[(recording|fluid|valve)")
_OF_A_CELL = re.compile(r"\brow \d")


class Known(NamedTuple):
    """The valve; what of it nobody said, as findings about the data; what was taken instead of ``--valve``.

    Nothing is assumed where a valve.toml was read; the note is empty where it was given.
    """

    valve: "Valve"
    assumed: list[dict[str, object]]
    note: str


def add_valve_argument(parser) -> None:
    """Declare ``--valve``."""
    parser.add_argument(
        "--valve",
        metavar="VALVE.toml",
        help=f"what is known of the valve (default: {SHEET} beside the recording; without one the columns' "
        "names and values are used, and the report says what was assumed)",
    )


def known_valve(given: str | None, recording: str) -> Known:
    """Read what is known of a valve.

    Parameters
    ----------
    given : str or None
        Path of a valve.toml; None looks for one beside the recording, and else drafts it from the columns.
    recording : str

    Returns
    -------
    known : Known

    Raises
    ------
    InputError
        If the valve.toml cannot be used; or there is none and the columns tell too little, or of two valves.
    """
    from sklvalve.recording import read_valve

    if given is not None:
        return Known(read_valve(given), [], "")
    beside = Path(recording).parent / SHEET
    if beside.is_file():
        note = f"{beside}, found beside the recording, describes the valve; give another with --valve"
        return Known(read_valve(beside), [], note)
    return _drafted(recording)


@contextmanager
def mended_by_a_draft(known: Known, recording: str) -> Iterator[None]:
    """Where there is no valve.toml in which to mend roles, units or the like, say how to come by one."""
    from sklvalve.recording import InputError

    try:
        yield
    except InputError as error:
        told = str(error)
        if not known.assumed or _OF_A_CELL.search(told) or not _OF_THE_SHEET.search(told):
            raise
        raise InputError(f"{error} (there is no {SHEET} yet: {_init(recording)} drafts one)") from None


def tell(known: Known) -> None:
    """Say on standard error what was taken instead of ``--valve``; only once nothing is refused any more."""
    if known.note:
        show(f"note: {known.note}", file=sys.stderr)


def to_fill_in(known: Known, recording: str, *, loop: bool) -> str:
    """What of the data sheet to fill in, and where; empty where it is filled in, or of no use to a loop."""
    if known.assumed:
        return (
            f"Next: {_init(recording)} writes what was assumed into a {SHEET}; correct it, fill in the data "
            "sheet, and run the same command again"
        )
    valve = known.valve
    if loop or valve.kv_rated is not None or valve.characteristic is not None:
        return ""
    return (
        f"Next: fill in the data sheet, kv_rated and characteristic in [valve] of {valve.source}. Without "
        "the data sheet, wear or a leak cannot be told from the trim's shape, nor a loss of capacity detected"
    )


def _drafted(recording: str) -> Known:
    from sklvalve.recording import Valve
    from sklvalve.recording.draft import assumptions, draft_valve, read_recording_columns
    from sklvalve.recording.reader import read_columns

    columns = read_columns(recording).columns
    told = read_recording_columns(columns, recording)
    _require_one_valve(told, recording)
    draft = draft_valve(told)
    valve = Valve.from_dict(tomllib.loads(draft.text), source=SHEET)
    _require_readable(columns, told, recording)
    _require_a_command(draft, valve, recording)
    _require_enough(valve, told, recording)
    note = (
        f"no --valve was given and no {SHEET} found beside the recording, so its columns are read by their "
        f"names: {_taken(draft)}; the report lists all that is assumed, under Data"
    )
    return Known(valve, assumptions(draft), note)


def _require_one_valve(told: "RecordingColumns", recording: str) -> None:
    """One valve among several is not for a program to choose."""
    from sklvalve.recording import InputError

    loops = dict.fromkeys(each.reading.loop for each in told.columns if each.reading.role == "command")
    if len(loops) > 1:
        names = [loop for loop in loops if loop]
        raise InputError(
            f"{recording}: the columns are of several valves ({', '.join(names)}) and no {SHEET} chooses "
            f"one; run {_init(recording)} --tag {quote(names[0])}, then diagnose with the draft"
        )


def _require_readable(columns, told: "RecordingColumns", recording: str) -> None:
    """A cell that is no number must not take a column, by its name the command or the like, off the list."""
    from sklvalve.recording.columns import to_numbers
    from sklvalve.recording.tags import read_name

    for name in told.others:
        role = read_name(name).role
        if role in _COMPARED and not any(each.reading.role == role for each in told.columns):
            to_numbers(columns[name], f"{recording}: column {name!r} ({role})")


def _require_a_command(draft: "Draft", valve: "Valve", recording: str) -> None:
    """A command by its name whose numbers no command has: say so, not that there is none."""
    from sklvalve.recording import InputError

    if "command" in draft.roles and "command" not in valve.roles:
        raise InputError(
            f"{recording}: column {draft.roles['command'].column.shown} is a command by its name, and a "
            "valve's command stays between 0 and 100 %; correct the column, or keep it out by "
            f"{_init(recording)}"
        )


def _require_enough(valve: "Valve", told: "RecordingColumns", recording: str) -> None:
    from sklvalve.recording import InputError

    held = [role for role in _COMPARED if role in valve.roles]
    if len(held) < 2:
        names = ", ".join(repr(column.name) for column in told.columns[:8])
        only = f"only the {held[0]}" if held else "neither command, opening nor flow"
        raise InputError(
            f"{recording}: there is no {SHEET}, and the columns' names ({names}) tell {only}; "
            f"run {_init(recording)}, which asks, and say which column is which"
        )


def _taken(draft: "Draft") -> str:
    from sklvalve.report.words import role_words

    return ", ".join(f"{each.column.name!r} the {role_words(role)}" for role, each in draft.roles.items())


def _init(recording: str) -> str:
    return f"sklvalve init {quote(recording)}"
