# SPDX-License-Identifier: BSD-3-Clause
"""Fault or property: what a class of explanations is to the person who maintains the valve."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sklvalve.mismatch.search.rivals import class_of

if TYPE_CHECKING:
    from sklvalve.mismatch.search.rivals import Finding


def kinds_of_explanations(finding: Finding) -> dict[str, str]:
    """Kind of each member of a class, by its name."""
    explanations = class_of(finding).items()
    return {
        name: term.effect.kind_of(fit.chain, term.onset is not None) for name, (_, term, fit) in explanations
    }


def kind_of_class(finding: Finding) -> str:
    """What the members of a class are: "fault", "property", or "either" where they differ or leave it open.

    Parameters
    ----------
    finding : Finding

    Returns
    -------
    kind : str
    """
    kinds = set(kinds_of_explanations(finding).values())
    return kinds.pop() if len(kinds) == 1 else "either"


def with_kinds(entry: dict[str, Any], finding: Finding) -> dict[str, Any]:
    """An entry of ``effects`` with its kind, and that of each of its members."""
    kinds = kinds_of_explanations(finding)
    explanations = [each | {"kind": kinds[each["name"]]} for each in entry["members"]]
    return entry | {"members": explanations, "kind": kind_of_class(finding)}
