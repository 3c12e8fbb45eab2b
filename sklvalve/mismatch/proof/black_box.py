# SPDX-License-Identifier: BSD-3-Clause
"""The rival that knows no physics: an LS-SVM on the signals, or in a closed loop responses of one sign."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from sklvalve.lssvm import LSSVMRegressor
from sklvalve.lssvm.held_out import least_in_error
from sklvalve.mismatch.loop.process import forecast_command
from sklvalve.mismatch.proof.feedback import driver_of
from sklvalve.mismatch.proof.one_sign import one_sign_predictions
from sklvalve.recording import Recording
from sklvalve.recording.gaps import filled

LAGS = (0, 1, 2, 3, 5, 8, 13, 21, 34)
# rows learnt from at most, and how many of them span what is learnt: as good on later rows as all of them
_MOST_ROWS, _LANDMARKS = 6000, 200
# of fewer rows nothing is learnt but their mean
_FEWEST = 40
_TUNED_ON = 600
# those first that mostly turn out best: the others are given up early, then
_GAMMAS, _WEIGHTS = (0.01, 0.05, 0.2), (1000.0, 10.0)


def black_box_ahead(
    recording: Recording, channel: str, spans: Sequence[slice], *, closed: bool
) -> np.ndarray:
    """Forecasts of a channel by a black box, each span by what is learnt from the rows before it.

    Parameters
    ----------
    recording : Recording
    channel : {"opening", "flow"}
    spans : sequence of slice
        The first one first.
    closed : bool
        Whether a controller answers the channel by the driver. An LS-SVM on lagged commands would learn the
        controller backwards there, so responses of one sign take its place (`one_sign_predictions`).

    Returns
    -------
    predicted : ndarray of shape (n,)
        NaN outside the spans [SI].
    """
    n = len(recording)
    made = np.full(n, np.nan)
    if closed:
        ahead = _of_one_sign(recording, channel, [span.start for span in spans])
        for span, run in zip(spans, ahead, strict=True):
            made[span] = run[span]
        return made
    settings = settings_of(recording, channel, np.arange(n) < spans[0].start)
    for span in spans:
        past = np.arange(n) < span.start
        made[span] = black_box_prediction(recording, channel, past, at=span, settings=settings)
    return made


def black_box_prediction(
    recording: Recording,
    channel: str,
    train: np.ndarray,
    *,
    at: slice | None = None,
    settings: tuple[float, float] | None = None,
) -> np.ndarray:
    """Prediction of a channel by an LS-SVM that saw the `train` rows only.

    Where a controller answers the channel by the driver it would learn the controller backwards
    (`black_box_ahead`).

    Parameters
    ----------
    recording : Recording
    channel : {"opening", "flow"}
    train : ndarray of bool, shape (n,)
    at : slice, default=None
        Rows to predict; all unless given.
    settings : (float, float), default=None
        Those of `settings_of` for some of the `train` rows; of all of them unless given.

    Returns
    -------
    predicted : ndarray of shape (n,), or of the rows asked for
        [SI]
    """
    at = slice(None) if at is None else at
    learnt = _learnt_from(recording, channel, train)
    if learnt is None:
        y = recording[channel]
        return np.full(len(y), np.nanmean(y[train] if np.isfinite(y[train]).any() else y))[at]
    rows, Z, y, size = learnt
    gamma, C = settings or _best(rows, Z, y)
    box = LSSVMRegressor(gamma=gamma, C=C, solver="nystrom", n_landmarks=_LANDMARKS, random_state=0, n_jobs=1)
    many = _spread(rows, _MOST_ROWS)
    return box.fit(Z[many], y[many]).predict(Z[at]) * size


def settings_of(recording: Recording, channel: str, train: np.ndarray) -> tuple[float, float] | None:
    """Width of the kernel and weight of the errors that suit the `train` rows; None where these are too few.

    They serve for later origins as well: chosen anew at each they forecast no better, unless the rows were
    fewer than a choice is made on.

    Parameters
    ----------
    recording, channel, train
        As `black_box_prediction` takes them.
    """
    learnt = _learnt_from(recording, channel, train)
    return None if learnt is None or len(learnt[0]) < _TUNED_ON else _best(*learnt[:3])


def _learnt_from(
    recording: Recording, channel: str, train: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float] | None:
    """Rows to learn from, scaled inputs and values of all rows, and the values' unit; None where too few."""
    X, y = lagged_signals(recording, channel), recording[channel]
    rows = np.flatnonzero(train & np.isfinite(y))
    # what stood still in the rows learnt from tells nothing there
    X = X[:, X[rows].std(axis=0) > 0.0] if len(rows) else X[:, :0]
    if len(rows) < _FEWEST or not X.shape[1]:
        return None
    size = y[rows].std() + 1e-30
    return rows, (X - X[rows].mean(axis=0)) / (X[rows].std(axis=0) + 1e-12), y / size, size


def _best(rows: np.ndarray, Z: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Width of the kernel and weight of the errors that predict quarters of the rows best."""
    few = _spread(rows, _TUNED_ON)
    return least_in_error(Z[few], y[few], gammas=_GAMMAS, Cs=_WEIGHTS, blocks=_quarters(len(few)))


def _spread(rows: np.ndarray, most: int) -> np.ndarray:
    """So many of the rows at most, evenly spread over them."""
    return rows[np.linspace(0, len(rows) - 1, min(most, len(rows))).astype(int)]


def lagged_signals(recording: Recording, channel: str) -> np.ndarray:
    """Inputs of the LS-SVM: the driver with its lags, and pressures and temperature as they are."""
    signal = filled(recording[driver_of(recording, channel)])
    columns = [np.concatenate([np.full(k, signal[0]), signal[: len(signal) - k]]) for k in LAGS]
    if channel == "flow":
        extra = [r for r in ("p1", "p2", "temperature") if r in recording and r not in recording.constants]
        columns += [filled(recording[r]) for r in extra]
    return np.column_stack(columns)


def _of_one_sign(recording: Recording, channel: str, origins: Sequence[int]) -> list[np.ndarray]:
    """Of each origin a prediction of all rows by responses of one sign, learnt from the rows before it."""
    driver, value = filled(recording[driver_of(recording, channel)]), filled(recording[channel])
    weight = None
    if channel == "flow" and "p1" in recording and "p2" in recording:
        drop = np.sqrt(np.maximum(filled(recording["p1"] - recording["p2"]), 0.0))
        weight = drop / max(drop.mean(), 1e-12)
    forecast = forecast_command(driver, value, recording.get("setpoint"))
    return one_sign_predictions(driver, value, origins, forecast=forecast, weight=weight)


def _quarters(n: int) -> list[slice]:
    return [slice(low, high) for low, high in pairwise(np.linspace(0, n, 5).astype(int))]
