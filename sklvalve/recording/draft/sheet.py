# SPDX-License-Identifier: BSD-3-Clause
"""Lines of a drafted valve.toml: every one with a comment that says why it stands there."""

import json
import re
from typing import NamedTuple

_COMMENT_AT = 44


class Stated(NamedTuple):
    """A line that holds, or the question in its place: then `value` is None; `key` too for a whole section.

    `doubt` is what a person should look at; empty where there is none.
    """

    section: str
    key: str | None
    value: object
    why: str
    doubt: str


class Sheet:
    """Collects lines, why they stand there, and what a person has to fill in.

    Examples
    --------
    >>> from sklvalve.recording.draft.sheet import Sheet
    >>> sheet = Sheet("made by hand")
    >>> sheet.section("valve")
    >>> sheet.known("tag", "FV-101", "as answered")
    >>> sheet.open("kv_rated", 40.0, "rated capacity [m3/h]?", fill="see the data sheet")
    >>> print(sheet.text(), sheet.to_fill_in)
    # made by hand
    <BLANKLINE>
    [valve]
    tag = "FV-101"                              # as answered
    # kv_rated = 40.0                           # rated capacity [m3/h]?
     ['[valve] kv_rated: see the data sheet']
    """

    def __init__(self, *heading: str) -> None:
        self._lines = [f"# {_one_line(line)}" for line in heading]
        self._section = ""
        self._commented = ""
        self.stated: list[Stated] = []
        self.to_fill_in: list[str] = []

    def section(self, name: str, why: str = "", *, open_question: str = "") -> None:
        """Begin a section; with an open question it stands as comments only, and waits to be filled in."""
        self._section, self._commented = name, "# " if open_question else ""
        self._lines.append("")
        self._add(f"{self._commented}[{name}]", open_question or why)
        if open_question:
            self.stated.append(Stated(name, None, None, open_question, open_question))
            self.to_fill_in.append(f"[{name}]: {open_question}")

    def known(self, key: str, value: object, why: str, *, check: str = "") -> None:
        """A line that holds; `check` is what a person should look at all the same."""
        self._add(f"{self._commented}{key} = {_toml(value)}", why)
        if not self._commented:
            self.stated.append(Stated(self._section, key, value, why, check))
            self.to_fill_in += [check] if check else []

    def open(self, key: str, example: object, question: str, *, fill: str = "") -> None:
        """A line that the data cannot tell: an example as a comment; `fill` is what a person is asked."""
        self._add(f"# {key} = {_toml(example)}", question)
        if not self._commented:
            self.stated.append(Stated(self._section, key, None, question, fill))
            self.to_fill_in += [f"[{self._section}] {key}: {fill}"] if fill else []

    def remark(self, text: str) -> None:
        """A comment on a line of its own."""
        self._lines += ["", f"# {_one_line(text)}"]

    def text(self) -> str:
        """The whole file."""
        return "\n".join(self._lines) + "\n"

    def _add(self, line: str, why: str) -> None:
        self._lines.append(f"{line:<{_COMMENT_AT}}# {_one_line(why)}" if why else line)


def _toml(value: object) -> str:
    """A value as TOML writes it; its texts are escaped as those of JSON, but for one control character."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _one_line(text: str) -> str:
    """A text without line ends and control characters, which would end a comment or spoil it."""
    return re.sub(r"[\x00-\x08\x0a-\x1f\x7f]+", " ", text)
