# SPDX-License-Identifier: BSD-3-Clause
"""Whether the recordings of a history were sound by themselves, as far as that was asked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from sklvalve.history.by_itself import VERDICTS, ByItself

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory

_KEYS = {"verdict", "finding", "held"}
_LONGEST = 2_000


def told(history: ValveHistory) -> dict[str, Any]:
    """Verdict, finding in words, and whether it is held; empty where nothing was diagnosed."""
    return {} if history.by_itself_ is None else asdict(history.by_itself_)


def put_back(history: ValveHistory, part: dict[str, Any]) -> None:
    """Set it again."""
    history.by_itself_ = ByItself(**part) if part else None


def require_sound(part: dict[str, Any], whole: dict[str, Any], effects: Sequence[Any]) -> None:
    """Refuse a finding that no diagnosis has; ``ValueError``."""
    if not part:
        return
    if set(part) != _KEYS or part["verdict"] not in VERDICTS or not isinstance(part["held"], bool):
        raise ValueError("what it holds by itself is no diagnosis")
    finding = part["finding"]
    if not isinstance(finding, str) or len(finding) > _LONGEST or not finding.isprintable():
        raise ValueError("what it holds by itself is not in words")
    if part["held"] and (part["verdict"] != "named" or not effects):
        raise ValueError("what it holds by itself is no effect of it")
