# SPDX-License-Identifier: BSD-3-Clause
"""The one exception for input that a person can mend."""

from collections.abc import Iterable
from difflib import get_close_matches
from unicodedata import category

#: What reads files that are no recordings yet.
IMPORTED = "or run sklvalve import, which reads"
# letters of a message, and those of them before what is cut
_LONGEST, _BEGINNING = 1000, 650
_LONGEST_NAME, _COMPARED = 200, 2000


class InputError(ValueError):
    """Input that cannot be used as it is, and that the person who gave it can mend.

    Its message is one plain sentence that names the file, the place in it and the mend. The command line
    prints that sentence and ends with exit status 2.

    Examples
    --------
    >>> from sklvalve.recording import InputError, Valve
    >>> try:
    ...     Valve.from_dict({"valve": {"kv_rate": 40.0}}, source="valve.toml")
    ... except InputError as error:
    ...     print(error)
    valve.toml: [valve] knows no key 'kv_rate'; did you mean 'kv_rated'?
    """

    def __init__(self, sentence: str) -> None:
        words = one_line(str(sentence))
        if len(words) > _LONGEST:
            # what is wrong stands at the beginning, the mend at the end
            words = f"{words[:_BEGINNING]} ... {words[len(words) - _LONGEST + _BEGINNING + 5 :]}"
        super().__init__(words)


def one_line(text: str) -> str:
    r"""Make a text safe to be printed: what is no letter, sign or blank is written out, as ``\x1b``.

    Names of files, columns and tags come from elsewhere, and a terminal obeys what stands in them.
    """
    if text.isprintable():
        return text
    return "".join(each if _harmless(each) else each.encode("unicode_escape").decode() for each in text)


def _harmless(letter: str) -> bool:
    return letter.isprintable() or category(letter) == "Zs"


def shown(value: object) -> str:
    """A value as Python writes it, cut where nobody would read on."""
    try:
        words = repr(value)
    except (ValueError, RecursionError):  # a number, or a nesting, too long to be written out
        return "more than can be shown"
    return words if len(words) <= 60 else f"{words[:57]}..."


def listed(names: Iterable[object], most: int = 20) -> str:
    """Names with commas between them, each cut to 60 letters; the first 20 only."""
    every = [str(name) for name in names]
    words = [name if len(name) <= 60 else f"{name[:57]}..." for name in every[:most]]
    return ", ".join(words) + (f" and {len(every) - most} more" if len(every) > most else "")


def hint(name: object, known: Iterable[str]) -> str:
    """Name the nearest known word, or list them all where none is near."""
    words = list(known)
    # the comparison takes time with the square of the letters
    by_lower = {word.lower(): word for word in words[:_COMPARED] if len(word) <= _LONGEST_NAME}
    near = get_close_matches(str(name).lower()[:_LONGEST_NAME], by_lower, n=1, cutoff=0.6)
    if near:
        return f"did you mean {shown(by_lower[near[0]])}?"
    return f"known are {listed(words)}"
