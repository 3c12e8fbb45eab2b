# SPDX-License-Identifier: BSD-3-Clause
"""How wide the terminal is that a text goes to."""

import shutil
import sys

_WIDEST = 96  # longer lines are tiring to read


def text_width() -> int:
    """Characters in a line of text: as many as the terminal has, at most 96; 96 in a file or a pipe."""
    if not sys.stdout.isatty():
        return _WIDEST
    return min(shutil.get_terminal_size((_WIDEST, 24)).columns, _WIDEST)
