# SPDX-License-Identifier: BSD-3-Clause
"""What is not said of a recording whose data could have made it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from sklvalve.mismatch.data.gate import effects_switched_off, left_out_is_known
from sklvalve.recording import Recording

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.judgement import Judgement

# a signal redrawn from few points -> the channels in which what it lost passes for missing physics
_SPOILT = {
    "command": ("opening", "flow"),
    "opening": ("opening", "flow"),
    "flow": ("flow",),
    "p1": ("flow",),
    "p2": ("flow",),
}


def suppressed(
    judgement: Judgement, data: list[dict[str, Any]], recording: Recording
) -> tuple[Judgement, str | None]:
    """Judgement without a rest, or a mere mismatch, that the data may have made.

    What a historian took from a signal is predictable, as missing physics is, and no effect explains it;
    unless it is known to be less than what is allowed for. The steps of a coarse reading are not predictable,
    but enough to raise the test. What is named stays: effects that either could imitate were not asked.

    Parameters
    ----------
    judgement : Judgement
    data : list of dict
        Findings of `screen_recording`.
    recording : Recording

    Returns
    -------
    judgement : Judgement
        The one given where the data are not to blame.
    reason : str or None
        For people, where nothing is left to be said.
    """
    redrawn = _roles([each for each in data if not left_out_is_known(each, recording)], "compressed")
    spoilt = {channel for role in redrawn for channel in _SPOILT[role]}
    judgement = _without_spoilt(judgement, spoilt)
    blamed = [f"the historian's compression of {role}" for role in redrawn]
    blamed += [f"the coarse reading of {role}" for role in _roles(data, "quantised")]
    if not blamed or _is_beyond(judgement, spoilt) or judgement.verdict in ("no_mismatch", "named"):
        return judgement, None
    silent = replace(
        judgement, verdict="cannot_tell", p_value=None, findings=[], model=judgement.nominal, strays=None
    )
    return silent, (
        f"The recording differs from the simulation, but {' and '.join(blamed)} may explain all of it. "
        "Diagnose a recording without that."
    )


def _without_spoilt(judgement: Judgement, spoilt: set[str]) -> Judgement:
    """A judgement without what it says of channels in which lost values pass for missing physics."""
    if judgement.unknown is not None and judgement.unknown.channel in spoilt:
        judgement = replace(judgement, unknown=None, tried=None, kept=False, errors=None)
    left = judgement.left if judgement.unknown is None else None
    if left is not None and left.channel in spoilt:
        judgement = replace(judgement, left=None, closest=[])
    if judgement.also is not None and judgement.also.channel in spoilt:
        judgement = replace(judgement, also=None)
    if judgement.pulses is not None and "flow" in spoilt:
        judgement = replace(judgement, pulses=None)
    return judgement


def _is_beyond(judgement: Judgement, spoilt: set[str]) -> bool:
    """Whether something is found that no coarse reading makes: it is not as far off, nor to one side only."""
    strays = judgement.strays is not None and "opening" not in spoilt
    known = (judgement.unknown, judgement.left, judgement.pulses)
    return strays or any(each is not None for each in known)


def _roles(data: list[dict[str, Any]], name: str) -> list[str]:
    """Signals with such a finding, as far as it is one that counts."""
    return [
        d["role"] for d in data if d["finding"] == name and d["role"] in _SPOILT and effects_switched_off([d])
    ]
