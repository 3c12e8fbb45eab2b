# SPDX-License-Identifier: BSD-3-Clause
"""What would have gone unnoticed where nothing was found, in words."""

from itertools import groupby

from sklvalve.report.parameters import shown_range
from sklvalve.report.words import BLOCKS, either, number, spoken

#: Before the lists of `unnoticed`.
UNNOTICED = "Were one of these there throughout the recording, and no larger, it would have gone unnoticed."
_ANY = "at any size"


def unnoticed(d: dict) -> list[tuple[str, str]]:
    """What would have gone unnoticed, block by block: (where, effects with the sizes up to which).

    Parameters
    ----------
    d : dict
        A diagnosis as ``Diagnosis.to_dict()`` gives it.

    Returns
    -------
    lists : list of (str, str)
        Empty where something was found.
    """
    # a report without limits does without the simulation, which takes a second to import
    limits = d.get("detection_limits") or []
    if not limits:
        return []
    from sklvalve.mismatch.result.known_effects import forms_of

    first: dict[str, dict] = {}
    for limit in limits:
        # forms of one effect are one effect to a reader
        first.setdefault(limit["name"], limit)
    by_block = {name: next(f.block for f in forms_of(name)) for name in first if forms_of(name)}
    order = sorted(by_block, key=lambda name: list(BLOCKS).index(by_block[name]))
    told = []
    for block, names in groupby(order, key=by_block.__getitem__):
        each = {name: _size(first[name], d) for name in names}
        words = [f"{spoken(name)} {size}" for name, size in each.items() if size != _ANY]
        never = [spoken(name) for name, size in each.items() if size == _ANY]
        words += [f"{_ANY} {either(never, 'and')}"] if never else []
        told.append((BLOCKS[block].capitalize(), "; ".join(words)))
    return told


def _size(limit: dict, d: dict) -> str:
    """Sizes of one effect that would have gone unnoticed, in words."""
    name, low, high, unit = shown_range(limit, d)
    of = f" ({name.rstrip(',')})" if name else ""
    unit = f" {unit}" if unit else ""
    if low is None and high is None:
        return _ANY
    if low is None:
        return f"up to {number(high, 2)}{unit}{of}"
    if high is None:
        return f"from {number(low, 2)}{unit} on{of}"
    return f"from {number(low, 2)} to {number(high, 2)}{unit}{of}"
