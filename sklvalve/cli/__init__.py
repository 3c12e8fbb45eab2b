# SPDX-License-Identifier: BSD-3-Clause
"""The command ``sklvalve``: a file a command, which imports what it works with only when it is run."""

from sklvalve.cli.entry import main

__all__ = ["main"]
