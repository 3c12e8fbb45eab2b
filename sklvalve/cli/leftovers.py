# SPDX-License-Identifier: BSD-3-Clause
"""Folders in which results are made: each held by the run that makes it, and cleared away when that is dead.

A run holds its folder by a lock on a file inside, which the system lets go when the process ends, however it
ends. A killed run may have been in the midst of moving its results; the list that it wrote before the first
move lets the next run finish them, so that no set of files stays mixed.
"""

import json
import os
import re
import secrets
import shutil
from contextlib import suppress
from pathlib import Path

from sklvalve._locking import locked

try:
    import fcntl
except ImportError:  # on Windows the leftovers stay, and two runs are not kept apart
    fcntl = None  # type: ignore[assignment]

_PREFIX = ".sklvalve-"
_NAME = re.compile(r"\.sklvalve-[0-9a-f]{12}")
_LOCK, _MOVES = ".held", ".moves.json"


class Held:
    """A folder made for this run, and the lock on it."""

    def __init__(self, folder: Path, handle: int) -> None:
        self.folder, self._handle = folder, handle

    def plan(self, target: Path, names: list[str], dropped: list[str]) -> None:
        """Write down what will be moved where, before the first move."""
        plan = {"target": str(target.absolute()), "names": names, "dropped": dropped}
        draft = self.folder / f"{_MOVES}.draft"
        with draft.open("w", encoding="utf-8") as file:
            json.dump(plan, file)
            file.flush()
            os.fsync(file.fileno())
        os.replace(draft, self.folder / _MOVES)

    def move(self, target: Path, names: list[str], dropped: list[str]) -> None:
        """Move what was planned, and let the plan go."""
        _move(self.folder, target, names, dropped)
        (self.folder / _MOVES).unlink()

    def discard(self) -> None:
        """Remove the folder and let the lock go."""
        shutil.rmtree(self.folder, ignore_errors=True)
        with suppress(OSError):
            os.close(self._handle)


def make_held(base: Path) -> Held:
    """Make a folder in `base` that no other run takes for a leftover."""
    with locked(base):
        folder = base / f"{_PREFIX}{secrets.token_hex(6)}"
        folder.mkdir(mode=0o700)
        try:
            handle = os.open(folder / _LOCK, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
            if fcntl is not None:
                with suppress(OSError):  # some network file systems know no locks
                    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
    return Held(folder, handle)


def clear_leftovers(base: Path) -> None:
    """Finish or remove what dead runs left in a folder.

    Parameters
    ----------
    base : Path
        Where they made their folders. What cannot be read or removed stays.
    """
    if fcntl is None:
        return
    try:
        with os.scandir(base) as entries:
            found = [Path(each.path) for each in entries if _NAME.fullmatch(each.name) and each.is_dir()]
    except OSError:
        return
    if not found:
        return
    with suppress(OSError), locked(base):
        for folder in found:
            _clear(folder)


def _clear(folder: Path) -> None:
    try:
        handle = os.open(folder / _LOCK, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0))
    except OSError:
        return  # gone by now, somebody else's, or no folder of ours
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        with suppress(FileNotFoundError, ValueError, KeyError, TypeError, RecursionError):
            plan = json.loads((folder / _MOVES).read_text(encoding="utf-8"))
            target, names, dropped = Path(plan["target"]), plan["names"], plan["dropped"]
            if _is_ours(folder, target, [*names, *dropped]):
                _move(folder, target, names, dropped)
        shutil.rmtree(folder, ignore_errors=True)
    except OSError:
        pass  # its run lives
    finally:
        os.close(handle)


def _is_ours(folder: Path, target: Path, names: list[str]) -> bool:
    """Whether a run of this user made a plan, and one that reaches no further than its own results."""
    state = folder.stat()
    own = state.st_uid == os.getuid() and not state.st_mode & 0o022
    near = target.resolve().is_relative_to(folder.parent.resolve())
    return own and near and all(Path(name).name == name and not name.startswith(".") for name in names)


def _move(folder: Path, target: Path, names: list[str], dropped: list[str]) -> None:
    for name in names:
        with suppress(FileNotFoundError):  # moved already
            os.replace(folder / name, target / name)
    for name in dropped:
        (target / name).unlink(missing_ok=True)
