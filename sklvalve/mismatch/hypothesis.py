# SPDX-License-Identifier: BSD-3-Clause
"""What is fitted: a set of effects, each from its onset on, and what the fit made of it."""

from dataclasses import dataclass

import numpy as np

from sklvalve.mismatch.effects.base import Effect
from sklvalve.simulation.chain import Chain

# what an onset must gain, and every other switch: it is one of as many as there are rows
SWITCH_PRICE = 10.0

# an onset is looked for between these shares of the record: before and after there is too little to compare
FIRST_ONSET, LAST_ONSET = 0.04, 0.96


@dataclass(frozen=True, eq=False)
class Member:
    """An effect in a hypothesis.

    Parameters
    ----------
    effect : Effect
    onset : float or None
        Absolute time from which on it acts [s]; None from before the recording.
    switches : tuple of float
        Later times at which it stops, begins again, and so on [s, absolute].
    """

    effect: Effect
    onset: float | None = None
    switches: tuple = ()

    @property
    def sign(self):
        """What tells this member from others."""
        return (self.effect.key, self.onset, self.switches)

    @property
    def times(self):
        """When it begins, stops, begins again [s, absolute]; None from before the recording on."""
        return self.onset if not self.switches else (self.onset, *self.switches)


def may_come_and_go(effect):
    """Whether an effect may act in spells.

    What grows has a course of its own, and an actuator is simulated through with what has happened to it.
    """
    return effect.may_begin and not effect.grows and effect.stage != "actuator"


def begun(effect, times):
    """Member of an effect that acts as `Member.times` of another one says, as far as it can."""
    if not effect.may_begin:
        return Member(effect)
    first, *later = np.atleast_1d(times).tolist() if times is not None else (None,)
    return Member(effect, first, tuple(later) if may_come_and_go(effect) else ())


@dataclass(frozen=True, eq=False)
class Model:
    """A hypothesis fitted jointly with the calibration.

    Attributes
    ----------
    members : tuple of Member
    chain : Chain
    values : dict
        Every parameter's value.
    predictions : dict
        Channel -> simulated signal.
    log_likelihood : float
    spreads : dict
        Parameter name -> standard deviation, of the logarithm where the parameter moves by that.
    """

    members: tuple
    chain: Chain
    values: dict
    predictions: dict
    log_likelihood: float
    spreads: dict

    @property
    def keys(self):
        """Keys of its effects."""
        return tuple(m.effect.key for m in self.members)


def is_in(effect, members):
    """Whether an effect, or one of the same equation, is among the members of a hypothesis."""
    return any(
        effect.name == m.effect.name or (effect.family and effect.family == m.effect.family) for m in members
    )


def own_values(member, model):
    """Parameters of one effect in a fitted model, by their short names."""
    return {q.name: model.values[f"{member.effect.key}.{q.name}"] for q in member.effect.parameters}


def price(workbench, member):
    """Log likelihood that the parameters of an effect must earn (half a log of the rows for each)."""
    rows = max(len(workbench.recording), 50)
    cost = 0.5 * len(member.effect.parameters) * np.log(rows)
    return cost + SWITCH_PRICE * switches_of(member)


def switches_of(member):
    """Number of times at which an effect begins or stops within the recording."""
    return 0 if member.onset is None else 1 + len(member.switches)


def worth(workbench, model):
    """Log likelihood of a hypothesis less the price of its effects."""
    return model.log_likelihood - sum(price(workbench, m) for m in model.members)
