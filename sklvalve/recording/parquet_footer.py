# SPDX-License-Identifier: BSD-3-Clause
"""What a Parquet file says of itself, read apart: damaged, it can end the process that pyarrow runs in.

The footer is a structure of Apache Thrift in its compact form. Only what is needed to judge the size of the
table is kept; all else is walked over, which shows whether it is whole.
"""

import struct
from pathlib import Path
from typing import NamedTuple

from sklvalve.recording.errors import InputError

_TRUE, _FALSE, _BYTE, _I16, _I32, _I64, _DOUBLE, _BINARY, _LIST, _SET, _MAP, _STRUCT = range(1, 13)
_DEEPEST = 16
# ids of fields in the definition of the format (parquet.thrift)
_NUM_ROWS, _SCHEMA, _ROW_GROUPS = 3, 2, 4
_COLUMNS, _GROUP_ROWS = 1, 3
_META_DATA = 3
_VALUES, _UNPACKED, _PACKED, _DATA_AT, _DICTIONARY_AT = 5, 6, 7, 9, 11


class Footer(NamedTuple):
    """Rows, columns (leaves of the schema) and bytes once unpacked, as declared."""

    rows: int
    columns: int
    unpacked: int


def read_footer(file: Path, content: bytes) -> Footer:
    """Read what a Parquet file declares.

    Parameters
    ----------
    file : Path
        For messages.
    content : bytes
        The whole file, which begins and ends with ``PAR1``.

    Returns
    -------
    footer : Footer

    Raises
    ------
    InputError
        If the footer is damaged: a length beyond its end, counts that contradict each other, a column that
        lies outside the file.
    """
    length = int.from_bytes(content[-8:-4], "little")
    try:
        if not 0 < length <= len(content) - 12:
            raise ValueError("its length is wrong")
        return _judged(_Reader(content[-8 - length : -8]).structure(), len(content) - 8 - length)
    except (ValueError, IndexError, struct.error, AttributeError, TypeError) as error:
        reason = str(error) if type(error) is ValueError else "its parts do not fit together"
        raise InputError(
            f"{file}: the Parquet data cannot be read (the footer is damaged: {reason}); write the file again"
        ) from None


def _judged(fields: dict[int, object], end: int) -> Footer:
    rows, schema, groups = (fields.get(key) for key in (_NUM_ROWS, _SCHEMA, _ROW_GROUPS))
    if not isinstance(rows, int) or rows < 0 or not isinstance(schema, list) or not isinstance(groups, list):
        raise ValueError("it declares no rows")
    leaves = sum(1 for element in schema[1:] if not element.get(5))
    unpacked = seen = 0
    for group in groups:
        columns = group.get(_COLUMNS)
        if not isinstance(columns, list) or len(columns) != leaves:
            raise ValueError("a row group lacks columns")
        seen += _count(group, _GROUP_ROWS)
        for column in columns:
            meta = column.get(_META_DATA)
            if not isinstance(meta, dict):
                raise ValueError("a column is not described")
            packed, starts = _count(meta, _PACKED), [_count(meta, _DATA_AT)]
            if _DICTIONARY_AT in meta:
                starts.append(_count(meta, _DICTIONARY_AT))
            # some writers give 0 where there is no dictionary
            begin = min([at for at in starts if at] or [0])
            if begin < 4 or begin + packed > end:
                raise ValueError("a column lies outside the file")
            unpacked += _count(meta, _UNPACKED)
            _count(meta, _VALUES)
    if seen != rows:
        raise ValueError("its row groups hold other rows than it declares")
    return Footer(rows, leaves, unpacked)


def _count(fields: dict[int, object], key: int) -> int:
    value = fields.get(key)
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise ValueError("a count is missing or below nought")
    return value


class _Reader:
    """Thrift's compact protocol, as far as plain data use it."""

    def __init__(self, data: bytes) -> None:
        self.data, self.place = data, 0

    def structure(self, depth: int = 0) -> dict[int, object]:
        """Fields by id."""
        if depth > _DEEPEST:
            raise ValueError("it is nested too deep")
        fields: dict[int, object] = {}
        key = 0
        while head := self._byte():
            kind, step = head & 15, head >> 4
            key = key + step if step else self._whole()
            if key in fields:
                raise ValueError("a field stands twice")
            fields[key] = kind == _TRUE if kind in (_TRUE, _FALSE) else self._value(kind, depth)
        return fields

    def _value(self, kind: int, depth: int) -> object:
        if kind in (_TRUE, _FALSE, _BYTE):  # elements of a list; a field carries a truth value in its kind
            return self._byte()
        if kind in (_I16, _I32, _I64):
            return self._whole()
        if kind == _DOUBLE:
            return struct.unpack("<d", self._bytes(8))[0]
        if kind == _BINARY:
            return self._bytes(self._plain())
        if kind in (_LIST, _SET):
            head = self._byte()
            count = head >> 4 if head >> 4 < 15 else self._plain()
            # every element takes one byte at least
            if count > len(self.data) - self.place:
                raise ValueError("a list runs beyond its end")
            return [self._element(head & 15, depth) for _ in range(count)]
        if kind == _STRUCT:
            return self.structure(depth + 1)
        raise ValueError("it holds a value of no known kind")

    def _element(self, kind: int, depth: int) -> object:
        if depth > _DEEPEST:
            raise ValueError("it is nested too deep")
        return self._value(kind, depth + 1)

    def _byte(self) -> int:
        if self.place >= len(self.data):
            raise ValueError("it ends too early")
        self.place += 1
        return self.data[self.place - 1]

    def _bytes(self, count: int) -> bytes:
        if count > len(self.data) - self.place:
            raise ValueError("a text runs beyond its end")
        self.place += count
        return self.data[self.place - count : self.place]

    def _plain(self) -> int:
        value = shift = 0
        while True:
            byte = self._byte()
            value |= (byte & 127) << shift
            if byte < 128:
                return value
            shift += 7
            if shift > 63:
                raise ValueError("a number is too long")

    def _whole(self) -> int:
        value = self._plain()
        return (value >> 1) ^ -(value & 1)
