# SPDX-License-Identifier: BSD-3-Clause
"""A parser whose complaints are one sentence, and the types of arguments."""

import math
from argparse import ArgumentParser, ArgumentTypeError
from typing import NoReturn


class UsageError(Exception):
    """Words on the command line that make no command."""


class Parser(ArgumentParser):
    """Parser that raises instead of printing its usage and leaving; abbreviations are not guessed."""

    def __init__(self, **settings) -> None:
        super().__init__(**{"allow_abbrev": False} | settings)

    def error(self, message: str) -> NoReturn:
        """Raise the complaint, with where to read more."""
        raise UsageError(f"{message}; see {self.prog} --help")


def seed(text: str) -> int:
    """Random seed: a whole number that NumPy takes."""
    try:
        value = int(text)
    except ValueError:
        value = -1
    if not 0 <= value < 2**32:
        raise ArgumentTypeError(f"expected a whole number from 0 to 4294967295; got {text!r}")
    return value


def seconds(text: str) -> float:
    """Duration in seconds, at least one."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1.0 <= value < math.inf:
        raise ArgumentTypeError(f"expected a number of seconds, 1 or more; got {text!r}")
    return value


def folder(text: str) -> str:
    """Name of a folder; an empty one, as from a variable never set, would mean the current folder."""
    if not text.strip():
        raise ArgumentTypeError(f"expected the name of a folder, . for the current one; got {text!r}")
    return text


def column_name(text: str) -> str:
    """Name of a column; an empty one, as from a variable never set, names none."""
    if not text.strip():
        raise ArgumentTypeError(f"expected the name of a column; got {text!r}")
    return text
