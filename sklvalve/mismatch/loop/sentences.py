# SPDX-License-Identifier: BSD-3-Clause
"""Verdict of a loop, the sentences it rests on, and how the class of sticking is graded."""

from sklvalve.mismatch.loop.look import FEWEST_TURNS, LARGE

#: Differences of log likelihood from which on a wide band is excluded, and an answer is visible.
_EXCLUDED = 10.0
_VISIBLE = 4.0
#: A smaller band that fits better by this much, or fewer rows to a swing, exclude nothing.
_SMALL = 6.0
_FEWEST_ROWS = 20
#: A grade is strong from this much evidence and this many turns of the command on, weak below the second
#: pair.
_STRONG, _MODERATE = (30.0, 10), (18.0, 5)
_RAMP = "a slow ramp of the command through both directions would tell"


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
    band = f"A band of {share * look.loop.span:.2%} of the command's range ({share:.0%} of its movement)"
    if found:
        return "named", (
            f"{band} explains the value better than the command itself ({evidence:.0f} nats); the command "
            f"turns and comes back {look.turns} times."
        )
    if max(one.answer for one in looks) <= _VISIBLE:
        return "cannot_tell", (
            "The value does not visibly follow the command in this record: the loop moves too little for "
            f"its noise; {_RAMP}."
        )
    if all(map(_excludes, looks)):
        large = max(one.large for one in looks)
        return "no_mismatch", (
            f"Bands of {LARGE:.0%} or more of the command's movement explain the value worse than the "
            f"command itself ({-large:.0f} nats)."
        )
    if look.turns < FEWEST_TURNS:
        return "cannot_tell", (
            "The command goes one way and does not come back, so that a band cannot be distinguished from a "
            f"supply or a gain that drifts; {_RAMP}."
        )
    if look.large < -_EXCLUDED:
        return "cannot_tell", (
            f"Wide bands explain the value worse than the command itself ({-look.large:.0f} nats), but "
            f"{_doubt(look)}, so that they are not excluded; {_RAMP}."
        )
    if evidence <= 0.0 and look.excess > 0.0:
        return "cannot_tell", (
            "A band explains the value better than the command itself under one form of noise, and worse "
            f"under another; {_RAMP}."
        )
    if evidence <= 0.0:
        outside = look.compared.command.rhythm
        other = "an oscillation from outside explains" if outside else "the command itself explains"
        return "cannot_tell", f"Wide bands are not excluded, but {other} the value as well; {_RAMP}."
    return "cannot_tell", (
        f"{band} explains the value somewhat better than the command itself ({evidence:.0f} nats), as it "
        f"does in healthy loops too; {_RAMP}."
    )


def _doubt(look):
    if len(look.loop.senses) > 1:
        return "whether a larger command raises or lowers the value is uncertain"
    if _rows(look) < _FEWEST_ROWS:
        return f"a swing of the command has only {_rows(look):.0f} rows"
    if look.excess > 0.0:
        return "a band of another size explains it better"
    if look.small >= _SMALL:
        return "a smaller band explains it better"
    return "the value does not visibly follow in every part of the record"


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
            "The stem that sticks does not lower the error on rows ahead in time: no correction is applied."
        ]
    if verdict == "no_mismatch" and ahead.clearly_better:
        return "cannot_tell", [
            f"But a black box of many bands predicts the value {ahead.ratio:.1f} times better on rows ahead "
            f"in time, so that something may be missing; {_RAMP}."
        ]
    return verdict, []


def grade_of(look, probability, helps=True):
    """How strong the evidence of a class is, and why; no frequency was checked, so there is no probability.

    Parameters
    ----------
    look : Look
    probability : float
        How often a healthy loop gives as much.
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
    rare = "fewer than 1 in 1000" if probability < 0.001 else f"{100.0 * probability:.1f} %"
    return {
        "level": level,
        "reason": (
            f"A stem that sticks explains the value better than the command itself by {look.evidence:.0f} "
            f"nats over {look.turns} turns of the command, and {rare} of simulated healthy loops reach as "
            "much."
        ),
    }


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
    stick, slip = kind.stick, kind.slip
    at_least = " or more" if stick >= 0.95 * look.loop.span else ""
    low, high = kind.sticks
    jump = (
        "follows; whether with a jump is not known" if "backlash" in kind.shares else f"jumps by {slip:.2%}"
    )
    return {
        "members": [{"name": name, "probability": None} for name in names],
        "probability": None,
        "grade": grade,
        "blocks": ["actuator"],
        "parameters": {
            "stick": {"value": stick, "unit": "1", "ci95": list(kind.sticks)},
            "slip": {"value": slip, "unit": "1", "ci95": list(kind.slips)},
        },
        "sentence": (
            f"The stem stays until the command has turned by {stick:.2%} of its range{at_least} (95 %: "
            f"{low:.2%} to {high:.2%}), and then {jump}."
        ),
        "separated_by": (
            "Ramp the command slowly through a reversal with the stem's position recorded: a jump is "
            "stiction, a smooth start is play."
        ),
    }


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
            f"Each row used is the mean of {loop.every} recorded ones ({loop.step:.3g} s), which leaves "
            f"{loop.period / loop.step:.0f} rows to a swing of {loop.period:.3g} s."
        )
    if len(looks) > 1:
        begin, end = sampling["stretch"]
        said.append(
            f"Of this long record {len(looks)} stretches of {len(look.loop.time)} rows were examined; the "
            f"figures are those of {begin:.6g} s to {end:.6g} s."
        )
    return sampling, said
