# SPDX-License-Identifier: BSD-3-Clause
"""What a diagnosis of a history's recordings by themselves said."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

#: What a verdict may be, and how long a text beside it.
LONGEST = 2_000
VERDICTS = ("no_mismatch", "named", "none_of_these", "cannot_tell")


@dataclass(frozen=True)
class ByItself:
    """Verdict on the recordings of a history, held against the data sheet alone.

    Parameters
    ----------
    verdict : {"no_mismatch", "named", "none_of_these", "cannot_tell"}
    finding : str
        The same in words.
    reason : str, default=""
        Why nothing was named.
    held : bool, default=False
        Whether all that was named is among the effects that the history holds.
    checked : bool, default=True
        Whether it was checked how often such names are right, for all that was named.
    rivals : dict, default={}
        Name of an effect that was named first -> the names that these recordings do not tell it from.
    """

    verdict: str
    finding: str
    reason: str = ""
    held: bool = False
    checked: bool = True
    rivals: dict[str, list[str]] = field(default_factory=dict)

    @property
    def doubt(self) -> int:
        """How little is known of the valve by these recordings: 0 where they were sound."""
        if self.verdict == "named" and self.checked:
            return 1 if self.held else 2
        # names that nobody has checked take later names back, as an open verdict does
        return {"no_mismatch": 0, "none_of_these": 3, "named": 4 if self.held else 5, "cannot_tell": 6}[
            self.verdict
        ]

    @property
    def clean(self) -> bool:
        """Whether nothing was missing."""
        return self.verdict == "no_mismatch"

    @property
    def sentence(self) -> str:
        """What a later diagnosis says of it; empty where nothing was missing."""
        if self.clean:
            return ""
        found = "found sound" if self.verdict == "cannot_tell" else "sound"
        begin = f"The history was not {found}: {self.finding}"
        if self.held:
            return f"{begin} What is told here is what changed since."
        return (
            f"{begin} This history does not hold that: what was there already may pass for a change, or "
            "hide one."
        )


def more_open(asked: Sequence[ByItself]) -> ByItself | None:
    """Of diagnoses of several parts of a history the one by which less can be said later; None without any.

    Each effect has the rivals that it has in any of them.
    """
    if not asked:
        return None
    rivals: dict[str, list[str]] = {}
    for name, others in (each for one in asked for each in one.rivals.items()):
        rivals[name] = [*dict.fromkeys([*rivals.get(name, []), *others])]
    return replace(max(asked, key=lambda each: each.doubt), rivals=rivals)
