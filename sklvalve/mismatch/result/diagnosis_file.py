# SPDX-License-Identifier: BSD-3-Clause
"""A diagnosis in a file: its JSON and its traces as plain arrays, in one zip archive that any tool opens."""

from __future__ import annotations

import io
import json
import os
import tempfile
import zipfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from sklvalve.recording import InputError

_FORMAT = "sklvalve.saved_diagnosis/1"
_CONTENT, _TRACES = "diagnosis.json", "traces.json"
# a key that no trace has stands for an array in a file of its own
_ARRAY = "array in"


def write_diagnosis(text: str, traces: dict[str, Any], path: str | os.PathLike[str]) -> None:
    """Write a diagnosis to a file, whole or not at all.

    Parameters
    ----------
    text : str
        Content of diagnosis.json.
    traces : dict
        Arrays, plain values, and dicts of these.
    path : path-like
        Replaced where there is such a file.

    Raises
    ------
    InputError
        If the file cannot be written, or a trace is no plain data.
    """
    path = Path(path)
    arrays: dict[str, np.ndarray] = {}
    try:
        plain = json.dumps({"format": _FORMAT, "traces": _without_arrays(traces, arrays)})
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: the traces hold more than numbers, texts and arrays: {error}") from None
    try:
        handle, draft = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
        try:
            with os.fdopen(handle, "wb") as file, zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
                for name, content in ((_CONTENT, text), (_TRACES, plain)):
                    archive.writestr(_part(name), content)
                for name, values in arrays.items():
                    archive.writestr(_part(name), _as_bytes(values))
            os.replace(draft, path)
        except BaseException:
            with suppress(OSError):
                os.unlink(draft)
            raise
    except OSError as error:
        raise InputError(
            f"{path}: cannot be written ({error.strerror or error}); name a file in a folder that can be"
        ) from None


def _part(name: str) -> zipfile.ZipInfo:
    """A part of the archive without the time at which it was made: the same diagnosis has the same bytes."""
    part = zipfile.ZipInfo(name)
    part.compress_type = zipfile.ZIP_DEFLATED
    return part


def read_diagnosis(path: str | os.PathLike[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Content and traces of a file of `write_diagnosis`; nothing in it is executed.

    Returns
    -------
    content : dict
    traces : dict

    Raises
    ------
    InputError
        If there is no such file, or it is no saved diagnosis.
    """
    path = Path(path)
    try:
        with zipfile.ZipFile(path) as archive:
            content, saved = json.loads(archive.read(_CONTENT)), json.loads(archive.read(_TRACES))
            if saved["format"] != _FORMAT:
                raise InputError(
                    f"{path}: its format is {saved['format']!r}, and this version reads {_FORMAT!r}; save "
                    "the diagnosis anew"
                )
            return content, _with_arrays(saved["traces"], archive)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (zipfile.BadZipFile, KeyError, TypeError, ValueError, EOFError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{path}: this is no saved diagnosis, or it is damaged; give a file that Diagnosis.save has "
            "written"
        ) from None


def _without_arrays(value: Any, arrays: dict[str, np.ndarray]) -> Any:
    """The value as plain data, its arrays put aside by name."""
    if isinstance(value, dict):
        if not all(isinstance(key, str) for key in value):
            raise TypeError("a key that is no text")
        return {key: _without_arrays(each, arrays) for key, each in value.items()}
    if isinstance(value, np.ndarray):
        if value.dtype.hasobject:
            raise TypeError("an array of objects")
        name = f"{len(arrays)}.npy"
        arrays[name] = value
        return {_ARRAY: name}
    if isinstance(value, list | tuple):
        return [_without_arrays(each, arrays) for each in value]
    return value.item() if isinstance(value, np.generic) else value


def _with_arrays(value: Any, archive: zipfile.ZipFile) -> Any:
    if isinstance(value, list):
        return [_with_arrays(each, archive) for each in value]
    if not isinstance(value, dict):
        return value
    if set(value) == {_ARRAY}:
        return np.load(io.BytesIO(archive.read(value[_ARRAY])), allow_pickle=False)
    return {key: _with_arrays(each, archive) for key, each in value.items()}


def _as_bytes(values: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, values, allow_pickle=False)
    return buffer.getvalue()
