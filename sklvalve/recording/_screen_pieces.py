# SPDX-License-Identifier: BSD-3-Clause
"""Findings about several recordings that were joined: each is screened alone, rows counted in the whole."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sklvalve.recording._screen_tools import Finding, worth
from sklvalve.recording.recording import Recording


def screen_pieces(joined: Recording, screen: Callable[[Recording], list[Finding]]) -> list[Finding]:
    """Findings of a screen about each of the recordings, those that hold throughout all of them told once."""
    by_piece = [_of_piece(joined, *span, screen) for span in joined.spans]
    first, *others = [{_kind(each) for each in found if each["rows"] is None} for found in by_piece]
    everywhere = first.intersection(*others)
    told = [_worst(each, by_piece) for each in by_piece[0] if _kind(each) in everywhere]
    for found, (start, stop) in zip(by_piece, joined.spans, strict=True):
        for each in found:
            if _kind(each) not in everywhere:
                told.append(each | {"rows": each["rows"] or [[start, stop]]})
    return told


def _worst(finding: Finding, by_piece: list[list[Finding]]) -> Finding:
    """The worst of a finding that holds in all pieces: that of the largest size where it has one."""
    alike = [each for found in by_piece for each in found if _kind(each) == _kind(finding)]
    return max(alike, key=lambda each: float(each.get("size") or 0.0))  # type: ignore[arg-type]


def _kind(finding: Finding) -> tuple[object, ...]:
    # a dead band and lines are both compression, and allowed for in ways of their own
    return finding["finding"], finding["role"], finding.get("size") is None


def _of_piece(
    joined: Recording, first: int, behind: int, screen: Callable[[Recording], list[Finding]]
) -> list[Finding]:
    piece = replace(joined.slice(first, behind), pieces=())
    begins = [each.begins for each in joined.pieces]
    source = joined.pieces[int(np.searchsorted(begins, piece.time[0], side="right")) - 1].source
    told = []
    for each in screen(piece):
        rows = each["rows"]
        moved = None if rows is None else [[first + start, first + stop] for start, stop in rows]  # type: ignore[attr-defined]
        told.append(each | {"detail": f"in {source}: {each['detail']}", "rows": moved})
        if each["finding"] == "quantised" and "size" in each:
            # a step is coarse or fine beside all that the signal does, and a short piece shows little of that
            told[-1]["size"] = float(each["size"]) * _share_of_worth(joined, piece, str(each["role"]))  # type: ignore[arg-type]
    return told


def _share_of_worth(joined: Recording, piece: Recording, role: str) -> float:
    return worth(piece, role) / worth(joined, role)
