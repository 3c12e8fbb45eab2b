# SPDX-License-Identifier: BSD-3-Clause
"""Files that are replaced whole or not at all."""

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give the name of a draft beside a file, and put it in the file's place once it is written.

    Not by `tempfile`, whose files are the owner's alone: a result is as readable as the umask has it.

    Parameters
    ----------
    path : Path

    Yields
    ------
    draft : Path
        Gone where writing it fails, and the file is what it was.
    """
    draft = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    try:
        yield draft
        os.replace(draft, path)
    finally:
        draft.unlink(missing_ok=True)
