# SPDX-License-Identifier: BSD-3-Clause
"""A loop's value forecast from its own past: by the command, by a stem that sticks, and by a black box."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sklvalve.mismatch.constants import MARGIN
from sklvalve.mismatch.inference.origins import ORIGINS, enough, spans_of
from sklvalve.mismatch.loop.fit import NoiseFilter, Regression, fit_weights

_LEVEL_ROWS = 10  # before an origin, that set the level


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
    rmse: dict[str, float]
    consistent: int

    @property
    def ratio(self) -> float:
        """Error of the command's forecast over that of the black box."""
        return self.rmse["nominal"] / max(self.rmse["black_box"], 1e-300)

    @property
    def clearly_better(self) -> bool:
        """Whether the black box is better than the command alone by the margin, and nearly everywhere."""
        return self.ratio >= MARGIN and self.consistent >= enough(len(ORIGINS) - 1)

    @property
    def helps(self) -> bool:
        """Whether the stem that sticks forecasts better than the command."""
        return self.rmse["corrected"] < self.rmse["nominal"]


def forecast_errors(regression: Regression, noise_filter: NoiseFilter, stems: Sequence[int]) -> Forecasts:
    """Errors of `forecast_from_origins`; parameters as there."""
    value = regression.value
    forecasts = forecast_from_origins(regression, noise_filter, stems)
    rows = regression.used & np.isfinite(forecasts["nominal"])
    squares = {kind: np.where(rows, run - value, 0.0) ** 2 for kind, run in forecasts.items()}
    box, nominal = squares["black_box"], squares["nominal"]
    better = sum(bool(box[span].sum() < nominal[span].sum()) for span in spans_of(len(value)))
    count = max(int(rows.sum()), 1)
    rmse = {kind: float(np.sqrt(square.sum() / count)) for kind, square in squares.items()}
    return Forecasts(int(rows.sum()), rmse, better)


def forecast_from_origins(
    regression: Regression, noise_filter: NoiseFilter, stems: Sequence[int]
) -> dict[str, NDArray]:
    """Free runs from each origin to the next, by weights fitted to the rows before it.

    The black box is any mixture of the responses to all stems at once, a model of hysteresis (Prandtl and
    Ishlinskii) with weights of one sign, so that it cannot be the controller read backwards. The level,
    which wanders in any loop, is that of the ten rows before the origin.

    Parameters
    ----------
    regression : Regression
        Its first stem is the command.
    noise_filter : tuple of float
        By which errors are weighed.
    stems : sequence of int
        Stems that may be chosen, at each origin anew.

    Returns
    -------
    forecasts : dict
        ``nominal, corrected, black_box`` -> ndarray of shape (n,) [value's unit]; NaN before the first
        origin.
    """
    columns, value = regression.responses, regression.value
    n = len(value)
    choices = {
        "nominal": [columns[0]],
        "corrected": [columns[stem] for stem in stems],
        "black_box": [np.concatenate(columns[[0, *stems]])],
    }
    forecasts = {kind: np.full(n, np.nan) for kind in choices}
    for span in spans_of(n):
        past = regression.used & (np.arange(n) < span.start)
        for kind, tried in choices.items():
            run = _free_run(tried, value, past, regression.gain_sign, noise_filter)
            level = np.mean((value - run)[max(span.start - _LEVEL_ROWS, 0) : span.start])
            forecasts[kind][span] = run[span] + level
    return forecasts


def _free_run(
    choices: list[NDArray], value: NDArray, past: NDArray[np.bool_], gain_sign: int, noise_filter: NoiseFilter
) -> NDArray:
    """The free run by those responses that leave least of the whitened past."""
    fits = [(*fit_weights(columns, value, past, gain_sign, noise_filter), columns) for columns in choices]
    weights, _, columns = min(fits, key=lambda fit: fit[1])
    return weights @ columns
