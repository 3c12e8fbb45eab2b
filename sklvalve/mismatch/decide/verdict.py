# SPDX-License-Identifier: BSD-3-Clause
"""The verdict by the evidence alone; what may overrule it stands in `verdict_of`."""

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

    `judging` asks rows left out before, and noise after it. Later steps may take a name back as well:
    `referee` by a black box, `assessing` where every finding is weak, `suppression` by the data.

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
