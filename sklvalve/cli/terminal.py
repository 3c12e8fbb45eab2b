# SPDX-License-Identifier: BSD-3-Clause
"""What goes to a terminal: how wide it is, and texts that cannot command it."""

import shutil
import sys
from typing import TextIO

_WIDEST = 96  # longer lines are tiring to read


def text_width() -> int:
    """Characters in a line of text: as many as the terminal has, at most 96; 96 in a file or a pipe."""
    if not sys.stdout.isatty():
        return _WIDEST
    return min(shutil.get_terminal_size((_WIDEST, 24)).columns, _WIDEST)


def safe(text: str) -> str:
    r"""Write a text of lines so that nothing in it moves the cursor, changes colours or hides.

    Names of files, columns and tags come from elsewhere, and a terminal obeys what stands in them: such
    letters are written out, as ``\x1b``.
    """
    if text.replace("\n", "").isprintable():
        return text
    from sklvalve.recording.errors import one_line

    return "\n".join(one_line(line) for line in text.split("\n"))


def show(text: str = "", *, file: TextIO | None = None) -> None:
    """Print a text made safe."""
    print(safe(text), file=file)
