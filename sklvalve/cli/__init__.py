# SPDX-License-Identifier: BSD-3-Clause
"""The command ``sklvalve``: a file a command, each loaded only when it is asked for."""

from sklvalve.cli.entry import main

__all__ = ["main"]
