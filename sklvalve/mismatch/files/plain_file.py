# SPDX-License-Identifier: BSD-3-Clause
"""A skops file of plain data, whatever it holds: written at once or not at all, read without running code."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from types import ModuleType
from typing import Any

from sklvalve._replacing import replacing
from sklvalve.mismatch.effects import CATALOGUE, EVENTS, LATE
from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.files.packed_model import require_plain_archive
from sklvalve.mismatch.files.steady_archive import steady_archive
from sklvalve.recording import InputError
from sklvalve.recording.errors import shown
from sklvalve.recording.files import read_plain_file

MODEL, ESTIMATOR, HISTORY = "sklvalve.model/1", "sklvalve.estimator/1", "sklvalve.history/7"
_LARGEST = 256 << 20  # bytes
# of a reason that a file's own content gives
_LONGEST = 100


@dataclass(frozen=True)
class Kind:
    """A kind of file, in the words of messages.

    Parameters
    ----------
    called : str
        Such as ``"model file"``.
    formats : tuple of str
        What its key ``format`` may say.
    give : str
        What to give instead of another file.
    others : mapping of str to str
        Beginning of another format -> sentence that says what that file is, and what to do.
    """

    called: str
    formats: tuple[str, ...]
    give: str
    others: Mapping[str, str]


def skops_of(kind: Kind) -> ModuleType:
    """``skops.io``, or an `ImportError` that names the extra."""
    try:
        import skops.io
    except ImportError:
        raise ImportError(f'{kind.called}s need skops: pip install "sklvalve[skops]"') from None
    return skops.io


def write_plain(path: str | PathLike[str], content: dict[str, Any], kind: Kind) -> None:
    """Write a file under another name first, so that what stood there is replaced whole or not at all.

    The same content gives the same bytes.

    Parameters
    ----------
    path : str or path-like
    content : dict
        Of plain numbers, texts, lists and arrays.
    kind : Kind
    """
    skops_io = skops_of(kind)
    with replacing(Path(path)) as draft:
        draft.write_bytes(steady_archive(skops_io.dumps(content)))


def read_plain(path: str | PathLike[str], kind: Kind) -> dict[str, Any]:
    """Content of a file; nothing in it is executed, and nothing in it is checked but its format.

    Parameters
    ----------
    path : str or path-like
    kind : Kind

    Returns
    -------
    content : dict

    Raises
    ------
    InputError
        If the file is missing, cannot be read, or is of another kind.
    """
    skops_io = skops_of(kind)
    packed = read_plain_file(path, missing=kind.give, folder=kind.give, most=_LARGEST)
    try:
        require_plain_archive(packed)
        content = skops_io.loads(packed, trusted=[])
        said = content.get("format")
        advice = next((words for begin, words in kind.others.items() if str(said).startswith(begin)), None)
        if advice is None and said not in kind.formats:
            raise ValueError("it has another format")
    except Exception as error:
        raise InputError(
            f"{path}: this is no {kind.called} of sklvalve{_reason(error, ' (', ')')}; {kind.give}"
        ) from error
    if said not in kind.formats:
        raise InputError(f"{path}: {advice}")
    return content


def damaged(path: str | PathLike[str], error: Exception, kind: Kind, mend: str) -> InputError:
    """A file of the right kind, a part of which cannot be used."""
    return InputError(
        f"{path}: this is no {kind.called} of sklvalve that can be used (a part of it is "
        f"damaged{_reason(error, ': ')}); {mend}"
    )


def effects_by_key(effects: Sequence[Effect]) -> dict[str, Effect]:
    """Effects of the catalogue and one's own, by the keys that files hold."""
    return {e.key: e for e in (*CATALOGUE, *EVENTS, *LATE, *effects)}


def effect_keys(state: dict[str, Any]) -> Sequence[str]:
    """Keys of the effects that a state names; ``ValueError`` where they are none."""
    keys = state["effects"]
    if not isinstance(keys, list | tuple) or not all(isinstance(key, str) for key in keys):
        raise ValueError("its effects are no names")
    if len(set(keys)) < len(keys):
        raise ValueError("it names an effect twice")
    return keys


def require_known(
    path: str | PathLike[str], keys: Sequence[str], known: Mapping[str, Effect], load: Callable[..., Any]
) -> None:
    """Refuse a file that names what is no effect.

    Parameters
    ----------
    path : str or path-like
    keys : sequence of str
    known : mapping of str to Effect
    load : callable
        The function that can be given effects of one's own.

    Raises
    ------
    InputError
        Naming the effect.
    """
    strange = set(keys) - set(known)
    if strange:
        what = load.__name__.removeprefix("load_")
        raise InputError(
            f"{path}: the {what} holds {shown(min(strange))[1:-1]}, which is no effect of the catalogue; "
            f"give it to {load.__name__} as one of effects"
        )


def _reason(error: Exception, before: str, after: str = "") -> str:
    """Words of an error that this package raised about the content; of any other none."""
    return f"{before}{error}{after}" if type(error) is ValueError and len(str(error)) < _LONGEST else ""
