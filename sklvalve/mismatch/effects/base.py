# SPDX-License-Identifier: BSD-3-Clause
"""What an effect is: a change to one stage of the chain, with what a person needs to know of it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from sklvalve.simulation.chain import Chain
from sklvalve.simulation.parameters import Parameter
from sklvalve.simulation.tolerance import Tolerance


@dataclass(frozen=True)
class Shown:
    """How a parameter is shown to a plant engineer.

    Parameters
    ----------
    words : str
        What it is called.
    unit : str, default=""
        Unit in which it is shown.
    turn : float or callable, default=1.0
        Factor, or function, from the parameter in its own unit to what is shown.
    """

    words: str
    unit: str = ""
    turn: float | Callable[[float], float] = 1.0


@dataclass(frozen=True)
class Quantity:
    """A parameter of an effect.

    Parameters
    ----------
    name : str
    unit : str
        SI unit, ``"1"`` for a share; ``"m3/h"`` for a flow coefficient.
    low, high : float
        What is physically possible.
    starts : tuple of float
        Where fits begin: at several sizes, for a dead band has no slope at zero.
    log : bool, default=False
        Whether a fit moves its logarithm.
    null : float or None, default=0.0
        Value at which the effect vanishes: zero of a bias or a leak, one of a ratio. None of a parameter that
        says where or how an effect acts and not how much, such as a limit of speed.
    shown : Shown or None, default=None
        How reports show it. Where it is None, as the catalogue shows all parameters of that name and unit,
        if it shows them alike; else by its name, in its own unit.
    silent : bool, default=False
        Whether reports leave it to diagnosis.json, for it has no meaning without the equation.
    declared : callable or None, default=None
        From the parameter to the value that declares it in valve.toml, under the effect's `declared_as`.
    """

    name: str
    unit: str
    low: float
    high: float
    starts: tuple
    log: bool = False
    null: float | None = 0.0
    shown: Shown | None = None
    silent: bool = False
    declared: Callable[[float], float] | None = None

    def parameter_of(self, key: str, attempt: int = 0) -> Parameter:
        """Parameter of a fit for the effect of this key, begun with the start of this number."""
        start = self.starts[min(attempt, len(self.starts) - 1)]
        return Parameter(f"{key}.{self.name}", self.unit, self.low, self.high, start, log=self.log)


class Effect:
    """One kind of physics that a simulation may leave out.

    Attributes
    ----------
    name : str
        Name of the catalogue.
    key : str
        Name of this form of it; the same as `name` where there is only one form.
    block : {"actuator", "valve", "line", "measurement"}
        Where it sits.
    stage : str
        Stage of the chain that it changes.
    needs : tuple of str
        Roles without which it cannot be tested.
    words : str
        What it is called in a report, as it follows "the simulation lacks": ``"seat leakage"``. Where it is
        empty the name stands there, with blanks.
    clause : str
        What has happened where it is a fault, as it follows "likely fault:": ``"the seat leaks"``. Where it
        is empty, "there is" and its words.
    phrase : str
        What a person reads; may name the parameters. Where it is empty, the clause.
    separated_by : str
        The test that tells it from what it is confused with.
    hidden_by : mapping of str to tuple of str
        Defects of the data with which the effect is not searched for, because they hide it or look like it;
        what was found may be it all the same. A key is a defect, its value the roles of the signals in which
        it does so, or ``"any"``. The defects are ``compressed``, ``quantised``, ``frozen``, ``saturated``,
        ``clock_shift``; ``unmeasured``, which is frozen from the first row to the last; and ``held``, an
        opening within a dead band too small to matter. Exchanged columns, wrong units and a flow that was not
        measured hide every effect and are not listed.
    standstill : bool
        Whether it is a stem that stands still: a frozen opening that may be a seized stem does not hide it.
    by_drop : {"", "always", "unseen", "onset"}
        When an unrecorded pressure drop looks like the effect. ``"always"``: the effect bends, scales, slowly
        shifts or damps a flow; without a recorded drop it is not tested. ``"unseen"``: it shifts the stem's
        travel or ends it early; it is not tested where the position is missing too. ``"onset"``: no drop
        looks like the effect, but one that changes looks like its beginning; without a recorded drop it is
        tested from the first row on only. ``""``: never.
    family : str
        Effects of one family have the same equation: a hypothesis holds one of them at most.
    alike : str
        Effects that look alike, however different their equations. Where slips or hunting of a stem speak
        for themselves, ``"play"`` may stand beside them; no other effect of the stem may.
    may_begin : bool
        Whether it can come about while the valve runs; a wrong data sheet is wrong from the start.
    motor : bool
        Whether it is one of an electric actuator.
    in_loop : bool
        Whether it is a sensor's that positioner and recording share; then `stops` says what it reads at both
        stops of the stem.
    stops_stem : bool
        Whether a stem driven by air runs against it; then `lowest` says where.
    grows : bool
        Whether it grows from its onset on, so that with another onset it is another signal.
    damadics : str
        Fault of the benchmark with the same physics, or ``""``.
    source : str
        Where its equation is from, or ``""`` where it is plain arithmetic.
    kind : {"fault", "property", "either"}
        What it is where it is there from the start: a fault; a property of a sound valve, or of its fluid and
        line, that a simulation may lack; or either of them, which the recording does not tell.
    kind_late : {"fault", "either"}
        What it is where it begins within the recording, or grows: no valve changes its properties, but a
        fluid may.
    declared_as : str
        Key of ``[actuator]`` in valve.toml that declares it, or ``""``.
    fluid : {"", "liquid", "gas"}
        What it happens in; either where it is ``""``.
    requires : str
        What must be known or seen for `possible` to hold, as it is told where the effect cannot be tested.
    """

    name = key = block = stage = words = clause = phrase = separated_by = damadics = ""
    family = alike = source = declared_as = fluid = by_drop = ""
    kind, kind_late = "fault", "fault"
    requires = "a data sheet that gives the characteristic and the fluid"
    hidden_by: Mapping[str, tuple[str, ...]] = MappingProxyType({})
    standstill = False
    may_begin = True
    grows = False
    motor = False
    in_loop = False
    stops_stem = False
    needs: tuple = ()
    parameters: tuple = ()

    def __init_subclass__(cls, **settings: Any) -> None:
        """Leave the words of another effect to that one: they belong to its name."""
        super().__init_subclass__(**settings)
        if "name" in vars(cls):
            for attribute in ("words", "clause"):
                if attribute not in vars(cls):
                    setattr(cls, attribute, "")

    @property
    def spoken(self) -> str:
        """What a report calls it: its words, or its name with blanks."""
        return self.words or self.name.replace("_", " ")

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        """Parameters with the bounds that hold for this valve."""
        return self.parameters

    def apply(self, value: Any, p: dict[str, float], chain: Chain) -> Any:
        """What the stage makes, `value`, with the effect of parameters `p`."""
        raise NotImplementedError

    def kind_of(self, chain: Chain, late: bool) -> str:
        """What it is in this valve: "fault", "property" or "either"; `late`: it began in the record."""
        return self.kind_late if late or self.grows else self.kind

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        """Whether parameters `p` lie beyond what a data sheet leaves open; `late`: it began in the record."""
        return True

    def lowest(self, p: dict[str, float]) -> float:
        """Opening below which it keeps the stem [1]."""
        return 0.0

    def possible(self, chain: Chain) -> bool:
        """Whether the effect makes sense for this valve at all."""
        return True
