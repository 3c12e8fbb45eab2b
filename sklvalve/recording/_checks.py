# SPDX-License-Identifier: BSD-3-Clause
"""Checks of single values of a valve.toml: each gives the value in SI, or says what is wrong with it."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import inf, isfinite

from sklvalve.recording.errors import InputError, hint, shown

Check = Callable[[object, str], object]


def plain_number(value: object, where: str) -> float:
    """A finite number; true and false are none, although Python counts with them."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        mend = ", so write it without quotes" if isinstance(value, str) else ""
        raise InputError(f"{where} must be a number; got {shown(value)}{mend}")
    try:
        number = float(value)
    except OverflowError:
        number = inf
    if not isfinite(number):
        raise InputError(f"{where} must be a finite number; got {shown(value)}")
    return number


@dataclass(frozen=True)
class Number:
    """A number within bounds, scaled to SI by `factor`."""

    unit: str = ""
    factor: float = 1.0
    low: float = 0.0
    high: float = inf
    open_low: bool = True
    open_high: bool = False

    def __call__(self, value: object, where: str) -> float:
        number = plain_number(value, where)
        under = number <= self.low if self.open_low else number < self.low
        over = number >= self.high if self.open_high else number > self.high
        if under or over:
            raise InputError(f"{where} must be {self._bounds()}; got {number:g}")
        scaled = number * self.factor
        # a number may be finite in its unit and not in SI
        if not isfinite(scaled) or (scaled == 0.0 and number != 0.0):
            raise InputError(f"{where} must be a number that has a meaning in SI; got {number:g}")
        return scaled

    def _bounds(self) -> str:
        low = "above" if self.open_low else "at least"
        words = f"{low} {self.low:g}"
        if self.high < inf:
            words += f" and {'below' if self.open_high else 'at most'} {self.high:g}"
        return words + (f" {self.unit}" if self.unit else "")


def text(value: object, where: str) -> str:
    if not isinstance(value, str) or not value.strip():
        raise InputError(f"{where} must be a text in quotes; got {shown(value)}")
    return value


def flag(value: object, where: str) -> bool:
    if not isinstance(value, bool):
        raise InputError(f"{where} must be true or false, without quotes; got {shown(value)}")
    return value


def one_of(*names: str) -> Check:
    """A text out of a short list."""

    def check(value: object, where: str) -> object:
        if value not in names or not isinstance(value, str):
            raise InputError(f"{where} must be one of {', '.join(names)}; got {shown(value)}")
        return value

    return check


def or_left_out(content: Check) -> Check:
    """What the recording itself may tell where nobody knows it."""

    def check(value: object, where: str) -> object:
        try:
            return content(value, where)
        except InputError as error:
            raise InputError(f"{error}: correct it, or leave it out and it is taken as unknown") from None

    return check


def table(value: object, where: str, *, content: Number, rising: bool) -> tuple[tuple[float, float], ...]:
    """Pairs of opening and value, openings rising from shut to open."""
    form = f"{where} must be a table of pairs [opening, value], at least two"
    if not isinstance(value, list | tuple) or len(value) < 2:
        raise InputError(f"{form}; got {shown(value)}")
    pairs = []
    for number, pair in enumerate(value, start=1):
        if not isinstance(pair, list | tuple) or len(pair) != 2:
            raise InputError(f"{form}; pair {number} is {shown(pair)}")
        opening = Number(low=0.0, high=1.0, open_low=False)(pair[0], f"{where}, pair {number}, opening")
        pairs.append((opening, content(pair[1], f"{where}, pair {number}, value")))
    for number, (before, after) in enumerate(pairwise(pairs), start=2):
        if after[0] <= before[0]:
            raise InputError(
                f"{where}, pair {number}: openings must rise, but {after[0]:g} follows {before[0]:g}; "
                "sort the pairs by opening, each opening once"
            )
        if rising and after[1] < before[1]:
            raise InputError(
                f"{where}, pair {number}: capacity must not fall as the valve opens, "
                f"but {after[1]:g} follows {before[1]:g}; correct the pair"
            )
    return tuple(pairs)


def characteristic(value: object, where: str) -> object:
    """A name of a trim characteristic, or a table of opening and kv / kv_rated."""
    names = ("linear", "equal_percentage", "quick_opening", "parabolic", "unknown")
    if isinstance(value, str):
        if value not in names:
            near = hint(value, names)
            raise InputError(f"{where} = {shown(value)} is no known characteristic; {near}")
        return value
    pairs = table(value, where, content=Number(low=0.0, high=1.0, open_low=False), rising=True)
    shut, wide = pairs[0][0], pairs[-1][0]
    if shut != 0.0 or wide != 1.0:
        raise InputError(
            f"{where} must be a table from opening 0 to opening 1; got {shut:g} to {wide:g}, "
            "so add the pairs at its ends"
        )
    if pairs[-1][1] <= 0.0:
        raise InputError(f"{where} has no capacity at any opening; give kv / kv_rated, 1 at opening 1")
    return pairs


def number_or_table(content: Number) -> Check:
    """A number, or the same number as a table over opening."""

    def check(value: object, where: str) -> object:
        if isinstance(value, list | tuple):
            return table(value, where, content=content, rising=False)
        return content(value, where)

    return check


def rising_pair(content: Number, apart: float = 0.0) -> Check:
    """Two numbers, the lower one first, and so much apart, in the unit of the file."""

    def check(value: object, where: str) -> object:
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise InputError(f"{where} must be two numbers [low, high]; got {shown(value)}")
        low, high = (content(item, where) for item in value)
        if high <= low:
            raise InputError(f"{where} must give the lower number first; got {shown(list(value))}")
        # a hair's breadth less passes: decimals have no exact difference
        if high - low < apart * content.factor * (1.0 - 1e-9):
            raise InputError(
                f"{where} must be two numbers at least {apart:g} {content.unit} apart; "
                f"got {shown(list(value))}, so check the unit"
            )
        return low, high

    return check


def names_list(value: object, where: str) -> tuple[str, ...]:
    """A list of effect names, each once."""
    if isinstance(value, str) or not isinstance(value, list | tuple):
        raise InputError(f'{where} must be a list of names, such as ["choked_flow"]; got {shown(value)}')
    for item in value:
        if not isinstance(item, str) or not item.isidentifier():
            raise InputError(f"{where} must hold names of effects in quotes; got {shown(item)}")
    if len(set(value)) < len(value):
        raise InputError(f"{where} names an effect twice; write each once")
    return tuple(value)
