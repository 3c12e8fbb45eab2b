# SPDX-License-Identifier: BSD-3-Clause
"""Why a diagnosis names nothing: which check stopped it, how far off it was, and what would change it."""

from sklvalve.mismatch.verdict import CLEAR_OF_OTHERS, class_of

_NAMELESS = ("cannot_tell", "none_of_these")


def not_upheld(findings):
    """What is said where rows that a fit had not seen speak against all that was found."""
    return (
        f"{_names(findings)} fits all rows, but does not predict rows left out of the fit: at least half of "
        "the excess error stays there. A longer recording with more movement would settle it."
    )


def too_much_left(left, findings):
    """What is said where the flow is further off than noise allows."""
    what = f"With {_names(findings)} the simulation" if findings else "The simulation"
    return (
        f"{what} leaves {_percent(left.size)} of the flow's span in rows that rest, {left.times:.2g} times "
        f"the {_percent(left.allowed)} that noise and tolerance allow. A data sheet, or the signal that is "
        "missing, would tell what it is."
    )


def reasons_of(judgement, mend, doubts=()):
    """Reasons of a verdict, in plain sentences.

    Parameters
    ----------
    judgement : Judgement
    mend : str or None
        What must be done to the data first.
    doubts : sequence of str
        Why what was found is too weak for a name.

    Returns
    -------
    reasons : list of str
    """
    if mend:
        return [mend]
    compared = [] if judgement.referee is None else list(judgement.referee.reasons)
    if judgement.verdict not in _NAMELESS:
        return [*doubts, *compared]
    found = [*judgement.why, *doubts]
    if judgement.strays is not None:
        found.append(judgement.strays.reason)
    if judgement.event is not None and not judgement.names_event:
        found.append(
            "The last rows were held against a simulation fitted to those before: no effect that was tried "
            "explains half of what is left over there. A recording that goes on would tell more."
        )
    elif judgement.change is not None:
        found.append(
            "The recorded signal changed at one time, and no effect that was tried explains it from then on."
        )
    if judgement.pulses is not None:
        found.append(
            f"The flow breaks out to one side in {judgement.pulses.many} moments and to the other in "
            f"{judgement.pulses.against}: no effect of the catalogue comes and goes like that."
        )
    found += [] if doubts else [_doubtful(f) for f in judgement.findings if not _is_clear(f)]
    if judgement.unknown is not None:
        found.append(
            f"A rest of the {judgement.unknown.channel} of {_percent(judgement.unknown.size)} of span can be "
            "predicted from the recorded signals, and no effect that was tried accounts for it."
        )
    found += compared
    return found or [
        "Simulation and recording differ by more than chance makes, but no single effect that was tried "
        "explains enough of it to be named. The next test below asks for what is missing."
    ]


def _doubtful(finding):
    """Why one thing found is a candidate and no name."""
    return (
        f"{_names([finding])} has {_percent(_share(finding))} among the explanations at hand, less than the "
        f"{_percent(CLEAR_OF_OTHERS)} from which one is named."
    )


def _is_clear(finding):
    return _share(finding) >= CLEAR_OF_OTHERS


def _share(finding):
    return sum(p for p, _, _ in class_of(finding).values())


def _names(findings):
    told = " and ".join(" or ".join(class_of(f)) for f in findings).replace("_", " ")
    return told[:1].upper() + told[1:] if told else "The explanation"


def _percent(share):
    return f"{100.0 * share:.2g} %"
