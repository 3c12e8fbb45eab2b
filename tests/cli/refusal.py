# SPDX-License-Identifier: BSD-3-Clause
"""What every refusal of the command line must look like."""

import os

from sklvalve.cli import main


def refused(arguments, words, capsys):
    """Exit status 2, one sentence on standard error that holds the words, nothing written where we are."""
    before = sorted(os.listdir("."))
    assert main(arguments) == 2
    shown = capsys.readouterr()
    assert words in shown.err
    assert shown.err.startswith("sklvalve: ")
    assert shown.err.count("\n") == 1
    assert shown.out == ""
    assert sorted(os.listdir(".")) == before
