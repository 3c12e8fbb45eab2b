# SPDX-License-Identifier: BSD-3-Clause
"""Files in TOML, as people write them."""

import re
import tomllib
from os import PathLike
from pathlib import Path

from sklvalve.recording.errors import InputError
from sklvalve.recording.files import read_plain_file

_LARGEST = 1 << 20  # bytes


def read_toml(
    path: str | PathLike[str], *, missing: str, folder: str = "give a file in it", most: int = _LARGEST
) -> dict[str, object]:
    """Read a TOML file.

    Parameters
    ----------
    path : str or path-like
    missing, folder : str
        What to do where there is no such file, or it is a folder; for messages.
    most : int
        Largest size [bytes].

    Returns
    -------
    data : dict

    Raises
    ------
    InputError
        If the file is missing, is not UTF-8, or is no TOML.
    """
    file = Path(path)
    content = read_plain_file(file, missing=missing, folder=folder, most=most)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise InputError(f"{file}: line {line} is no UTF-8 text; save the file as UTF-8") from None
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(_sentence(file, text, str(error))) from None
    except (ValueError, RecursionError) as error:
        what = "brackets are nested" if isinstance(error, RecursionError) else "a number is"
        raise InputError(f"{file}: {what} beyond what can be read; correct it") from None


def _sentence(file: Path, text: str, message: str) -> str:
    place = re.search(r"\(at line (\d+), column (\d+)\)", message)
    if place:
        line, column = int(place[1]), int(place[2])
    else:  # the parser says only that the text ended too early
        lines = text.splitlines() or [""]
        line, column = len(lines), len(lines[-1]) + 1
    reason = message.split(" (at ")[0]
    return (
        f"{file}: line {line}, column {column} is no valid TOML ({reason}); correct that line: texts stand "
        'in quotes, as in unit = "kPa", and decimals have a point'
    )
