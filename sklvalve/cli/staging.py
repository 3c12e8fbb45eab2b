# SPDX-License-Identifier: BSD-3-Clause
"""Results appear all at once or not at all."""

import os
import shutil
import signal
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType

from sklvalve.recording import InputError


class Staging:
    """Folder beside the results' own, in which they are made before they are moved there.

    Parameters
    ----------
    folder : path-like
        Where the results go; made only when they are complete.
    names : iterable of str
        Names of the files, so that what stands in the way is found before the work.
    called : str, default="--out"
        What messages call the folder.

    Raises
    ------
    InputError
        On entering, if the folder is a file or cannot be written, or a name is taken by something that is no
        plain file.
    """

    def __init__(self, folder: str | os.PathLike[str], names: Iterable[str], called: str = "--out") -> None:
        self.folder = Path(folder)
        self.names = tuple(names)
        self.called = called
        self._made: Path | None = None
        self._dropped: list[Path] = []

    def __enter__(self) -> "Staging":
        try:
            base = next(path for path in (self.folder, *self.folder.absolute().parents) if path.exists())
            if not base.is_dir():
                raise InputError(f"{self.called} {self.folder}: {base} is a file; name a folder")
            self._require_plain(self.names)
            self._made = Path(tempfile.mkdtemp(prefix=".sklvalve-", dir=base))
        except OSError as error:
            raise self._unwritable(error) from None
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._made is not None:
            shutil.rmtree(self._made, ignore_errors=True)
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
        assert self._made is not None, "enter the context first"
        return self._made / name

    def drop(self, name: str) -> None:
        """Let an earlier result of this name go when the others come: it would belong to another run."""
        self._dropped.append(self.folder / name)

    def commit(self) -> list[Path]:
        """Move all that was written to where it belongs; paths of the results."""
        assert self._made is not None, "enter the context first"
        with _uninterrupted():
            self.folder.mkdir(parents=True, exist_ok=True)
            written = [self.folder / name for name in self.names if self.path(name).exists()]
            for target in written:
                os.replace(self.path(target.name), target)
            for target in self._dropped:
                target.unlink(missing_ok=True)
        return written

    def _require_plain(self, names: Iterable[str]) -> None:
        for name in names:
            target = self.folder / name
            if (target.exists() or target.is_symlink()) and not target.is_file():
                raise InputError(f"{target}: this is no plain file and cannot be replaced; name another")

    def _unwritable(self, error: OSError) -> InputError:
        reason = error.strerror or str(error)
        return InputError(f"{self.called} {self.folder}: cannot be written ({reason}); name another folder")


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Hold Ctrl-C back for the moment of the moves, so that they are done in full."""
    try:
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    except ValueError:  # only the main thread may ask for this, and only it is interrupted
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
