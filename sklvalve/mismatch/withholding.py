# SPDX-License-Identifier: BSD-3-Clause
"""What is not said of a recording whose data could have made it."""

from dataclasses import replace

# a signal redrawn from few points -> the channels in which what it lost passes for missing physics
_SPOILT = {
    "command": ("opening", "flow"),
    "opening": ("opening", "flow"),
    "flow": ("flow",),
    "p1": ("flow",),
    "p2": ("flow",),
}


def withheld(judgement, data):
    """Judgement without a rest, or a mere mismatch, that a historian may have made.

    What compression took from a signal is predictable, as missing physics is, and no effect explains it.

    Parameters
    ----------
    judgement : Judgement
    data : list of dict
        Findings of `screen_recording`.

    Returns
    -------
    judgement : Judgement
        The one given where the data are not to blame.
    reason : str or None
        For people, where nothing is left to be said.
    """
    redrawn = [d["role"] for d in data if d["finding"] == "compressed" and d["role"] in _SPOILT]
    spoilt = {channel for role in redrawn for channel in _SPOILT[role]}
    unknown = judgement.unknown
    if not redrawn or judgement.verdict == "no_mismatch":
        return judgement, None
    if unknown is not None and unknown.channel not in spoilt:
        return judgement, None
    judgement = replace(judgement, unknown=None, tried=None, kept=False, errors=None)
    if judgement.verdict == "named":
        return judgement, None
    roles = " and ".join(redrawn)
    silent = replace(judgement, verdict="cannot_tell", p_value=None, findings=[], model=judgement.nominal)
    return silent, (
        f"The recording differs from the simulation, but what a historian left out of {roles} may be all "
        f"of it: diagnose a recording whose {roles} {'is' if len(redrawn) == 1 else 'are'} not compressed."
    )
