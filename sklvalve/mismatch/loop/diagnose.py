# SPDX-License-Identifier: BSD-3-Clause
"""A loop known by its command and its value only: does its valve stick?"""

import numpy as np

from sklvalve.mismatch.loop.evidence import p_value
from sklvalve.mismatch.loop.finding import LoopFinding
from sklvalve.mismatch.loop.fit import fit_stems
from sklvalve.mismatch.loop.held_out import held_out
from sklvalve.mismatch.loop.kinds import kind_of_sticking
from sklvalve.mismatch.loop.operators import candidates
from sklvalve.mismatch.loop.process import foreseen_command, responses, sense_of_process
from sklvalve.mismatch.loop.signals import loop_signals

_MATTERS = 0.2  # of the command's movement; less is the play that every valve has
_LARGE = 0.3
_EXCLUDED = 4.0  # difference of log likelihood
_VISIBLE = 4.0


def diagnose_loop(recording, *, alpha=0.01, random_state=0):
    r"""Say whether the valve of a loop sticks, from command and flow (or another process value) alone.

    .. math:: y = \sum_i c_i\, G_i x + d, \quad c_i \ge 0, \quad x = \text{stick-slip}(u; S, J)

    The stem :math:`x` is either the command or sticks behind it; the process is any mixture of responses
    that do not turn back, of the sign with which the controller can hold the loop; the noise :math:`d` is a
    wander under white noise, coloured further and, for the command's own model, with an oscillation from
    outside. Where the stem sticks, a second form of friction competes too, and a jump is named alone where it
    explains the value better than play by a distance of 14; play is never named alone. Intervals of sizes are
    those that drawn loops bore out. The command of the same row is replaced by what the rows before foresee
    of it, because a controller answers noise. Evidence is the difference of log likelihood, with all sizes of
    stem searched; its p-value comes from healthy loops drawn at random (docs/loops.md). A band below 20 % of
    the command's movement is no finding.

    Valid for a valve that moves faster than it is sampled, sampled faster than the loop swings (ten rows or
    more in a period), and a process that is nearly linear over the record.

    Parameters
    ----------
    recording : Recording
        Roles `command` and `flow`, or `command` and `process_value` for a level, pressure or temperature;
        `setpoint` helps. Rows are thinned to 10 s or more.
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
    foreseen = foreseen_command(loop.command, loop.value, loop.setpoint)
    tried = candidates(loop.command, foreseen, loop.span)
    columns = responses(tried.stem, tried.ahead, not loop.is_flow)
    sense = 1 if loop.is_flow else sense_of_process(loop.command, loop.value, loop.setpoint)
    likelihoods, silent, command, stem = fit_stems(columns, loop.value, loop.used, sense)
    evidence = stem.log_likelihood - command.log_likelihood
    share = tried.stick[stem.stem] / loop.span
    probability = p_value(evidence, loop.is_flow) if share >= _MATTERS else 1.0
    shares = tried.stick[1:] / loop.span
    large = float(likelihoods[1:][shares >= _LARGE].max() - likelihoods[0])
    answer = float(likelihoods[0] - silent)
    verdict, reason = _judged(probability <= alpha, share, evidence, large, answer, command.rhythm)
    sizes = np.unique(shares)
    best = [1 + int(np.argmax(np.where(shares == size, likelihoods[1:], -np.inf))) for size in sizes]
    effects, sticks, answers = (), tried.stem[stem.stem], stem.mixture @ columns[stem.stem]
    if verdict == "named":
        kind = kind_of_sticking(loop, foreseen, sense, command)
        effects = (_effect(kind, loop.span, probability),)
        sticks, answers = kind.stem, kind.fit.mixture @ kind.columns
        stem, share = kind.fit, kind.stick / loop.span
        _, reason = _judged(True, share, evidence, large, answer, command.rhythm)
    # quarters are foretold by stems of the grid: the finer search has seen them all
    nominal, corrected = held_out(columns, loop.value, loop.used, sense, command.noise, best)
    predictions = {
        "time": loop.time,
        "stem": sticks,
        "nominal": _levelled(command.mixture @ columns[0], loop.value),
        "corrected": _levelled(answers, loop.value),
    }
    fit = {
        "held_out_rows": int(loop.used.sum()),
        "noise_floor": float(np.sqrt(np.mean(stem.innovations**2))),
        "rmse": {
            "nominal": _rmse(nominal - loop.value, loop.used),
            "corrected": _rmse(corrected - loop.value, loop.used),
        },
    }
    return LoopFinding(
        verdict, probability, alpha, float(evidence), float(share), effects, fit, predictions, (reason,)
    )


def _judged(found, share, evidence, large, answer, rhythm):
    """Verdict and the sentence it rests on; `large` and `answer` compare wide bands and no answer at all."""
    band = f"A band of {share:.0%} of the command's movement"
    if found:
        return "named", f"{band} explains the value better than the command itself ({evidence:.0f} nats)."
    if answer <= _VISIBLE:
        return "cannot_tell", "The value does not visibly follow the command in this record."
    if large < -_EXCLUDED:
        return "no_mismatch", (
            f"Bands of {_LARGE:.0%} or more of the command's movement explain the value worse than the "
            f"command itself ({-large:.0f} nats)."
        )
    if share < _MATTERS or evidence <= 0.0:
        other = "an oscillation from outside explains" if rhythm else "the command itself explains"
        return "cannot_tell", (
            f"Wide bands are not excluded, but {other} the value as well; a slow ramp of the command through "
            "both directions would tell."
        )
    return "cannot_tell", (
        f"{band} explains the value somewhat better than the command itself ({evidence:.0f} nats), as it "
        "does in healthy loops too; a slow ramp of the command through both directions would tell."
    )


def _effect(kind, span, p):
    """The class of sticking and play, with the sizes of the likeliest stem and how far they are known."""
    whole = float(1.0 - p)
    members = [{"name": name, "probability": whole * share} for name, share in kind.shares.items()]
    members.sort(key=lambda member: -member["probability"])
    parameters = {
        "stick": {"value": kind.stick, "unit": "1", "ci95": list(kind.sticks)},
        "slip": {"value": kind.slip, "unit": "1", "ci95": list(kind.slips)},
    }
    stick, slip = kind.stick, kind.slip
    at_least = " or more" if stick >= 0.95 * span else ""
    return {
        "members": members,
        "probability": whole,
        "blocks": ["actuator"],
        "parameters": parameters,
        "sentence": (
            f"The stem stays until the command has turned by {stick:.2%} of the travel{at_least}, and then "
            + (
                "follows; whether with a jump is not told."
                if "backlash" in kind.shares
                else f"jumps by {slip:.2%}."
            )
        ),
        "separated_by": (
            "Ramp the command slowly through a reversal with the stem's position recorded: a jump is "
            "stiction, a smooth start is play."
        ),
    }


def _levelled(run, value):
    out = run.copy()
    for rows in np.array_split(np.arange(len(value)), 4):
        out[rows] += np.mean(value[rows] - run[rows])
    return out


def _rmse(error, used):
    return float(np.sqrt(np.mean(error[used] ** 2)))
