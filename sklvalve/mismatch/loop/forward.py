# SPDX-License-Identifier: BSD-3-Clause
"""A loop's value forecast from its own past: by the command, by a stem that sticks, and by a black box."""

from dataclasses import dataclass

import numpy as np

from sklvalve.mismatch.decide.constants import MARGIN
from sklvalve.mismatch.loop.fit import mixture_of
from sklvalve.mismatch.origins import ORIGINS, enough, spans_of

_BEFORE = 10  # rows before an origin that set the level


@dataclass(frozen=True)
class Forecasts:
    """Errors of forecasts of a loop's value.

    Parameters
    ----------
    rows : int
    rmse : dict
        ``nominal, corrected, black_box`` -> root mean square error [value's unit].
    consistent : int
        Stretches in which the black box is better than the command alone.
    """

    rows: int
    rmse: dict
    consistent: int

    @property
    def ratio(self):
        """Error of the command's forecast over that of the black box."""
        return self.rmse["nominal"] / max(self.rmse["black_box"], 1e-300)

    @property
    def clearly_better(self):
        """Whether the black box is better than the command alone by the margin, and nearly everywhere."""
        return self.ratio >= MARGIN and self.consistent >= enough(len(ORIGINS) - 1)

    @property
    def helps(self):
        """Whether the stem that sticks forecasts better than the command."""
        return self.rmse["corrected"] < self.rmse["nominal"]


def forecasts_of(columns, value, used, sense, noise, places):
    """Errors of `forward_in_time`; parameters as there."""
    made = forward_in_time(columns, value, used, sense, noise, places)
    rows = used & np.isfinite(made["nominal"])
    squares = {kind: np.where(rows, run - value, 0.0) ** 2 for kind, run in made.items()}
    sums = [{kind: square[span].sum() for kind, square in squares.items()} for span in spans_of(len(value))]
    better = sum(bool(each["black_box"] < each["nominal"]) for each in sums)
    many = max(int(rows.sum()), 1)
    rmse = {kind: float(np.sqrt(square.sum() / many)) for kind, square in squares.items()}
    return Forecasts(int(rows.sum()), rmse, better)


def forward_in_time(columns, value, used, sense, noise, places):
    """Free runs from each origin to the next, by what the rows before it give.

    The black box is any mixture of the responses to all stems at once, a model of hysteresis (Prandtl and
    Ishlinskii) with weights of one sign, so that it cannot be the controller read backwards. The level,
    which wanders in any loop, is that of the ten rows before the origin.

    Parameters
    ----------
    columns : ndarray of shape (m, k, n)
        Responses to each stem; the first stem is the command.
    value : ndarray of shape (n,)
    used : ndarray of bool, shape (n,)
    sense : int
    noise : tuple of float
        The noise filter by which errors are weighed.
    places : sequence of int
        Stems that may be chosen, at each origin anew.

    Returns
    -------
    predictions : dict
        ``nominal, corrected, black_box`` -> ndarray of shape (n,); NaN before the first origin.
    """
    n = len(value)
    made = {kind: np.full(n, np.nan) for kind in ("nominal", "corrected", "black_box")}
    every = np.concatenate(columns[[0, *places]])
    for span in spans_of(n):
        past = used & (np.arange(n) < span.start)
        runs = {
            "nominal": _run([columns[0]], value, past, sense, noise),
            "corrected": _run([columns[place] for place in places], value, past, sense, noise),
            "black_box": _run([every], value, past, sense, noise),
        }
        for kind, run in runs.items():
            level = np.mean((value - run)[max(span.start - _BEFORE, 0) : span.start])
            made[kind][span] = run[span] + level
    return made


def _run(choices, value, past, sense, noise):
    """The free run of those columns that leave least of the whitened past."""
    fits = [(*mixture_of(columns, value, past, sense, noise), columns) for columns in choices]
    mixture, _, columns = min(fits, key=lambda fit: fit[1])
    return mixture @ columns
