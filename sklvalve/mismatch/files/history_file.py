# SPDX-License-Identifier: BSD-3-Clause
"""Histories on disk: plain numbers, texts and arrays, read back without running code."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import Any

from sklearn.utils.validation import check_is_fitted

from sklvalve import __version__
from sklvalve.history import ValveHistory
from sklvalve.history.state import require_sound_history
from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.files.plain_file import (
    HISTORY,
    Kind,
    damaged,
    effect_keys,
    effects_by_key,
    read_plain,
    require_known,
    write_plain,
)
from sklvalve.recording import InputError, Valve
from sklvalve.recording.errors import shown
from sklvalve.simulation.state import mapping

_GIVE = "give the .history.skops that sklvalve learn wrote"
_NO_HISTORY = f"this is a model, and no history of a valve; {_GIVE}"
_KIND = Kind(
    "history file",
    (HISTORY,),
    _GIVE,
    {
        "sklvalve.history/": "this history was written by another version of sklvalve, whose files this one "
        "does not read; learn it again from its recordings",
        "sklvalve.model/": _NO_HISTORY,
        "sklvalve.estimator/": _NO_HISTORY,
    },
)


def save_history(path: str | PathLike[str], history: ValveHistory) -> None:
    """Save what was learnt of a valve as a skops file of plain data.

    Parameters
    ----------
    path : str or path-like
    history : ValveHistory
        Fitted.

    Raises
    ------
    InputError
        If it is no history.
    NotFittedError
        If it has learnt nothing.
    ImportError
        If skops is not installed.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> from sklvalve import Recording, Valve, ValveHistory
    >>> from sklvalve.datasets import make_valve_recording
    >>> from sklvalve.mismatch import load_history, save_history
    >>> made = make_valve_recording(loop="wide", n_samples=900, n_later=0, random_state=3)
    >>> recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_history(pathlib.Path(folder) / "fv101.history.skops", ValveHistory().fit(recording))
    ...     load_history(pathlib.Path(folder) / "fv101.history.skops").rows
    900
    """
    if not isinstance(history, ValveHistory):
        raise InputError(f"expected a fitted ValveHistory, got {shown(history)}; save models by save_model")
    check_is_fitted(history, "prior_")
    content = {
        "format": HISTORY,
        "version": __version__,
        "valve": history.valve_.to_dict(),
        "history": history.to_state(),
    }
    write_plain(path, content, _KIND)


def load_history(path: str | PathLike[str], effects: Sequence[Effect] = ()) -> ValveHistory:
    """Load a history file; nothing in it is executed.

    Parameters
    ----------
    path : str or path-like
    effects : sequence of Effect, default=()
        Those of one's own that the history was learnt with.

    Returns
    -------
    history : ValveHistory
        Fitted: it can be updated, merged, and given to a finder.

    Raises
    ------
    InputError
        If the file is missing or no history of this package and version, holds an effect that is neither of
        the catalogue nor among `effects`, or is damaged.
    ImportError
        If skops is not installed.
    """
    content, known = read_plain(path, _KIND), effects_by_key(effects)
    try:
        return _built(path, content, known)
    except InputError:
        raise
    except Exception as error:
        raise damaged(path, error, _KIND, "learn it again from its recordings") from error


def _built(path: str | PathLike[str], content: dict[str, Any], known: dict[str, Effect]) -> ValveHistory:
    """The history that a file holds, each part checked before it is used."""
    state = mapping(content, "history")
    keys = effect_keys(mapping(state, "settings"))
    require_known(path, keys, known, load_history)
    held = tuple(known[key] for key in keys)
    require_sound_history(state, held)
    return ValveHistory.from_state(Valve.from_dict(content["valve"], source=str(path)), state, held)
