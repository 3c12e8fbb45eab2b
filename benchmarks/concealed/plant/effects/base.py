# SPDX-License-Identifier: BSD-3-Clause
"""What an effect of the plant is: how it is told, how large it may be, and what it does to the schedule."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Effect:
    """One thing the plant can conceal.

    Attributes
    ----------
    name : str
        Its name here.
    told : str or None
        Its name in the catalogue of effects; None: no catalogue holds it.
    block : str
    apply : callable
        ``apply(columns, size, active, plant)`` changes columns of the schedule, by row; `active` is 0 to 1.
    most : float
        Beyond it a valve is another valve.
    unit : str
        Of the size.
    free : float
        What a data sheet leaves open of it, where it was there from the start.
    parameter : tuple or None
        Name, unit and function ``(size, plant)`` of the catalogue's main parameter, where it is one quantity.
    signed, grows, limits : bool
        Whether it has a sign; whether it grows from its onset to the end; whether it does nothing up to some
        size and then much.
    when : {"any", "start", "within"}
        Whether it may be there from the start, and begin within the recording.
    fluid : str
    asks : tuple of str
        Excitations it needs to show at all; all where empty.
    """

    name: str
    told: str | None
    block: str
    apply: Callable
    most: float
    unit: str = "1"
    free: float = 0.0
    parameter: tuple | None = None
    signed: bool = False
    grows: bool = False
    limits: bool = False
    when: str = "any"
    fluid: str = "water"
    asks: tuple = ()


def add(column, scale=None):
    """An effect that adds its size to a column, in the scale of the plant."""

    def apply(columns, size, active, plant):
        columns[column] += size * (1.0 if scale is None else scale(plant)) * active

    return apply


def multiply(column):
    """An effect that multiplies a column by one plus its size."""

    def apply(columns, size, active, plant):
        columns[column] *= 1.0 + size * active

    return apply


def rise(column):
    """An effect that lifts a column to its size, where it is below."""

    def apply(columns, size, active, plant):
        columns[column][:] = np.where(
            active > 0.0, np.maximum(columns[column], size * active), columns[column]
        )

    return apply


def rated(plant):
    """Rated kv [m3/h]."""
    return plant.sheet["kv_rated"]


def span(plant):
    """Span of the flow meter [m3/h]."""
    return 1.5 * plant.sheet["kv_rated"]


def line(plant):
    """Length over area of each metre of a line in which the span of the flow runs at 2 m/s [1/m2]."""
    return 2.0 * 3600.0 / span(plant)


def spring(plant):
    """Force of the spring over the whole travel [N]."""
    return 80e3 * 1e-4 * plant.sheet["area"]


def own(name, unit="1", of=lambda size, plant: size):
    """The catalogue's parameter, from the size."""
    return name, unit, of
