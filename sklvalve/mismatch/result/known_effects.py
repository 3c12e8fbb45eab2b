# SPDX-License-Identifier: BSD-3-Clause
"""What is known of an effect by its name alone, as a diagnosis on file has it."""

from collections.abc import Iterator
from functools import cache

from sklvalve.mismatch.effects import CATALOGUE, EVENTS, LATE
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.mismatch.loop.verdict import STICK_AND_SLIP

_CATALOGUE = (*CATALOGUE, *EVENTS, *LATE)


def forms_of(name: str) -> tuple[Effect | type[Effect], ...]:
    """Forms of an effect: those of the catalogue, and then classes that others wrote, the last one first.

    Parameters
    ----------
    name : str

    Returns
    -------
    forms : tuple of Effect and of subclasses of Effect
        Empty for a name that is known nowhere.
    """
    known = (form for form in _CATALOGUE if form.name == name)
    written = [kind for kind in _written(Effect) if kind.name == name]
    return (*known, *reversed(written))


def quantity_named(name: str, parameter: str, unit: str) -> Quantity | None:
    """Parameter of an effect.

    Parameters
    ----------
    name : str
        Of the effect.
    parameter, unit : str
        Name and SI unit.

    Returns
    -------
    quantity : Quantity or None
        That of the effect, if it says how it is shown. Else one of the catalogue, where all of that name and
        unit are shown alike.
    """
    # a class may make its parameters anew for each of its objects
    declared = (form.parameters for form in forms_of(name) if isinstance(form.parameters, tuple))
    matching = (q for each in declared for q in each if (q.name, q.unit) == (parameter, unit))
    shown = next((q for q in matching if q.shown is not None or q.silent), None)
    return shown or _shown_alike().get((parameter, unit))


def _written(kind: type[Effect]) -> Iterator[type[Effect]]:
    for each in kind.__subclasses__():
        yield each
        yield from _written(each)


@cache
def _shown_alike() -> dict[tuple[str, str], Quantity]:
    """Parameters that all effects of the catalogue which have them show alike, by name and unit."""
    by_key: dict[tuple[str, str], set[Quantity]] = {}
    for quantity in (*STICK_AND_SLIP, *(q for form in _CATALOGUE for q in form.parameters)):
        by_key.setdefault((quantity.name, quantity.unit), set()).add(quantity)
    return {
        key: several.pop()
        for key, several in by_key.items()
        if len({quantity.shown for quantity in several}) == 1 and not any(q.silent for q in several)
    }
