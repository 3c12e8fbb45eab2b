# SPDX-License-Identifier: BSD-3-Clause
"""Texts in a CSV that a spreadsheet would take for formulas: marked on writing, and freed on reading."""

import re

# a mark may stand before a mark, so that every text comes back as it was
_FORMULA = re.compile(r"'*[=+\-@\t\r]")
_MARKED = re.compile(r"'+[=+\-@\t\r]")


def marked(text: str) -> str:
    """A text with an apostrophe before it where a spreadsheet would compute it.

    Examples
    --------
    >>> from sklvalve.recording.spreadsheet import freed, marked
    >>> marked("=1+1"), marked("FIC101.PV"), freed(marked("'=1+1"))
    ("'=1+1", 'FIC101.PV', "'=1+1")
    """
    return f"'{text}" if _FORMULA.match(text) else text


def freed(text: str) -> str:
    """The text that `marked` was given."""
    return text[1:] if _MARKED.match(text) else text
