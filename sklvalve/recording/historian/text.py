# SPDX-License-Identifier: BSD-3-Clause
"""From the bytes of an export to its text, whatever program wrote it."""

import codecs
import hashlib
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from sklvalve.recording.errors import InputError
from sklvalve.recording.files import read_plain_file, unpack_gzip

# the longer marks first: that of UTF-32 begins as that of UTF-16 does
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_NO_TEXT = (
    (b"PK\x03\x04", "a workbook or zip archive"),
    (b"\xd0\xcf\x11\xe0", "an old Excel workbook"),
    (b"PAR1", "Parquet"),
    (b"%PDF", "a PDF"),
)
# codecs for host names and for Python's own source, some of them slow, and one that always fails
_NO_EXPORT = ("idna", "punycode", "raw-unicode-escape", "unicode-escape", "undefined", "mbcs", "oem")


class ExportText(NamedTuple):
    """Text of one file of an export, how it was encoded, and the checksum of the file."""

    file: Path
    text: str
    encoding: str
    sha256: str


def read_text(path: str | PathLike[str], encoding: str | None = None) -> ExportText:
    """Read an export as text: UTF-8, UTF-16 or UTF-32, else Windows-1252; gzip is taken off.

    Parameters
    ----------
    path : str or path-like
    encoding : str or None, default=None
        Encoding of the file, where it is known; None finds it.

    Returns
    -------
    read : ExportText

    Raises
    ------
    InputError
        If the file is missing, empty, no text, or not in the encoding given.
    """
    file = Path(path)
    content = read_plain_file(
        file, missing="give the path of the export", folder="give the files of the export in it"
    )
    sha256 = hashlib.sha256(content).hexdigest()
    if content.startswith(b"\x1f\x8b"):
        content = unpack_gzip(file, content)
    for magic, kind in _NO_TEXT:
        if content.startswith(magic):
            raise InputError(f"{file}: the file is {kind}, not text; export the table as CSV")
    found = encoding or _encoding(content)
    if found is None:
        raise InputError(f"{file}: byte {content.index(0)} shows a binary file; export the table as CSV")
    _require_text_encoding(found)
    try:
        text = content.decode(found)
    except UnicodeError as error:
        line = content[: getattr(error, "start", 0)].count(b"\n") + 1
        raise InputError(
            f"{file}: line {line} is no text in {found}; name the right one by --encoding, such as cp1250"
        ) from None
    if not text.strip("\ufeff \t\r\n"):
        raise InputError(f"{file}: the file is empty; export it again")
    return ExportText(file, text.removeprefix("\ufeff"), found.removesuffix("-sig"), sha256)


def _require_text_encoding(name: str) -> None:
    """Refuse names that are no encoding, and those of Python's codecs in which nobody writes an export."""
    try:
        codec = codecs.lookup(name)
        strange = codec.name in _NO_EXPORT or not getattr(codec, "_is_text_encoding", True)
    except (LookupError, ValueError):  # a name with a null character in it
        strange = True
    if strange:
        raise InputError(f"--encoding {name!r}: no such encoding is known; utf-8 and cp1250 are")


def _encoding(content: bytes) -> str | None:
    for mark, name in _MARKS:
        if content.startswith(mark):
            return name
    start = content[:2000]
    if b"\x00" in start:
        # plain letters in UTF-16 have every other byte nought
        halves = start[0::2].count(0), start[1::2].count(0)
        if max(halves) > 0.4 * len(start) / 2 and min(halves) < 0.1 * max(halves):
            return "utf-16-be" if halves[0] > halves[1] else "utf-16-le"
    if b"\x00" in content:
        return None
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"
