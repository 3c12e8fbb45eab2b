# SPDX-License-Identifier: BSD-3-Clause
"""A loop known by its command and its value only: does its valve stick?"""

import numpy as np

from sklvalve.mismatch.loop.finding import LoopFinding
from sklvalve.mismatch.loop.forward import forecasts_of
from sklvalve.mismatch.loop.kinds import kind_of_sticking
from sklvalve.mismatch.loop.look import looked
from sklvalve.mismatch.loop.methods import published_methods
from sklvalve.mismatch.loop.oscillation import find_oscillation
from sklvalve.mismatch.loop.sentences import (
    details_of,
    effect_of,
    grade_of,
    held_against,
    judged,
    sampling_of,
)
from sklvalve.mismatch.loop.signals import loop_signals


def diagnose_loop(recording, *, alpha=0.01, random_state=0):
    r"""Say whether the valve of a loop sticks, from command and flow (or another process value) alone.

    .. math:: y = \sum_i c_i\, G_i x + d, \quad c_i \ge 0, \quad x = \text{stick-slip}(u; S, J)

    The stem :math:`x` is either the command or sticks behind it; the process is any mixture of responses
    that do not turn back, of the sign with which the controller can hold the loop; the noise :math:`d` is a
    wander under white noise, coloured further, and may hold an oscillation from outside beside either. Where
    the stem sticks, a second form of friction competes too, and a jump is named alone where it explains the
    value better than play by a distance of 14; play is never named alone. Intervals of sizes are those that
    drawn loops bore out. The command of the same row is replaced by what the rows before foresee of it,
    because a controller answers noise. Evidence is the difference of log likelihood, with all sizes of stem
    searched; its p-value comes from healthy loops drawn at random (docs/loops.md). A band below 17 % of the
    command's movement is no finding, and neither is one of a command that goes one way only, or one beside
    which a smaller band explains the value better.

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
    looks = [looked(part) for part in loop.stretches()]
    # a valve that sticks in one stretch sticks; as many stretches are as many chances
    look = min(looks, key=lambda one: (one.p, -one.evidence))
    probability = min(1.0, len(looks) * look.p)
    verdict, reason = judged(looks, look, probability <= alpha)
    command, stem = look.compared.command, look.compared.stem
    effects, sticks, answers = (), look.tried.stem[stem.stem], stem.mixture @ look.columns[stem.stem]
    share, part = look.share, look.loop
    # rows ahead are forecast by stems of the grid: the finer search has seen them all
    best = _best_of_each_size(look)
    ahead = forecasts_of(look.columns, part.value, part.used, look.sense, command.noise, best)
    if verdict == "named":
        waves = look.compared.waves if stem.rhythm else None
        kind = kind_of_sticking(part, look.foreseen, look.sense, command, waves)
        effects = (effect_of(kind, look, grade_of(look, ahead.helps)),)
        sticks, answers = kind.stem, kind.fit.mixture @ kind.columns
        stem, share = kind.fit, kind.stick / part.span
        _, reason = judged(looks, look, True, share)
    verdict, compared = held_against(verdict, ahead)
    plain = _levelled(command.mixture @ look.columns[0], part.value)
    predictions = {
        "time": part.time,
        "stem": sticks,
        "nominal": plain,
        "corrected": _levelled(answers, part.value) if ahead.helps else plain,
    }
    fit = {
        "held_out_rows": ahead.rows,
        "noise_floor": float(np.sqrt(np.mean(stem.innovations**2))),
        "rmse": ahead.rmse,
    }
    oscillation, methods = published(recording)
    sampling, said = sampling_of(loop, looks, look, recording.sample_time)
    return LoopFinding(
        verdict,
        probability,
        alpha,
        look.evidence,
        float(share),
        effects,
        fit,
        predictions,
        (reason, *compared, *said),
        sampling,
        oscillation,
        methods,
        tuple(details_of(looks, look)),
    )


def published(recording):
    """The loop's oscillation, and what published methods say of it, on every recorded row.

    They are reported, and do not decide: on 525 drawn loops none that has limits of its own adds to the
    evidence (docs/loops.md).

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    oscillation : dict
    methods : tuple of dict
    """
    role = "flow" if "flow" in recording else "process_value"
    is_flow = True if role == "flow" else None
    signals = recording["command"], recording[role], recording.sample_time
    setpoint = recording.get("setpoint")
    oscillation = find_oscillation(*signals, setpoint)
    results = published_methods(*signals, oscillation=oscillation, setpoint=setpoint, is_flow=is_flow)
    return oscillation.to_dict(), tuple(result.to_dict() for result in results)


def _best_of_each_size(look):
    sizes, likelihoods = look.tried.stick[1:], look.compared.likelihoods[1:]
    return [1 + int(np.argmax(np.where(sizes == size, likelihoods, -np.inf))) for size in np.unique(sizes)]


def _levelled(run, value):
    out = run.copy()
    for rows in np.array_split(np.arange(len(value)), 4):
        out[rows] += np.mean(value[rows] - run[rows])
    return out
