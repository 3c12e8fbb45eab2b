# SPDX-License-Identifier: BSD-3-Clause
"""How strong the evidence against healthy recordings gets by chance, and how rare a stronger one is."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from importlib.resources import files
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sklvalve.history.rehearsal import Rehearsal


@dataclass(frozen=True)
class Covariates:
    """What the strength of chance depends on, known before a search.

    Parameters
    ----------
    noise : float
        Logarithm of the noise of the noisier channel in multiples of what counts there.
    travel : float
        From the 5 % to the 95 % quantile of the opening; of the command, or of the flow as share of its span,
        where no opening is recorded [1].
    no_opening : float
        1 where no opening is recorded, else 0.
    no_drop : float
        1 where nothing tells the pressure drop, else 0.
    one_pressure : float
        1 where nothing tells the drop but one of its two pressures is recorded, else 0.
    held_opening, held_flow : float
        Logarithm of one plus the dead band of a historian in that channel, where it is compared, in multiples
        of what counts there; of the flow's and those of the pressures, by what they move it, the widest. 0
        where every value was written.
    """

    noise: float
    travel: float
    no_opening: float
    no_drop: float
    one_pressure: float = 0.0
    held_opening: float = 0.0
    held_flow: float = 0.0

    @property
    def noise_without_opening(self) -> float:
        """The noise where it is the flow's alone, else 0."""
        return self.noise * self.no_opening

    @property
    def noise_without_drop(self) -> float:
        """The noise where it is next to all the opening's, else 0."""
        return self.noise * self.no_drop

    @property
    def noise_among(self) -> str:
        """Name of the noise of those recordings in the reference that lack the same: how far theirs went."""
        if self.no_opening:
            return "noise_without_opening"
        return "noise_without_drop" if self.no_drop else "noise"


# of so many valves one is unlike the reference, whatever is known of it, and by up to so many times
_ONE_OF, _UP_TO = 11, 30.0
# a rehearsal quieter than this share of what is typical says no more of a valve than one as quiet
_QUIET = 0.5
_TIMES = np.geomspace(1.0, _UP_TO, 69)
#: Looks at the effects, and all looks at a recording, each with a table of its own. What drives the stem is
#: looked at by itself: chance makes another thing of it.
OF_EFFECTS = ("throughout", "stem", "within")
LOOKS = (*OF_EFFECTS, "residual")
# looks of which neither tells how strong chance is in the other
_UNRELATED = {"throughout": ("stem",), "stem": ("throughout",)}
#: Covariates that are held within their range in the reference, besides the noise.
EDGED = ("travel", "held_opening", "held_flow")


@dataclass(frozen=True)
class Table:
    r"""Distribution of a strength among healthy recordings, relative to what is typical in the covariates.

    The typical strength is the exponential of a linear function of the covariates, of which noise, travel
    and dead bands are held within their range in the reference. Relative to it the chance of more falls as in
    the reference up to a threshold, linearly between quantiles, and from there on as the generalised Pareto
    law has it,

    .. math:: P(v) = P_u \left(1 + \xi \frac{v^2 - u^2}{\sigma}\right)^{-1/\xi}

    to which excesses over a high threshold tend (Pickands, Annals of Statistics 3, 1975): those of squares,
    for strengths are normal deviations. Its shape is held at zero or above, so that no strength, however
    large, is impossible.

    Parameters
    ----------
    recordings : int
        Number of healthy recordings.
    offset : float
        Logarithm of the typical strength where all covariates are zero.
    slopes : dict
        Covariate -> change of that logarithm.
    ranges : dict
        Covariate -> (lowest, highest) in the reference, beyond which its edge is taken: of travel and dead
        bands, and of the noise among recordings that lack neither opening nor drop, one, or the other.
    quantiles : tuple of float
        Of the relative strength, at equally spaced probabilities from 0 to that of the threshold.
    above : float
        Share of the reference above the threshold, the last quantile.
    scale, shape : float
        Of the tail.
    times, weights : tuple of float, default=(1,)
        How many times as strong chance may be in the valve in question as in those of the reference, and how
        probable that is.
    """

    recordings: int
    offset: float
    slopes: dict[str, float]
    ranges: dict[str, tuple[float, float]]
    quantiles: tuple[float, ...]
    above: float
    scale: float
    shape: float
    times: tuple[float, ...] = (1.0,)
    weights: tuple[float, ...] = (1.0,)

    def typical(self, covariates: Covariates) -> float:
        """Typical strength of healthy recordings."""
        noise = float(np.clip(covariates.noise, *self.ranges[covariates.noise_among]))
        edged = {c: float(np.clip(getattr(covariates, c), *self.ranges[c])) for c in EDGED}
        within = replace(covariates, noise=noise, **edged)
        return float(np.exp(self.offset + sum(s * getattr(within, c) for c, s in self.slopes.items())))


@dataclass(frozen=True)
class NullLaw:
    """How strong evidence gets by chance in recordings that are held against the same thing.

    Parameters
    ----------
    throughout, stem, within, residual : Table
        Of the strongest effect that acts throughout on valve and meters, of the strongest that does on
        positioner and actuator, of the strongest that begins within the recording, and of what is left over,
        as `Evidence` has them.
    """

    throughout: Table
    stem: Table
    within: Table
    residual: Table

    @property
    def tables(self) -> dict[str, Table]:
        """Table of each look at a recording."""
        return {look: getattr(self, look) for look in LOOKS}

    def with_rehearsals(self, rehearsals: Iterable[Rehearsal]) -> NullLaw:
        r"""The same law, with what one valve made of parts of its own history.

        Chance is s times as strong in a valve as in those of the reference. Before anything is known s is 1
        in ten of eleven valves, and in the eleventh anything from 1 to 30, its logarithm as probable
        everywhere. Each rehearsal tells of s by the largest of its looks, relative to what is typical: its
        law under s is that of the largest among the reference, s times as large, the looks taken for
        independent. Without a rehearsal the law is that of the reference.

        What drives the stem, and what valve and meters do, have an s each: a stem that never rests says
        nothing of the flow at a given opening. The other looks tell of both, and are scaled by both.

        Parameters
        ----------
        rehearsals : iterable of Rehearsal
        """
        tables, known = self.tables, [asdict(each) for each in rehearsals]
        if not known:
            return self
        scaled = {}
        for look, table in tables.items():
            of_it = [each for each in tables if each not in _UNRELATED.get(look, ())]
            weights = _weights_of(known, {each: tables[each] for each in of_it})
            scaled[look] = replace(table, times=tuple(_TIMES.tolist()), weights=tuple(weights.tolist()))
        return NullLaw(**scaled)


def _weights_of(rehearsals: Iterable[dict[str, float | None]], tables: dict[str, Table]) -> np.ndarray:
    """How probable it is that chance is so many times as strong, by what some looks saw in rehearsals."""
    weights = np.full(len(_TIMES), 1.0 / (_ONE_OF * (len(_TIMES) - 1)))
    weights[0] = 1.0 - 1.0 / _ONE_OF
    for looks in rehearsals:
        seen = {look: v for look, v in looks.items() if v is not None and look in tables}
        largest = float(np.clip(max(seen.values(), default=0.0), _QUIET, _UP_TO))
        some = [tables[look] for look in seen]
        weights = weights * [
            _beyond(some, 0.95 * largest / s) - _beyond(some, 1.05 * largest / s) for s in _TIMES
        ]
        weights /= weights.sum()
    return weights


def _law_of(name: str) -> NullLaw:
    """Law of a file beside this one, which says by which command it was made."""
    stored = json.loads(files(__package__).joinpath(name).read_text(encoding="utf-8"))
    return NullLaw(**{look: Table(**stored[look]) for look in LOOKS})


#: Of recordings held against a data sheet, and against a history of the same valve.
AGAINST_SHEET = _law_of("null_reference.json")
AGAINST_HISTORY = _law_of("null_reference_with_history.json")


def survival(table: Table, effect_size: float, covariates: Covariates) -> float:
    """Share of healthy recordings whose effect size is at least this, of valves like the one in question.

    Parameters
    ----------
    table : Table
    effect_size : float
        Of the look that the table is of.
    covariates : Covariates

    Returns
    -------
    share : float
        Between 0, never reached, and 1; falls as that grows, without a step but that from nothing at all.
    """
    relative = effect_size / table.typical(covariates)
    each = zip(table.times, table.weights, strict=True)
    return min(sum(weight * share_beyond(table, relative / times) for times, weight in each), 1.0)


def _beyond(tables: Iterable[Table], relative: float) -> float:
    """Share of the reference in which the largest of some looks is at least this."""
    below = [np.log1p(-min(share_beyond(table, relative), 1.0 - 1e-16)) for table in tables]
    return float(-np.expm1(sum(below)))


def share_beyond(table: Table, relative: float) -> float:
    """Share of the reference whose strength, relative to what is typical, is at least this.

    Parameters
    ----------
    table : Table
    relative : float
    """
    threshold = table.quantiles[-1]
    if relative <= 0.0:
        # many healthy recordings show nothing at all
        return 1.0
    if relative <= threshold:
        chances = np.linspace(1.0, table.above, len(table.quantiles))
        # below the least of the reference nothing is known but that all are at zero or above
        return float(np.interp(relative, (0.0, *table.quantiles[1:]), chances))
    excess = (relative**2 - threshold**2) / table.scale
    if table.shape < 1e-6:
        return float(table.above * np.exp(-excess))
    return float(table.above * np.exp(-np.log1p(table.shape * excess) / table.shape))
