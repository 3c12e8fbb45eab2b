# SPDX-License-Identifier: BSD-3-Clause
"""A loop known by its command and its value only: does its valve stick?"""

from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sklvalve.mismatch.loop.classify import classify_sticking
from sklvalve.mismatch.loop.finding import LoopFinding
from sklvalve.mismatch.loop.fit import LoopFit
from sklvalve.mismatch.loop.forecasts import Forecasts, forecast_errors
from sklvalve.mismatch.loop.methods import published_methods
from sklvalve.mismatch.loop.oscillation import find_oscillation
from sklvalve.mismatch.loop.signals import loop_signals, value_role
from sklvalve.mismatch.loop.stretch import StretchResult, examine_stretch
from sklvalve.mismatch.loop.verdict import (
    check_by_forecasts,
    effect_of,
    format_details,
    format_named,
    grade_of,
    judge_undetected,
    sampling_of,
)
from sklvalve.recording.recording import Recording


def diagnose_loop(recording: Recording, *, alpha: float = 0.01, random_state: int = 0) -> LoopFinding:
    r"""Say whether the valve of a loop sticks, from command and flow (or another process value) alone.

    .. math:: y = \sum_i c_i\, G_i x + d, \quad c_i \ge 0, \quad x = \text{stick-slip}(u; S, J)

    The stem :math:`x` is either the command or sticks behind it. The process is any mixture of responses
    that do not turn back, of the sign with which the controller can hold the loop. The noise :math:`d` is a
    wander under white noise, coloured further, and may hold an oscillation from outside beside either. The
    command of the same row is replaced by its forecast from the rows before, because a controller answers
    noise.

    Evidence is the difference of log likelihood, with all sizes of stem searched. Its p-value comes from
    healthy loops drawn at random (:doc:`/loops`). A band below 17 % of the command's movement is no finding,
    and neither is one of a command that goes one way only, or one beside which a smaller band explains the
    value better. A jump is named alone where it explains the value better than play by a distance of 14; play
    is never named alone. Two forms of friction compete. Intervals of sizes are those that drawn loops bore
    out.

    Valid for a valve that moves faster than it is sampled, and a process that is nearly linear over the
    record but for a curved valve or a gain that drifts. Rows are averaged only where some 30 are left to a
    period of the loop.

    Parameters
    ----------
    recording : Recording
        Roles `command` and `flow`, or `command` and `process_value` for a level, pressure or temperature, or
        for a value of unknown kind; `setpoint` helps where it was recorded.
    alpha : float, default=0.01
        Level of the test.
    random_state : int, default=0
        Kept for the convention: nothing here is drawn.

    Returns
    -------
    finding : LoopFinding

    Raises
    ------
    InputError
        If the flow is near zero, a signal is constant or at its limit, or rows are too few.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.mismatch.loop import diagnose_loop, stick_slip
    >>> from sklvalve.recording import Recording
    >>> rng = np.random.default_rng(0)
    >>> time = 10.0 * np.arange(400)
    >>> swings = 0.02 * np.sin(time / 300.0) + 0.015 * np.sin(time / 127.0)
    >>> command = 0.5 + swings + 0.0005 * rng.standard_normal(400)
    >>> flow = 0.01 * stick_slip(command, stick=0.02, slip=0.0) + 2e-5 * rng.standard_normal(400)
    >>> found = diagnose_loop(Recording.from_frame({"time": time, "command": command, "flow": flow}))
    >>> found.verdict
    'named'
    """
    if not 0.0 < alpha < 1.0:
        raise ValueError(f"alpha must lie between 0 and 1, and is {alpha}; give a level such as 0.01")
    loop = loop_signals(recording)
    results = [examine_stretch(part) for part in loop.stretches()]
    # a valve that sticks in one stretch sticks; as many stretches are as many chances
    result = min(results, key=lambda each: (each.p_value, -each.evidence))
    p_value = min(1.0, len(results) * result.p_value)
    forecasts = _forecast_errors(result)
    effects: list[dict[str, Any]] = []
    if p_value <= alpha:
        # of sizes finer than the grid
        sticking = classify_sticking(result)
        fit, position, band = sticking.fit, sticking.stem, sticking.stick / result.loop.span
        effects.append(effect_of(sticking, result.loop, grade_of(result, forecasts.helps)))
        verdict, reason = "named", format_named(band, result.loop.span)
    else:
        fit, band = result.comparison.sticking, result.band_share
        position = result.candidates.stem[fit.index]
        verdict, reason = judge_undetected(results, result)
    verdict, of_forecasts = check_by_forecasts(verdict, forecasts)
    noise_floor = float(np.sqrt(np.mean(fit.innovations**2)))
    sampling, of_sampling = sampling_of(loop, results, result)
    oscillation, methods = _published_results(recording)
    return LoopFinding(
        verdict=verdict,
        p_value=p_value,
        alpha=alpha,
        evidence=result.evidence,
        band=band,
        effects=tuple(effects),
        fit={"held_out_rows": forecasts.rows, "noise_floor": noise_floor, "rmse": forecasts.rmse},
        predictions=_predictions(result, position, fit if forecasts.helps else result.comparison.command),
        reasons=(reason, *of_forecasts, *of_sampling),
        sampling=sampling,
        oscillation=oscillation,
        methods=methods,
        details=format_details(results, result),
    )


def _forecast_errors(result: StretchResult) -> Forecasts:
    """Errors on rows ahead, by the best stem of each size of the grid: the finer search has seen all rows."""
    sizes, likelihoods = result.candidates.stick[1:], result.comparison.screening.log_likelihoods[1:]
    best = [1 + int(np.argmax(np.where(sizes == size, likelihoods, -np.inf))) for size in np.unique(sizes)]
    command = result.comparison.command
    return forecast_errors(command.regression, command.noise_filter, best)


def _predictions(result: StretchResult, position: NDArray, corrected: LoopFit) -> dict[str, NDArray]:
    """Free runs of the value, each at the recorded level in every quarter of the stretch."""
    runs = {"nominal": result.comparison.command.response, "corrected": corrected.response}
    value = result.loop.value
    quarters = np.array_split(np.arange(len(value)), 4)
    levelled = {
        kind: np.concatenate([run[rows] + np.mean(value[rows] - run[rows]) for rows in quarters])
        for kind, run in runs.items()
    }
    return {"time": result.loop.time, "stem": position, **levelled}


def _published_results(recording: Recording) -> tuple[dict[str, Any], tuple[dict[str, Any], ...]]:
    """The loop's oscillation, and what published methods say of it, on every recorded row."""
    role = value_role(recording)
    signals = recording["command"], recording[role], recording.sample_time
    setpoint = recording.get("setpoint")
    oscillation = find_oscillation(*signals, setpoint)
    results = published_methods(
        *signals, oscillation=oscillation, setpoint=setpoint, is_flow=True if role == "flow" else None
    )
    return asdict(oscillation), tuple(asdict(result) for result in results)
