# SPDX-License-Identifier: BSD-3-Clause
"""Make docs/command_line.md from the parser: every command, its arguments and options, its examples."""

import argparse
import textwrap
from pathlib import Path

from sklvalve.cli.entry import build_parser

TARGET = Path(__file__).with_name("command_line.md")
#: Longest line of the page outside its tables.
WIDTH = 99
HEAD = """# Command line

Reference for users of the command `sklvalve`: every command, argument and option.
`docs/make_command_line.py` generates this page; `sklvalve COMMAND --help` prints the same.

| exit status | meaning |
|---|---|
| 0 | done, whatever was found |
| 1 | only with `diagnose --exit-code`: something is missing, or has changed |
| 2 | bad input or a missing extra; one sentence on standard error says what to do |
| 128 plus a signal's number | interrupted; no half result is left |

Options are not abbreviated. With `SKLVALVE_DEBUG=1` an unexpected error shows its traceback.
"""


def page():
    """The whole page as text."""
    return "\n".join([HEAD, *(_section(name, parser, words) for name, parser, words in commands())])


def commands():
    """Name, parser and one line of help of each command."""
    (several,) = (a for a in build_parser()._actions if isinstance(a, argparse._SubParsersAction))
    words = {choice.dest: choice.help for choice in several._choices_actions}
    return [(name, parser, words[name]) for name, parser in several.choices.items()]


def _section(name, parser, words):
    rows = [_row(parser, action) for action in parser._actions if action.dest != "help"]
    return "\n".join(
        [
            f"## {name}\n",
            f"{textwrap.fill(_sentence(words), WIDTH)}\n",
            f"{textwrap.fill(' '.join(parser.description.split()), WIDTH)}\n",
            "| argument or option | meaning |",
            "|---|---|",
            *rows,
            *(["", f"```text\n{parser.epilog.strip()}\n```"] if parser.epilog else []),
            "",
        ]
    )


def _row(parser, action):
    formatter = parser._get_formatter()
    names = [*action.option_strings] or [action.metavar or action.dest]
    if action.choices is not None:
        names.append(f"{{{','.join(map(str, action.choices))}}}")
    elif action.option_strings and action.nargs != 0:
        names.append(action.metavar)
    many = " ..." if action.nargs == "+" else ""
    needed = " (required)" if action.required and action.option_strings else ""
    meaning = " ".join(formatter._expand_help(action).split())
    return f"| `{' '.join(names)}{many}`{needed} | {meaning.replace('|', chr(92) + '|')} |"


def _sentence(words):
    return f"{words[:1].upper()}{words[1:]}."


if __name__ == "__main__":
    TARGET.write_text(page(), encoding="utf-8")
