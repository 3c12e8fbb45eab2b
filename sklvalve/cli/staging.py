# SPDX-License-Identifier: BSD-3-Clause
"""Results appear all at once or not at all."""

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from types import TracebackType

from sklvalve._locking import locked
from sklvalve.cli.interruption import note_written, uninterrupted
from sklvalve.cli.leftovers import Held, clear_leftovers, make_held
from sklvalve.recording import InputError


class Staging:
    """Folder beside the results' own, in which they are made before they are moved there.

    What a killed run left there is cleared away first. Of two runs that write one folder, each moves its
    whole set at a time.

    Parameters
    ----------
    folder : path-like
        Where the results go; made only when they are complete.
    names : iterable of str
        Names of the files, so that what stands in the way is found before the work.
    called : str, default="--out"
        What messages call the folder.
    guard : callable or None, default=None
        Called on entering, and again before the files are moved, when no other run can: raises `InputError`
        where what lies in the folder must not be replaced.

    Raises
    ------
    InputError
        On entering, if the folder is a file or cannot be written, or a name is taken by something that is no
        plain file.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        names: Iterable[str],
        called: str = "--out",
        guard: Callable[[], object] | None = None,
    ) -> None:
        self.folder = Path(folder)
        self.names = tuple(names)
        self.called = called
        self._guard = guard
        self._held: Held | None = None
        self._dropped: list[str] = []

    def __enter__(self) -> "Staging":
        try:
            base = next(path for path in (self.folder, *self.folder.absolute().parents) if path.exists())
            if not base.is_dir():
                raise InputError(f"{self.called} {self.folder}: {base} is a file; name a folder")
            # a run that was killed before its folder was made left what it had in the one above
            for above in dict.fromkeys((base, *self.folder.absolute().parents)):
                clear_leftovers(above)
            self._require_plain(self.names)
            if self._guard is not None:
                self._guard()
            with uninterrupted():
                self._held = make_held(base)
        except OSError as error:
            raise self._unwritable(error) from None
        except KeyboardInterrupt:
            self._discard()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._discard()
        if isinstance(error, OSError) and not isinstance(error, BrokenPipeError):
            raise self._unwritable(error) from None

    def instead(self, old: str, names: Iterable[str]) -> None:
        """Make files of these names in the place of one; an earlier result of that name goes with it."""
        several = tuple(names)
        self._require_plain(several)
        self.names = tuple(name for name in self.names if name != old) + several
        self.drop(old)

    def path(self, name: str) -> Path:
        """Where to write a result for now."""
        assert self._held is not None, "enter the context first"
        return self._held.folder / name

    def drop(self, name: str) -> None:
        """Let an earlier result of this name go when the others come: it would belong to another run."""
        self._dropped.append(name)

    def commit(self) -> list[Path]:
        """Move all that was written to where it belongs; paths of the results."""
        assert self._held is not None, "enter the context first"
        names = [name for name in self.names if self.path(name).exists()]
        written = [self.folder / name for name in names]
        with uninterrupted():
            self.folder.mkdir(parents=True, exist_ok=True)
            with locked(self.folder):
                if self._guard is not None:
                    self._guard()
                self._held.plan(self.folder, names, self._dropped)
                self._held.move(self.folder, names, self._dropped)
            note_written(written)
        return written

    def _require_plain(self, names: Iterable[str]) -> None:
        for name in names:
            target = self.folder / name
            if (target.exists() or target.is_symlink()) and not target.is_file():
                raise InputError(f"{target}: this is no plain file and cannot be replaced; name another")

    def _discard(self) -> None:
        with uninterrupted():
            held, self._held = self._held, None
            if held is not None:
                held.discard()

    def _unwritable(self, error: OSError) -> InputError:
        reason = error.strerror or str(error)
        return InputError(f"{self.called} {self.folder}: cannot be written ({reason}); name another folder")
