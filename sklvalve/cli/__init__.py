# SPDX-License-Identifier: BSD-3-Clause
"""The command ``sklvalve``: a file a command, which imports what it works with only when it is run."""

import sys
from collections.abc import Sequence

__all__ = ["main"]


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command and say how it ended; an interruption while the commands are loaded included.

    Parameters
    ----------
    argv : sequence of str or None, default=None
        Words after ``sklvalve``; None takes them from the command line.

    Returns
    -------
    status : int
        0 it ran, whatever the verdict; 1 a mismatch, only with ``--exit-code``; 2 bad input, a missing extra
        or a fault of the package, with one sentence on standard error; 130 interrupted, 143
        asked to terminate, 129 its terminal gone.

    Notes
    -----
    With the environment variable SKLVALVE_DEBUG set, or Python's development mode, an unexpected error comes
    with its traceback.

    Examples
    --------
    >>> from sklvalve.cli import main
    >>> main(["--version"])
    sklvalve 0.1.0
    0
    """
    try:
        from sklvalve.cli.entry import main as run
    except KeyboardInterrupt:
        sys.stderr.write("interrupted; nothing was written\n")
        return 130
    return run(argv)
