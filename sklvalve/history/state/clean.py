# SPDX-License-Identifier: BSD-3-Clause
"""Whether the recordings of a history were sound by themselves, as far as that was asked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from sklvalve.history.by_itself import LONGEST, VERDICTS, ByItself

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory

_KEYS = {"verdict", "finding", "reason", "held", "checked", "rivals"}
# names of a class, more than any catalogue has
_MOST_NAMES = 100
# what is known of a history learnt before this was kept: not whether its names were checked, and no rivals
_BEFORE: dict[str, Any] = {"checked": False, "rivals": {}}


def told(history: ValveHistory) -> dict[str, Any]:
    """Verdict, finding and reason in words, and whether it is held; empty where nothing was diagnosed."""
    return {} if history.by_itself_ is None else asdict(history.by_itself_)


def put_back(history: ValveHistory, part: dict[str, Any]) -> None:
    """Set it again."""
    history.by_itself_ = ByItself(**_BEFORE | part) if part else None


def require_sound(part: dict[str, Any], whole: dict[str, Any], effects: Sequence[Any]) -> None:
    """Refuse a finding that no diagnosis has; ``ValueError``."""
    if not part:
        return
    part = _BEFORE | part
    if set(part) != _KEYS or part["verdict"] not in VERDICTS:
        raise ValueError("what it holds by itself is no diagnosis")
    if not all(isinstance(part[key], bool) for key in ("held", "checked")):
        raise ValueError("what it holds by itself is no diagnosis")
    for words in (part["finding"], part["reason"]):
        if not isinstance(words, str) or len(words) > LONGEST or not words.isprintable():
            raise ValueError("what it holds by itself is not in words")
    rivals = part["rivals"]
    if not isinstance(rivals, dict) or not all(map(_are_names, [list(rivals), *rivals.values()])):
        raise ValueError("what it holds by itself is no class of names")
    if part["held"] and (part["verdict"] != "named" or not effects):
        raise ValueError("what it holds by itself is no effect of it")


def _are_names(names: Any) -> bool:
    few = isinstance(names, list) and len(names) <= _MOST_NAMES
    return few and all(isinstance(n, str) and len(n) <= LONGEST and n.isprintable() for n in names)
