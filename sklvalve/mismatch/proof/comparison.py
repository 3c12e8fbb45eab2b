# SPDX-License-Identifier: BSD-3-Clause
"""How the simulation, before and after its correction, compares with a black box on rows ahead in time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.constants import MARGIN, MARGIN_OF_A_DROP
from sklvalve.mismatch.inference.origins import enough
from sklvalve.mismatch.search.scatter import scatter_of_sum
from sklvalve.simulation.calibration import drop_is_unknown

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.proof.forward import Forward

_TINY = 1e-300


@dataclass(frozen=True, eq=False)
class Compared:
    """Errors of one channel on rows ahead in time.

    Parameters
    ----------
    channel : str
    rows : int
    rmse : dict
        ``nominal, corrected, black_box`` -> root mean square error [SI].
    losses : dict
        The same, mean square errors in units of what counts [1].
    consistent : int
        Stretches in which the black box is better than the corrected simulation.
    exogenous : bool
        Whether nothing unrecorded can have moved the channel as the black box has it: a flow whose pressure
        drop nobody recorded follows that first of all.
    closed : bool
        Whether a controller answers the channel.
    added : ndarray of shape (n,)
        What the correction adds to the mean square error in each row, in units of what counts; zero in rows
        that are not forecast [1].
    stretches : int
        Of how many.
    """

    channel: str
    rows: int
    rmse: dict[str, float]
    losses: dict[str, float]
    consistent: int
    exogenous: bool
    closed: bool
    added: np.ndarray
    stretches: int = 4

    @property
    def ratio(self) -> float:
        """Error of the corrected simulation over that of the black box."""
        return self.rmse["corrected"] / max(self.rmse["black_box"], _TINY)

    @property
    def clearly_better(self) -> bool:
        """Whether the black box is better by the margin, by more than what counts, and nearly everywhere."""
        gap = self.losses["corrected"] - self.losses["black_box"]
        asked = enough(self.stretches) if self.exogenous else self.stretches
        return self.ratio >= self.margin and gap >= 1.0 and self.consistent >= asked

    @property
    def margin(self) -> float:
        """Ratio from which on the black box is clearly better."""
        return MARGIN if self.exogenous else MARGIN_OF_A_DROP


def compare(problem: Problem, forward: Forward) -> tuple[Compared, ...]:
    """Errors of every channel that can be forecast.

    Parameters
    ----------
    problem : Problem
    forward : Forward

    Returns
    -------
    compared : tuple of Compared
    """
    compared = []
    for c in problem.channels:
        recorded = problem.recording[c]
        errors = {kind: recorded - made[c] for kind, made in forward.predictions.items()}
        known = forward.held & np.all([np.isfinite(e) for e in errors.values()], axis=0)
        if not known.any():
            continue
        squares = {kind: np.where(known, e, 0.0) ** 2 for kind, e in errors.items()}
        # a stretch that holds a gap only speaks for neither
        spans = [span for span in forward.spans if known[span].any()]
        better = sum(
            bool(squares["black_box"][span].sum() < squares["corrected"][span].sum()) for span in spans
        )
        means = {kind: float(s.sum() / known.sum()) for kind, s in squares.items()}
        size = max((problem.least(c) * problem.spans[c]) ** 2, _TINY)
        compared.append(
            Compared(
                c,
                int(known.sum()),
                {kind: float(np.sqrt(mean)) for kind, mean in means.items()},
                {kind: mean / size for kind, mean in means.items()},
                better,
                not (c == "flow" and drop_is_unknown(problem.recording)),
                forward.closed[c],
                (squares["corrected"] - squares["nominal"]) / (size * known.sum()),
                len(spans),
            )
        )
    return tuple(compared)


def pooled(compared: Iterable[Compared], kind: str) -> float:
    """Mean square error of all channels together, each in units of what counts [1]."""
    return float(sum(each.losses[kind] for each in compared))


def rise(problem: Problem, compared: Sequence[Compared], held: np.ndarray) -> float:
    """What a correction adds to the squared error of rows ahead in time, in standard errors of itself.

    The standard error is that of the sum over stretches of a minute, or of a sixteenth of the rows where
    these are shorter: errors of a simulation last, and rows next to each other say the same. It counts as no
    larger than the squared error that is there without the correction: one stretch that is all the rise
    makes a standard error as large as itself, and a doubled error is no chance.

    Parameters
    ----------
    problem : Problem
    compared : sequence of Compared
    held : ndarray of bool, shape (n,)
        Rows that are forecast, the last ones.

    Returns
    -------
    errors : float
        Below zero where the correction helps; infinite where no error was there before [1].
    """
    if not compared:
        return 0.0
    added = sum((each.added for each in compared), np.zeros(len(held)))[held]
    total, error = float(added.sum()), min(scatter_of_sum(problem, added), pooled(compared, "nominal"))
    if error > 0.0:
        return total / error
    return float(np.sign(total)) * np.inf if total else 0.0


def share_explained(compared: Sequence[Compared]) -> float | None:
    """Share of what can be forecast beyond the nominal that the correction accounts for; None without any."""
    before, after = pooled(compared, "nominal"), pooled(compared, "corrected")
    best = sum(min(each.losses["black_box"], each.losses["corrected"]) for each in compared)
    return (before - after) / (before - best) if before - best > 0.0 else None


def skills_ahead(problem: Problem, compared: Iterable[Compared]) -> dict[str, float | None]:
    """Share of the squared error beyond noise that a correction removes from rows ahead in time, by channel.

    Parameters
    ----------
    problem : Problem
        Whose noise has a floor in each channel.
    compared : sequence of Compared

    Returns
    -------
    skills : dict
        Channel -> share; None where the nominal simulation leaves no more than noise.
    """
    skills = {}
    for each in compared:
        floor = problem.noise[each.channel].floor ** 2
        before, after = (each.rmse[kind] ** 2 for kind in ("nominal", "corrected"))
        skills[each.channel] = (before - after) / (before - floor) if before > floor else None
    return skills
