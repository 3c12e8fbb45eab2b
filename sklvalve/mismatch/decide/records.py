# SPDX-License-Identifier: BSD-3-Clause
"""Rows and rules as plain data, as diagnosis.json holds them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


def plain_records(objects: Iterable[DataclassInstance]) -> list[dict[str, Any]]:
    """Fields of dataclasses by name; numbers with four digits, null where they are not finite."""
    return [{key: _plain(value) for key, value in asdict(each).items()} for each in objects]


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    if not isinstance(value, float):
        return value
    return float(f"{value:.4g}") if isfinite(value) else None
