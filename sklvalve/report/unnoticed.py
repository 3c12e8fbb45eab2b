# SPDX-License-Identifier: BSD-3-Clause
"""What might have gone unnoticed where nothing was found, in words."""

from itertools import groupby
from typing import NamedTuple

from sklvalve.report.parameters import shown_range
from sklvalve.report.words import BLOCKS, either, number, spoken

#: Before the lists of `unnoticed`.
UNNOTICED = (
    "Were one of these there throughout the recording, and no larger, it would most likely have gone "
    "unnoticed. In tests seven in ten of what was a quarter larger was noticed, and nine in ten of what was "
    "twice as large. Of pressure sensors it is not known."
)
#: Heads of the rows of `Unnoticed`.
HEAD = ("effect", "unnoticed", "given as")
_ANY = "at any size"


class Unnoticed(NamedTuple):
    """What of one block might have gone unnoticed: rows of effect, sizes, and what the size is."""

    where: str
    rows: list[tuple[str, str, str]]

    @property
    def words(self) -> str:
        """The same as a list."""
        words = [f"{effect} {sizes}{f' ({what})' if what else ''}" for effect, sizes, what in self.rows]
        told = [each for each, (_, sizes, _) in zip(words, self.rows, strict=True) if sizes != _ANY]
        never = [effect for effect, sizes, _ in self.rows if sizes == _ANY]
        return "; ".join(told + ([f"{_ANY} {either(never, 'and')}"] if never else []))


def unnoticed(d: dict) -> list[Unnoticed]:
    """What might have gone unnoticed, block by block.

    Parameters
    ----------
    d : dict
        A diagnosis as ``Diagnosis.to_dict()`` gives it.

    Returns
    -------
    lists : list of Unnoticed
        Empty where something was found.
    """
    # a report without limits does without the simulation, which takes a second to import
    if not d.get("detection_limits"):
        return []
    from sklvalve.mismatch.result.known_effects import forms_of

    widest: dict[tuple[str, str], dict] = {}
    for limit in d["detection_limits"]:
        # forms of one effect are one effect to a reader, who is told of the one that hides best
        key = limit["name"], limit["parameter"]
        widest[key] = _wider(widest[key], limit) if key in widest else limit
    blocks = {name: forms[0].block for name, _ in widest if (forms := forms_of(name))}
    order = sorted(
        (key for key in widest if key[0] in blocks), key=lambda key: list(BLOCKS).index(blocks[key[0]])
    )
    return [
        Unnoticed(BLOCKS[block].capitalize(), [(spoken(key[0]), *_sizes(widest[key], d)) for key in keys])
        for block, keys in groupby(order, key=lambda key: blocks[key[0]])
    ]


def _wider(one: dict, other: dict) -> dict:
    """A limit that holds the sizes of two; an end that is None has nothing beyond it."""
    low, high = ([each[end] for each in (one, other)] for end in ("low", "high"))
    return one | {
        "low": None if None in low else min(low),
        "high": None if None in high else max(high),
    }


def _sizes(limit: dict, d: dict) -> tuple[str, str]:
    """Sizes of one effect that might have gone unnoticed, and what the size is."""
    what, low, high, unit = shown_range(limit, d)
    unit = f" {unit}" if unit else ""
    if low is None and high is None:
        return _ANY, ""
    if low is None:
        sizes = f"up to {number(high, 2)}{unit}"
    elif high is None:
        sizes = f"from {number(low, 2)}{unit} on"
    else:
        sizes = f"from {number(low, 2)} to {number(high, 2)}{unit}"
    return sizes, what.rstrip(",")
