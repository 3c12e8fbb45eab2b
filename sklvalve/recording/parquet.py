# SPDX-License-Identifier: BSD-3-Clause
"""Parquet to plain columns: what the file says of itself is read and judged before any of its rows."""

import json
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.errors import InputError
from sklvalve.recording.files import MOST_BYTES, MOST_CELLS, MOST_COLUMNS, size
from sklvalve.recording.parquet_footer import Footer, read_footer

_MAGIC = b"PAR1"
# of an index without a name pandas makes a column of its own
_NAMELESS_INDEX = re.compile(r"__index_level_\d+__")
_ROWS_AT_ONCE = 65_536


def read_parquet(file: Path, content: bytes) -> dict[str, NDArray]:
    """Read the columns of a Parquet file, unconverted.

    Parameters
    ----------
    file : Path
        For messages.
    content : bytes

    Returns
    -------
    columns : dict of ndarray
        Name -> values. A column of lists or structures comes as texts that say so.

    Raises
    ------
    InputError
        If the data are damaged, declare or hold more than a memory does, or name a column twice.
    ImportError
        If pyarrow is not installed.
    """
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise ImportError('reading .parquet needs pyarrow: pip install "sklvalve[io]"') from None
    if len(content) < 12 or not (content.startswith(_MAGIC) and content.endswith(_MAGIC)):
        raise InputError(f"{file}: the file is not whole Parquet data; write or copy it again")
    # by a reader of our own: pyarrow's, asked about damaged columns, ends the process
    footer = read_footer(file, content)
    _require_bearable(file, footer)
    try:
        # limits of thrift: a damaged length must not ask for gigabytes
        source = parquet.ParquetFile(
            pyarrow.BufferReader(content),
            thrift_string_size_limit=16 << 20,
            thrift_container_size_limit=1_000_000,
        )
        schema = source.schema_arrow
        _require_each_once(file, schema.names)
        texts = [
            field.name
            for field in schema
            if pyarrow.types.is_string(field.type) or pyarrow.types.is_large_string(field.type)
        ]
        # one long text in a million rows stays one text
        source = parquet.ParquetFile(pyarrow.BufferReader(content), read_dictionary=texts)
        flat = [field.name for field in schema if _is_flat(pyarrow, field.type)]
        table = _read(file, pyarrow, source, flat)
        rows = footer.rows
        if table.num_rows != rows:
            raise ValueError(f"{table.num_rows} rows instead of {rows}")
        columns = {}
        for field in schema:
            if _NAMELESS_INDEX.fullmatch(field.name):
                continue
            if field.name in flat:
                columns[field.name] = _values(pyarrow, table.column(field.name))
            else:
                columns[field.name] = np.full(rows, f"a value of type {field.type}"[:60], dtype=object)
        index = _counted_index(schema.metadata, rows)
    except (InputError, ImportError, KeyboardInterrupt, MemoryError):
        raise
    except Exception as error:  # pyarrow and the tables of time zones raise exceptions of many kinds
        lines = str(error).splitlines() or [type(error).__name__]
        raise InputError(
            f"{file}: the Parquet data cannot be read ({lines[0][:120]}); write the file again"
        ) from None
    return {name: values for name, values in index.items() if name not in columns} | columns


def _require_bearable(file: Path, footer: Footer) -> None:
    """Refuse by what the file declares: rows, columns, and bytes once unpacked."""
    if footer.columns > MOST_COLUMNS:
        raise InputError(f"{file}: {footer.columns} columns, more than {MOST_COLUMNS}; export fewer signals")
    if footer.rows * max(footer.columns, 1) > MOST_CELLS:
        raise InputError(
            f"{file}: the file declares {footer.rows} rows of {footer.columns} columns, more than "
            f"{MOST_CELLS} cells; split the recording"
        )
    if footer.unpacked > MOST_BYTES:
        raise InputError(
            f"{file}: the file unpacks to {size(footer.unpacked)}, more than {size(MOST_BYTES)}; split the "
            "recording"
        )


def _require_each_once(file: Path, names: list[str]) -> None:
    twice = [name for name in names if names.count(name) > 1] if len(set(names)) < len(names) else []
    if twice:
        raise InputError(f"{file}: column {twice[0]!r} stands twice; rename one of the two")


def _is_flat(pyarrow, kind) -> bool:
    types = pyarrow.types
    return not (types.is_nested(kind) or types.is_binary(kind) or types.is_fixed_size_binary(kind))


def _read(file: Path, pyarrow, source, names: list[str]):
    """Rows batch by batch, so that what grows beyond its declaration is seen while it grows."""
    batches, held = [], 0
    # in this thread alone: an exception in another one of pyarrow's would end the process
    for batch in source.iter_batches(_ROWS_AT_ONCE, columns=names, use_threads=False):
        held += batch.nbytes
        if held > 2 * MOST_BYTES:
            raise InputError(f"{file}: the rows grow beyond {size(2 * MOST_BYTES)}; split the recording")
        batch.validate(full=True)
        batches.append(batch)
    schema = batches[0].schema if batches else None
    if schema is None:
        return source.schema_arrow.empty_table().select(names)
    return pyarrow.Table.from_batches(batches, schema=schema)


def _values(pyarrow, column) -> NDArray:
    if pyarrow.types.is_dictionary(column.type):
        return _of_dictionary(column)
    return np.asarray(column.to_pandas())


def _of_dictionary(column) -> NDArray:
    """Cells of a column of texts, the same text in many rows kept once."""
    parts = [np.zeros(0, dtype=object)]
    for chunk in column.chunks:
        known = np.array([*chunk.dictionary.to_pylist(), None], dtype=object)
        places = chunk.indices.fill_null(len(known) - 1).to_numpy(zero_copy_only=False)
        parts.append(known[places])
    return np.concatenate(parts)


def _counted_index(metadata, rows: int) -> dict[str, NDArray]:
    """The index that pandas keeps as begin, end and step alone, where it has a name."""
    try:
        said = json.loads(metadata[b"pandas"])["index_columns"][0]
        name, begin, step = said["name"], int(said["start"]), int(said["step"])
        if said["kind"] != "range" or not isinstance(name, str):
            return {}
        return {name: begin + step * np.arange(rows, dtype=np.int64)}
    except (TypeError, KeyError, IndexError, ValueError, OverflowError, RecursionError):
        return {}  # what damaged notes say is not needed
