# SPDX-License-Identifier: BSD-3-Clause
"""``--json``: what a command found or made, as one JSON document alone on standard output."""

import json
from argparse import ArgumentParser


def add_json_argument(parser: ArgumentParser, what: str) -> None:
    """Declare ``--json``."""
    parser.add_argument("--json", action="store_true", help=f"print {what} as JSON instead of the text")


def as_json(content: dict) -> str:
    """Text of a JSON document: one space a level, no NaN; no letter that a terminal obeys."""
    text = json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False)
    if text.replace("\n", "").isprintable():
        return text
    return "".join(
        each if each == "\n" or each.isprintable() or each == "\u00a0" else json.dumps(each)[1:-1]
        for each in text
    )
