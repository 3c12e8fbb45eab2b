# SPDX-License-Identifier: BSD-3-Clause
"""Verdict of a loop, the sentences it rests on, and how the class of sticking is graded."""

from sklvalve.mismatch.effects.base import Quantity, Shown
from sklvalve.mismatch.loop.look import FEWEST_TURNS, LARGE, MATTERS

#: Differences of log likelihood from which on a wide band is excluded, and an answer is visible.
_EXCLUDED = 10.0
_VISIBLE = 4.0
#: A smaller band that fits better by this much, or fewer rows to a swing, exclude nothing.
_SMALL = 6.0
_FEWEST_ROWS = 20
#: A grade is strong from this much evidence and this many turns of the command on, weak below the second
#: pair.
_STRONG, _MODERATE = (30.0, 10), (18.0, 5)

#: Parameters of a stem that sticks in a loop, shares of the command's range.
STICK_AND_SLIP = (
    Quantity("stick", "1", 0.0, 1.0, (), shown=Shown("dead band plus stick band", "% of travel", 100.0)),
    Quantity("slip", "1", 0.0, 1.0, (), shown=Shown("slip jump", "% of travel", 100.0)),
)


def judged(looks, look, found, share=None):
    """Verdict, and the sentence it rests on.

    Parameters
    ----------
    looks : sequence of Look
        At every stretch.
    look : Look
        The one that speaks most for sticking.
    found : bool
        Whether its p-value is within the level.
    share : float, optional
        Band as a share of the command's movement, where it is known better than on the grid.

    Returns
    -------
    verdict : {"named", "no_mismatch", "cannot_tell"}
    reason : str
    """
    share = look.share if share is None else share
    evidence = look.evidence
    band = (
        f"A dead band of {_percent(share * look.loop.span)} of the command's range ({_percent(share)} of its "
        "movement)"
    )
    if found:
        return "named", f"{band} explains the value better than the command itself."
    if max(one.answer for one in looks) <= _VISIBLE:
        return "cannot_tell", (
            "The value does not visibly follow the command: the loop moves too little for its noise."
        )
    if all(map(_excludes, looks)):
        return "no_mismatch", (
            f"Dead bands of {_percent(LARGE)} or more of the command's movement explain the value clearly "
            "worse than the command itself."
        )
    if look.turns < FEWEST_TURNS:
        return "cannot_tell", (
            "The command goes one way only, so a dead band looks the same as a supply or a gain that drifts."
        )
    if look.large < -_EXCLUDED:
        return "cannot_tell", (
            "Wide dead bands explain the value clearly worse than the command itself, but "
            f"{_doubt(look)}, so they are not excluded."
        )
    if evidence <= 0.0 and look.excess > 0.0:
        return "cannot_tell", (
            "A dead band explains the value better than the command itself with one noise model, and worse "
            "with another."
        )
    if evidence <= 0.0:
        outside = look.compared.command.rhythm
        other = "an outside oscillation explains" if outside else "the command itself explains"
        return "cannot_tell", f"Wide dead bands are not excluded, but {other} the value as well."
    return "cannot_tell", (
        f"{band} explains the value somewhat better than the command itself, as in healthy loops too."
    )


def details_of(looks, look):
    """What the verdict rests on in figures, for a specialist.

    Parameters
    ----------
    looks : sequence of Look
    look : Look
        The one that speaks most for sticking.

    Returns
    -------
    sentences : list of str
    """
    large = max(one.large for one in looks)
    return [
        f"Log likelihood of the best sticking stem minus that of the command itself: {look.evidence:.0f} "
        f"nats, over {_turns(look)} of the command.",
        f"The same for the best dead band of {_percent(LARGE)} or more of the command's movement: "
        f"{large:.0f} nats.",
    ]


def _doubt(look):
    if len(look.loop.senses) > 1:
        return "it is uncertain whether a larger command raises or lowers the value"
    if _rows(look) < _FEWEST_ROWS:
        return f"one swing of the command has only {_rows(look):.0f} rows"
    if look.excess > 0.0:
        return "a dead band of another size explains it better"
    if look.small >= _SMALL:
        return "a smaller dead band explains it better"
    return "the value does not visibly follow in every part of the recording"


def _turns(look):
    return f"{look.turns} turn{'' if look.turns == 1 else 's'}"


def _percent(share):
    return f"{100.0 * share:.2g} %" if share < 0.995 else f"{100.0 * share:.0f} %"


def _excludes(look):
    """Whether a stretch excludes sticking of a size that matters.

    Of 190 drawn loops that stick 27 had wide bands that explain the value worse by 10 nats, most of them with
    a sign of the response in doubt, with few rows to a swing, or with a smaller band that fits. With fewer
    than 20 rows the command turns unseen between them: seven of twelve drawn loops that were wrongly
    excluded had fewer. Where any band that matters explains the value better, nothing is
    excluded.
    """
    return (
        look.large < -_EXCLUDED
        and look.excess <= 0.0
        and look.answer > _VISIBLE
        and look.small < _SMALL
        and len(look.loop.senses) == 1
        and look.turns >= FEWEST_TURNS
        and _rows(look) >= _FEWEST_ROWS
    )


def _rows(look):
    """Rows from one turn of the command to the next of its kind."""
    return 2.0 * len(look.loop.time) / max(look.turns, 1)


def held_against(verdict, ahead):
    """Verdict held against forecasts of rows ahead in time, and what they add in sentences.

    Parameters
    ----------
    verdict : str
    ahead : Forecasts

    Returns
    -------
    verdict : str
        ``cannot_tell`` in place of ``no_mismatch`` where a black box is clearly better.
    sentences : list of str
    """
    if verdict == "named" and not ahead.helps:
        return verdict, [
            "A simulated sticking stem does not lower the error on forecast rows: no correction is applied."
        ]
    if verdict == "no_mismatch" and ahead.clearly_better:
        return "cannot_tell", [
            f"But a black box forecasts the value {ahead.ratio:.1f} times better, so something may be "
            "missing."
        ]
    return verdict, []


def grade_of(look, helps=True):
    """How strong the evidence of a class is, and why; no frequency was checked, so there is no probability.

    Parameters
    ----------
    look : Look
    helps : bool, default=True
        Whether it lowers the error on rows ahead in time; else it is no more than moderate.

    Returns
    -------
    grade : dict
        `level`, one of strong, moderate and weak, and `reason`.
    """
    level = "weak"
    for name, (evidence, turns) in (("moderate", _MODERATE), ("strong", _STRONG)):
        if look.evidence >= evidence and look.turns >= turns:
            level = name
    level = "moderate" if level == "strong" and not helps else level
    return {"level": level, "reason": _why(look, level, helps)}


def _why(look, level, helps):
    """What holds a grade back; of a strong one, what speaks for it."""
    evidence, turns = _MODERATE if level == "weak" else _STRONG
    if look.turns < turns:
        return f"The command makes only {_turns(look)}."
    if look.evidence < evidence:
        return "A sticking stem explains the value only somewhat better than the command itself."
    if not helps:
        return "A sticking stem does not lower the error on forecast rows."
    return (
        "A sticking stem explains the value far better than the command itself, over "
        f"{_turns(look)} of the command."
    )


def effect_of(kind, look, grade):
    """The class of sticking and play, with the sizes of the likeliest stem and how far they are known.

    Parameters
    ----------
    kind : Kind
    look : Look
    grade : dict

    Returns
    -------
    effect : dict
        As in diagnosis.json; probabilities are None, sizes are fractions of the command's range.
    """
    names = sorted(kind.shares, key=lambda name: -kind.shares[name])
    stick, slip, least = kind.stick, kind.slip, MATTERS * look.loop.span
    unknown = "upper" if kind.sticks[1] >= 1.0 else ""
    ends = ["lower"] if kind.sticks[0] <= least else []
    return {
        "members": [{"name": name, "probability": None} for name in names],
        "probability": None,
        "grade": grade,
        "blocks": ["actuator"],
        "parameters": {
            "stick": {
                "value": stick,
                "unit": "1",
                "ci95": list(kind.sticks),
                "unknown_ends": ends + ([unknown] if unknown else []),
            },
            "slip": {
                "value": slip,
                "unit": "1",
                "ci95": list(kind.slips),
                "unknown_ends": [unknown] if unknown else [],
            },
        },
        "sentence": _stays(kind, look, [*ends, unknown]),
        "separated_by": (
            "Ramp the command slowly through a reversal with the stem's position recorded: a jump is "
            "stiction, a smooth start is play."
        ),
    }


def _stays(kind, look, unknown_ends):
    """How far the command turns before the stem follows."""
    low, high = map(_percent, kind.sticks)
    at_least = " or more" if kind.stick >= 0.95 * look.loop.span else ""
    within = f"{low} to {high}"
    if "upper" in unknown_ends:
        within = f"{low} or more"
    elif "lower" in unknown_ends:
        within = f"{high} or less"
    jump = (
        "follows; whether it jumps is not known"
        if "backlash" in kind.shares
        else f"jumps by {_percent(kind.slip)}"
    )
    return (
        f"The stem stays until the command has turned by {_percent(kind.stick)} of its range{at_least} "
        f"(95 %: {within}), and then {jump}."
    )


def sampling_of(loop, looks, look, sample_time):
    """How the rows were used, as plain data and in sentences.

    Parameters
    ----------
    loop : LoopSignals
    looks : sequence of Look
    look : Look
    sample_time : float
        As recorded [s].

    Returns
    -------
    sampling : dict
        Times in s; `stretches` that were looked at, and the one the finding is of.
    said : list of str
        Empty where every row counts as it was recorded.
    """
    spans = [[float(one.loop.time[0]), float(one.loop.time[-1])] for one in looks]
    sampling = {
        "recorded": float(sample_time),
        "used": float(loop.step),
        "averaged_rows": int(loop.every),
        "stretches": spans,
        "stretch": spans[[one is look for one in looks].index(True)],
    }
    said = []
    if loop.every > 1:
        said.append(
            f"Each row used is the mean of {loop.every} recorded rows ({loop.step:.3g} s); a swing of "
            f"{loop.period:.3g} s has {loop.period / loop.step:.0f} of them."
        )
    if len(looks) > 1:
        begin, end = sampling["stretch"]
        said.append(
            f"The recording is long: {len(looks)} stretches of {len(look.loop.time)} rows were examined, and "
            f"the figures are those of {begin:.6g} s to {end:.6g} s."
        )
    return sampling, said
