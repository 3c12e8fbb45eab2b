# SPDX-License-Identifier: BSD-3-Clause
"""Bytes of a file that somebody else made: a plain file, of a size that a memory holds."""

import errno
import gzip
import io
import os
import stat
import zlib
from os import PathLike
from pathlib import Path

from sklvalve.recording.errors import InputError

#: Largest file, and largest text out of a packed one [bytes]. A year of ten signals, one row a second, packs
#: into some hundred megabytes and is imported in parts.
MOST_BYTES = 1 << 30
#: Largest table [cells]: 1.6 GB of numbers.
MOST_CELLS = 200_000_000
#: Most columns of a table; plants have fewer signals.
MOST_COLUMNS = 20_000
_CHUNK = 1 << 20


def read_plain_file(
    path: str | PathLike[str],
    *,
    missing: str = "give the path of a file",
    folder: str = "give a file in it",
    most: int = MOST_BYTES,
) -> bytes:
    """Read a plain file whole.

    Parameters
    ----------
    path : str or path-like
    missing, folder : str
        What to do where there is no such file, or it is a folder; for messages.
    most : int
        Largest size [bytes].

    Returns
    -------
    content : bytes

    Raises
    ------
    InputError
        If there is no such file, it cannot be read, is larger than `most`, or is a folder, a pipe or a
        device: reading those may never end.
    """
    file = Path(path)
    try:
        # without this flag the opening of a pipe waits for somebody who writes into it
        handle = os.open(file, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except FileNotFoundError:
        raise InputError(f"{file}: no such file; {missing}") from None
    except IsADirectoryError:
        raise InputError(f"{file}: this is a folder; {folder}") from None
    except OSError as error:
        if error.errno == errno.ENXIO:  # a socket
            raise InputError(f"{file}: this is no plain file; save it as one") from None
        raise InputError(f"{file}: cannot be read ({error.strerror}); give a file that can") from None
    except ValueError:  # a name with a null character in it
        raise InputError(f"{str(file)!r}: this is no name of a file; {missing}") from None
    state = os.fstat(handle)
    if not stat.S_ISREG(state.st_mode) or state.st_size > most:
        os.close(handle)
        if stat.S_ISDIR(state.st_mode):
            raise InputError(f"{file}: this is a folder; {folder}")
        if not stat.S_ISREG(state.st_mode):
            raise InputError(f"{file}: this is a pipe or a device, no plain file; save the data as a file")
        raise InputError(f"{file}: the file holds {size(state.st_size)}, more than {size(most)}; split it")
    with os.fdopen(handle, "rb") as opened:
        try:
            content = opened.read(state.st_size + 1)
            # a file that grows, or one of a file system that gives no size
            while len(content) > state.st_size and len(content) <= most and (more := opened.read(_CHUNK)):
                content += more
        except OSError as error:
            raise InputError(f"{file}: cannot be read ({error.strerror}); give a file that can") from None
    if len(content) > most:
        raise InputError(f"{file}: the file holds more than {size(most)}; split it")
    return content


def unpack_gzip(file: str | PathLike[str], content: bytes, most: int = MOST_BYTES) -> bytes:
    """Unpack gzip data, counting while they grow: a file of 2 MB may unpack to gigabytes.

    Parameters
    ----------
    file : str or path-like
        For messages.
    content : bytes
    most : int
        Largest size of what comes out [bytes].

    Returns
    -------
    unpacked : bytes

    Raises
    ------
    InputError
        If the data are not whole, or unpack to more than `most`.
    """
    grown, parts = 0, []
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(content)) as packed:
            while part := packed.read(_CHUNK):
                grown += len(part)
                if grown > most:
                    raise InputError(
                        f"{file}: the file unpacks from {size(len(content))} to more than {size(most)}; "
                        "split the recording"
                    )
                parts.append(part)
    except (OSError, EOFError, zlib.error):
        raise InputError(f"{file}: the file is not whole gzip data; copy or compress it again") from None
    return b"".join(parts)


def size(count: int) -> str:
    """Bytes in words, such as ``1 GiB``."""
    for unit, bits in (("GiB", 30), ("MiB", 20), ("KiB", 10)):
        if count >= 1 << bits:
            return f"{count / (1 << bits):.3g} {unit}"
    return f"{count} bytes"
