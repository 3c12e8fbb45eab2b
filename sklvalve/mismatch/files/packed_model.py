# SPDX-License-Identifier: BSD-3-Clause
"""A model file before skops sees it: what it declares to hold, and whether that is plain data."""

from __future__ import annotations

import io
import json
import math
import zipfile
from typing import IO, Any

from numpy.lib import format as npy

from sklvalve.recording.files import size

_MOST_BYTES, _MOST_PARTS = 256 << 20, 10_000
_SCHEMA = "schema.json"
# of what plain numbers, texts, lists and arrays are made; skops knows loaders that build objects
_PLAIN = {"JsonNode", "TypeNode", "NdArrayNode", "ListNode", "TupleNode", "DictNode"}


def require_plain_archive(content: bytes) -> None:
    """Refuse an archive that unpacks to too much, or holds anything but plain data.

    Parameters
    ----------
    content : bytes

    Raises
    ------
    ValueError
        With a few words that say what is wrong.
    zipfile.BadZipFile
        If it is no archive.
    """
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        parts = archive.infolist()
        declared = sum(part.file_size for part in parts)
        # an archive never gives more than it declares, so the declaration can be trusted
        if declared > _MOST_BYTES or len(parts) > _MOST_PARTS:
            raise ValueError(f"it unpacks to {size(declared)}, more than {size(_MOST_BYTES)}")
        if len({part.filename for part in parts}) < len(parts):
            raise ValueError("it holds a part twice")
        for part in parts:
            if part.filename.endswith(".npy"):
                with archive.open(part) as array:
                    _require_whole_array(array, part.file_size)
        _require_plain(json.loads(archive.read(_SCHEMA)))


def _require_whole_array(array: IO[bytes], held: int) -> None:
    """An array's header must not ask for more than the part holds."""
    version = npy.read_magic(array)
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, kind = read(array)
    if kind.hasobject or math.prod(shape) * kind.itemsize > held:
        raise ValueError("an array declares more than it holds")


def _require_plain(node: Any) -> None:
    """Walk without recursion: a nesting of a million levels is data too."""
    left = [node]
    while left:
        node = left.pop()
        if isinstance(node, dict):
            loader = node.get("__loader__", "JsonNode")
            if not isinstance(loader, str) or loader not in _PLAIN:
                raise ValueError("it holds an object that is no plain data")
            left.extend(node.values())
        elif isinstance(node, list):
            left.extend(node)
