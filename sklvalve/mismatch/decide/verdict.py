# SPDX-License-Identifier: BSD-3-Clause
"""The verdict by the evidence alone; where it may be overruled stands in `verdict_of`, in its order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sklvalve.mismatch.constants import RESIDUAL_SHARE

if TYPE_CHECKING:
    from sklvalve.mismatch.residual.unknown import Unknown
    from sklvalve.mismatch.search.rivals import Finding


def verdict_of(
    findings: list[Finding], unknown: Unknown | None, enough: bool, explained: float
) -> tuple[str, list[Finding]]:
    """Verdict by the evidence alone, and the findings that stand.

    `judging` asks rows left out before it. After it these may make another verdict of it, in this order, each
    with words for `reasons_of`, and most with a rule of `rules`:

    - `judging`: noise (``cannot_tell`` or ``none_of_these`` in place of names or of nothing), a stem that
      strays (``cannot_tell``), a flow in pulses (``none_of_these``), events (``named``);
    - `stretches`: what a few stretches showed and all rows do not (``no_mismatch``);
    - `late`, `behind`: the last rows (``named`` or ``cannot_tell``), and what lies behind a property;
    - `suppression`: what the data may have made (``cannot_tell``);
    - `referee`: what a black box forecasts better (``cannot_tell``), and names that make forecasts worse;
    - `dated`: a change that nothing found explains (``cannot_tell`` in place of ``no_mismatch``);
    - `known_before`: what a history may have had already (``cannot_tell``);
    - `assessing`: where every finding is weak (``cannot_tell``).

    Parameters
    ----------
    findings : list of Finding
    unknown : Unknown or None
    enough : bool
        Whether there is more than chance makes (p at most alpha, a parameter of the finder, 0.01), and more
        than counts.
    explained : float
        Size of what the effects explain, share of span, in the unknown's channel [1].
    """
    if not enough:
        return "no_mismatch", []
    if unknown is not None and unknown.size > RESIDUAL_SHARE * explained:
        return "none_of_these", []
    if not findings:
        return "cannot_tell", []
    return "named", findings
