# SPDX-License-Identifier: BSD-3-Clause
"""The one exception for input that a person can mend."""

from collections.abc import Iterable
from difflib import get_close_matches

#: What reads files that are no recordings yet.
IMPORTED = "or run sklvalve import, which reads"


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


def hint(name: object, known: Iterable[str]) -> str:
    """Name the nearest known word, or list them all where none is near."""
    words = list(known)
    by_lower = {word.lower(): word for word in words}
    near = get_close_matches(str(name).lower(), by_lower, n=1, cutoff=0.6)
    if near:
        return f"did you mean {by_lower[near[0]]!r}?"
    return f"known are {', '.join(words)}"
