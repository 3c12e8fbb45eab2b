# SPDX-License-Identifier: BSD-3-Clause
"""Programs that a valve may be moved by to learn more of it, within what the process allows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from sklvalve.recording import Recording
from sklvalve.simulation.stages import limited_rate

#: Rows of a program at most: what they do not tell, more of the same seldom does.
MOST_ROWS = 900
# so much of the travel, at least, must be free to move
_NARROWEST = 0.01
_PRESSURES = {"p1": "inlet pressure", "p2": "outlet pressure"}
# a moved pressure stays this long [s], and as many samples: longer ones end in what wanders anyway
_STAYS, _SAMPLES = 30.0, 10
# a command below this shuts the valve
_SHUT = 0.005


@dataclass(frozen=True)
class TestLimits:
    """What a test at the valve may do.

    Parameters
    ----------
    opening : (float, float), default=None
        Range within which the command may move [1]. None: what the recording's command has visited and,
        where that is not enough, the whole travel.
    rate : float, default=inf
        Largest rate of the command [1/s].
    duration : float, default=None
        Length of the test [s]; an hour unless given, and 900 rows at most.
    pressures : tuple of {"p1", "p2"}, default=()
        Pressures that can be moved.
    pressure_share : float, default=0.3
        How far these can be moved, both ways, as a share of the median pressure drop [1].
    sensors : tuple of str, default=("opening",)
        Signals that could be recorded where they are not; of these the opening can be simulated.

    Raises
    ------
    ValueError
        If a limit leaves nothing to move, or names what is no pressure.

    Examples
    --------
    >>> from sklvalve.mismatch import TestLimits
    >>> TestLimits(opening=(0.3, 0.7), rate=0.01, duration=600.0).opening
    (0.3, 0.7)
    """

    # no test of a test suite, whatever its name looks like
    __test__: ClassVar[bool] = False

    opening: tuple[float, float] | None = None
    rate: float = np.inf
    duration: float | None = None
    pressures: tuple[str, ...] = ()
    pressure_share: float = 0.3
    sensors: tuple[str, ...] = ("opening",)

    def __post_init__(self) -> None:
        if self.opening is not None:
            low, high = self.opening
            if not 0.0 <= low < high - _NARROWEST <= 1.0:
                raise ValueError(
                    "opening must be a range within 0 and 1, 0.01 wide at least, such as (0.2, 0.8); "
                    f"got {self.opening!r}."
                )
        if not self.rate > 0.0:
            raise ValueError(f"rate must be above zero [1/s]; got {self.rate!r}.")
        if self.duration is not None and not self.duration > 0.0:
            raise ValueError(f"duration must be above zero [s]; got {self.duration!r}.")
        strange = [name for name in self.pressures if name not in _PRESSURES]
        if strange:
            raise ValueError(f"pressures may name p1 and p2; got {strange[0]!r}.")
        if not 0.0 < self.pressure_share < 1.0:
            raise ValueError(f"pressure_share must lie between 0 and 1; got {self.pressure_share!r}.")


@dataclass(frozen=True, eq=False)
class Program:
    """How the command, and perhaps a pressure, is to move.

    Attributes
    ----------
    name : str
    text : str
        What to do, as one sentence without its stop.
    command : ndarray of shape (n,)
        Opening that is asked for, sample by sample [1].
    moved : dict
        Pressure role -> how far it is moved from where it would stand, as a share of the median drop [1].
    signals : dict
        Role -> signal, for those that are not as the flow and the recording's medians make them.
    """

    name: str
    text: str
    command: np.ndarray
    moved: dict[str, np.ndarray] = field(default_factory=dict)
    signals: dict[str, np.ndarray] = field(default_factory=dict)


def library(
    low: float, high: float, about: float, rows: int, step: float, limits: TestLimits
) -> list[Program]:
    """Programs within limits, all of one length.

    Parameters
    ----------
    low, high : float
        Range of the command [1].
    about : float
        Where the command stands when the test begins [1].
    rows : int
    step : float
        Sample time [s].
    limits : TestLimits

    Returns
    -------
    programs : list of Program
    """
    about = float(np.clip(about, low, high))
    named = [
        *_over_the_range(low, high, rows, step),
        *_about_the_middle(low, high, about, rows, step),
        _square(low, high, rows, step),
        *_near_the_seat(low, high, rows, step),
    ]
    programs = [Program(name, text, _allowed(command, about, step, limits)) for name, text, command in named]
    return programs + _with_pressures(low, high, about, rows, step, limits)


def _over_the_range(low: float, high: float, rows: int, step: float) -> list[tuple[str, str, np.ndarray]]:
    """Name, text and command of the programs that go through the whole range."""
    length, across, rising = rows * step, _across(low, high), np.linspace(low, high, 9)
    return [
        ("slow triangle", f"Ramp the command slowly between {across}, up and down once in {length:.0f} s",
         _triangle(low, high, rows, 1)),
        ("triangles", f"Ramp the command between {across}, up and down five times in {length:.0f} s",
         _triangle(low, high, rows, 5)),
        ("staircase", f"Move the command between {across} in a staircase of eight steps up and down, "
         f"{length / 17:.0f} s each", _held(np.r_[rising, rising[-2::-1]], rows)),
    ]  # fmt: skip


def _about_the_middle(
    low: float, high: float, about: float, rows: int, step: float
) -> list[tuple[str, str, np.ndarray]]:
    """Name, text and command of steps and of reversals of several sizes."""
    length, width = rows * step, high - low
    sizes = [s for s in (0.01, 0.02, 0.05, 0.1, 0.25, 0.5) if s <= 0.5 * width] or [0.5 * width]
    middle = _between(about, low + sizes[-1], high - sizes[-1])
    levels = np.concatenate([[middle, middle + s, middle, middle - s] for s in sizes])
    steps = (
        "steps", f"Step the command from {100 * middle:.3g} % up and back, down and back, by "
        f"{_percents(sizes)} %, {length / len(levels):.0f} s each", _held(levels, rows),
    )  # fmt: skip
    small = [s for s in (0.005, 0.01, 0.02, 0.03, 0.05) if s <= 0.5 * width] or [0.5 * width]
    middle = _between(about, low + small[-1], high - small[-1])
    reversals = (
        "reversals", f"Ramp the command up and down around {100 * middle:.3g} %, by {_percents(small)} % "
        f"to either side, {length / len(small):.0f} s each", middle + _reversals(small, rows),
    )  # fmt: skip
    return [steps, reversals]


def _square(low: float, high: float, rows: int, step: float) -> tuple[str, str, np.ndarray]:
    """A sound actuator comes to rest in between: haste shows what a simulation gets wrong of any."""
    beat = max(20.0 * step, 60.0)
    text = (
        f"Step the command between {_across(low, high)} and back every {beat:.0f} s for {rows * step:.0f} s"
    )
    return "square", text, np.where(np.arange(rows) * step // beat % 2 == 0, low, high).astype(float)


def _near_the_seat(low: float, high: float, rows: int, step: float) -> list[tuple[str, str, np.ndarray]]:
    """A few small openings, and shut; nothing where the command must not go near the seat."""
    if not low < 0.05:
        return []
    levels = np.array([0.15, 0.08, 0.04, 0.02, 0.01, 0.0, 0.0, 0.01, 0.02, 0.04, 0.08, 0.15])
    levels = np.clip(levels, low, high)
    text = (
        f"Bring the command from {100 * levels[0]:.3g} % down to {100 * low:.3g} % in "
        f"five steps, wait, and go back, {rows * step / 12:.0f} s each"
    )
    return [("near the seat", text, _held(levels, rows))]


def _across(low: float, high: float) -> str:
    return f"{100 * low:.3g} % and {100 * high:.3g} %"


def _percents(shares: Iterable[float]) -> str:
    return ", ".join(f"{100 * s:.3g}" for s in shares)


def as_now(recording: Recording, rows: int) -> Program | None:
    """The end of a recording once more; None where it has gaps."""
    signals = {role: recording[role][-rows:] for role in ("p1", "p2", "temperature") if role in recording}
    role = "command" if "command" in recording else "opening"
    command = recording[role][-rows:]
    if len(command) < rows or not all(np.isfinite(each).all() for each in (command, *signals.values())):
        return None
    length = rows * recording.sample_time
    return Program("as now", f"Record {length:.0f} s more as now", command, signals=signals)


def _with_pressures(
    low: float, high: float, about: float, rows: int, step: float, limits: TestLimits
) -> list[Program]:
    """Three openings held, and the valve shut, while pressures that can be moved go up and down."""
    levels = np.array([_between(low + share * (high - low), low, high) for share in (0.0, 0.4, 0.95)])
    held = [
        (
            "",
            f"Hold the command at {_percents(levels)} %, {rows * step / 3:.0f} s each, and at each",
            _held(levels, rows),
        )
    ]
    if low < _SHUT:
        # no trim in between: what still flows is told by how it goes with the pressures
        held.append((", shut", f"Keep the valve shut for {rows * step:.0f} s, and", np.full(rows, low)))
    stays = int(np.clip(round(_STAYS / step), _SAMPLES, max(rows // 12, 1)))
    moves: list[tuple[str, str, dict]] = [
        (f"{role} moved", f"move the {_PRESSURES[role]} up and back, down and back", {role: (0, 1, 0, -1)})
        for role in limits.pressures
    ]
    if len(limits.pressures) > 1:
        moves.append(
            (
                "p1 and p2 moved",
                "move the inlet pressure up and back, the outlet pressure down and back, then both up "
                "together and back",
                {"p1": (0, 1, 0, 0, 0, 1), "p2": (0, 0, 0, -1, 0, 1)},
            )
        )
    by = f"by {100 * limits.pressure_share:.0f} % of the pressure drop, {stays * step:.0f} s each time"
    return [
        Program(
            name + where,
            f"{begin} {text}, {by}",
            _allowed(command, about, step, limits),
            {
                role: limits.pressure_share * _repeated(pattern, stays, rows)
                for role, pattern in moved.items()
            },
        )
        for name, text, moved in moves
        for where, begin, command in held
    ]


def _repeated(pattern: Sequence[int], stays: int, rows: int) -> np.ndarray:
    """A pattern over and over, so many rows at each of its levels."""
    return np.asarray(pattern, dtype=float)[np.arange(rows) // stays % len(pattern)]


def _between(value: float, low: float, high: float) -> float:
    """A value between ends, in whole percent where these leave one."""
    return float(np.clip(np.round(value, 2), low, high))


def _allowed(command: np.ndarray, about: float, step: float, limits: TestLimits) -> np.ndarray:
    """A command that begins where the valve stands, and moves no faster than it may."""
    begun = np.concatenate([[about], command[:-1]])
    if not np.isfinite(limits.rate):
        return begun
    return limited_rate(begun, np.full(len(begun), step), limits.rate, limits.rate)


def _triangle(low: float, high: float, rows: int, times: int) -> np.ndarray:
    phase = np.arange(rows) * times / rows % 1.0
    return low + (high - low) * (1.0 - np.abs(2.0 * phase - 1.0))


def _held(levels: np.ndarray, rows: int) -> np.ndarray:
    return levels[np.minimum(np.arange(rows) * len(levels) // rows, len(levels) - 1)].astype(float)


def _reversals(sizes: Sequence[float], rows: int) -> np.ndarray:
    """Three triangles about zero for each size."""
    share = np.arange(rows) * len(sizes) / rows
    size = np.asarray(sizes)[np.minimum(share.astype(int), len(sizes) - 1)]
    phase = share * 3.0 % 1.0
    return size * (4.0 * np.abs((phase + 0.25) % 1.0 - 0.5) - 1.0)
