# SPDX-License-Identifier: BSD-3-Clause
"""Whether two data sheets are of one valve."""

from dataclasses import fields
from math import isclose
from typing import NamedTuple

from sklvalve.recording.valve import Valve

# what a data sheet says of the layout of a recording, and not of the valve
_LAYOUT = ("tag", "roles", "time", "source")
# numbers that differ by less were converted
_ROUNDING = 1e-9


class Difference(NamedTuple):
    """A field in which two data sheets differ, and what each of them says there."""

    field: str
    one: object
    other: object


def sheet_difference(one: Valve, other: Valve) -> Difference | None:
    """First field in which two data sheets differ; None where they agree.

    Parameters
    ----------
    one, other : Valve
        Their tags, and how signals are laid out in the recordings, do not count.

    Returns
    -------
    difference : Difference or None

    Examples
    --------
    >>> from sklvalve.recording import Valve
    >>> from sklvalve.recording.same_valve import sheet_difference
    >>> sheet_difference(Valve(kv_rated=40.0), Valve(kv_rated=25.0))
    Difference(field='kv_rated', one=40.0, other=25.0)
    """
    for field in fields(one):
        told = getattr(one, field.name), getattr(other, field.name)
        if field.name not in _LAYOUT and not _agree(*told):
            return Difference(field.name, *told)
    return None


def _agree(one: object, other: object) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return isclose(one, other, rel_tol=_ROUNDING)
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(_agree, one, other))
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_agree(value, other[key]) for key, value in one.items())
    return one == other
