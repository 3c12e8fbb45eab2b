# SPDX-License-Identifier: BSD-3-Clause
"""The same content in the same bytes: skops names the parts of a file by where they lay in memory."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from collections.abc import Iterator
from itertools import count
from typing import Any

_SCHEMA = "schema.json"
_EPOCH = (1980, 1, 1, 0, 0, 0)


def steady_archive(packed: bytes) -> bytes:
    """Name the arrays of a skops file by their contents, number its nodes, and take the time out of it.

    Parameters
    ----------
    packed : bytes
        A file of plain data.

    Returns
    -------
    packed : bytes
        The same for the same data, whenever and wherever it is made.
    """
    with zipfile.ZipFile(io.BytesIO(packed)) as archive:
        parts = {part: archive.read(part) for part in archive.namelist()}
    schema = json.loads(parts.pop(_SCHEMA))
    names = {part: f"{hashlib.sha256(content).hexdigest()[:32]}.npy" for part, content in parts.items()}
    numbers = count(1)
    for node in _nodes(schema):
        node["__id__"] = next(numbers)
        if "file" in node:
            node["file"] = names[node["file"]]
    made = {names[part]: content for part, content in parts.items()}
    made = {name: made[name] for name in sorted(made)} | {_SCHEMA: json.dumps(schema).encode()}
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name, content in made.items():
            archive.writestr(zipfile.ZipInfo(name, _EPOCH), content)
    return out.getvalue()


def _nodes(node: Any) -> Iterator[dict[str, Any]]:
    """Nodes of a schema, in the order in which they are written."""
    if isinstance(node, dict):
        if "__id__" in node:
            yield node
        for value in node.values():
            yield from _nodes(value)
    elif isinstance(node, list):
        for value in node:
            yield from _nodes(value)
