# SPDX-License-Identifier: BSD-3-Clause
"""What the name of a column says: the role of its signal, the loop it belongs to, and its unit."""

from sklvalve.recording.tags.names import NameReading, is_documented, read_name
from sklvalve.recording.tags.time_name import read_time_name
from sklvalve.recording.tags.unit_text import UnitReading, bare, read_unit, split_unit

__all__ = [
    "NameReading",
    "UnitReading",
    "bare",
    "is_documented",
    "read_name",
    "read_time_name",
    "read_unit",
    "split_unit",
]
