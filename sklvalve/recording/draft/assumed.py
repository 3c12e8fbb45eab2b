# SPDX-License-Identifier: BSD-3-Clause
"""What a draft takes for granted, told as findings about the data."""

from collections.abc import Sequence
from itertools import groupby

from sklvalve.recording._screen_tools import Finding, finding
from sklvalve.recording.draft.drafter import Draft
from sklvalve.recording.draft.sheet import Stated

#: What stands in place of a role where the data sheet is meant.
DATA_SHEET = "data_sheet"


def assumptions(draft: Draft) -> list[Finding]:
    """Say what a recording diagnosed by a draft, not by what a person knows, was taken for.

    Parameters
    ----------
    draft : Draft

    Returns
    -------
    findings : list of dict
        As `screen_recording` gives them, one for each role: ``assumed`` where names and values leave no
        doubt, ``guessed`` where they do, ``left_out`` where they tell nothing; and before them one,
        ``left_out``, for the data sheet, whose role is ``data_sheet``.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.recording.draft import assumptions, draft_valve, read_recording_columns
    >>> course = 50.0 + 30.0 * np.sin(np.arange(200.0) / 9.0)
    >>> columns = {"time": np.arange(200.0), "FIC1.OP": course, "FIC1.PV": 0.2 * course}
    >>> for told in assumptions(draft_valve(read_recording_columns(columns, "recording.csv"))):
    ...     print(told["finding"], told["role"])
    left_out data_sheet
    assumed command
    guessed flow
    """
    told = [_of_sheet([line for line in draft.stated if line.section == "valve"])]
    for section, lines in groupby(draft.stated, key=lambda line: line.section):
        role = section.removeprefix("recording.")
        if role != section:
            told.append(_of_role(role, list(lines)))
    return told


def _of_sheet(lines: Sequence[Stated]) -> Finding:
    missing = [f"{line.key} ({line.doubt})" for line in lines if line.doubt]
    words = "; ".join([*missing, "the fluid is taken for water"])
    return finding("left_out", DATA_SHEET, f"no valve.toml was given: {words}")


def _of_role(role: str, lines: Sequence[Stated]) -> Finding:
    if lines[0].key is None:
        return finding("left_out", role, lines[0].why)
    doubtful = any(line.doubt for line in lines)
    words = "; ".join(_words(line) for line in lines)
    return finding("guessed" if doubtful else "assumed", role, words)


def _words(line: Stated) -> str:
    if line.value is None:
        return f"{line.key}: {line.why}"
    return f"{line.key} {line.value!r} ({line.why})"
