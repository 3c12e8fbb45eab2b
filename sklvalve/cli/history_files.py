# SPDX-License-Identifier: BSD-3-Clause
"""``--history``: recordings of before, what was learnt of them, or both, as one history."""

from argparse import ArgumentTypeError
from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sklvalve.history import ValveHistory
    from sklvalve.mismatch import MissingPhysicsFinder
    from sklvalve.recording import Recording, Valve

#: How the file of a history is named.
ENDING = ".history.skops"
_SKOPS = ".skops"


def add_history_argument(parser) -> None:
    """Declare ``--history``."""
    parser.add_argument(
        "--history",
        metavar="FILE",
        nargs="+",
        help="earlier recordings, or what sklvalve learn made of them "
        f"(NAME{ENDING}): the diagnosis then tells what has changed since. Recordings are diagnosed "
        "first, as sklvalve learn does it; a file spares that",
    )


def add_allow_argument(parser) -> None:
    """Declare ``--allow``."""
    parser.add_argument(
        "--allow",
        metavar="NAME=VALUE",
        nargs="+",
        type=_allowed,
        default=(),
        help="what may change without a fault between --history and the recording, each a standard "
        "deviation, such as capacity=0.004; the report lists names and values",
    )


def _allowed(text: str) -> tuple[str, float]:
    """Name and value of one allowance."""
    from sklvalve.history import Allowance

    names = [field.name for field in fields(Allowance)]
    name, _, value = text.partition("=")
    try:
        number = float(value)
    except ValueError:
        number = 0.0
    if name not in names:
        raise ArgumentTypeError(f"expected NAME=VALUE, NAME one of {', '.join(names)}; got {text!r}")
    if not 1e-9 <= number <= 1e6:
        raise ArgumentTypeError(f"expected a number above 0 for {name}; got {value!r}")
    return name, number


def read_history(
    files: Sequence[str] | None, valve: "Valve", allowed: Sequence[tuple[str, float]] = ()
) -> "ValveHistory | list[Recording] | None":
    """Read what ``--history`` names.

    Parameters
    ----------
    files : sequence of str or None
        Recordings, files of `save_history`, or both.
    valve : Valve
        By which the recordings are read.
    allowed : sequence of (str, float), default=()
        Of ``--allow``.

    Returns
    -------
    history : ValveHistory, list of Recording or None
        Recordings alone are for a finder to learn from; None where nothing was given.

    Raises
    ------
    InputError
        If a file cannot be read, nothing can be learnt from it, they do not belong together, or something is
        allowed and there is no history.
    """
    from sklvalve.history.learnable import require_learnable
    from sklvalve.mismatch import load_history
    from sklvalve.recording import InputError, read_recording

    if not files:
        if allowed:
            raise InputError("--allow says what may change since a history; give one as --history")
        return None
    learnt = [load_history(file) for file in files if Path(file).suffix == _SKOPS]
    read = [read_recording(file, valve) for file in files if Path(file).suffix != _SKOPS]
    if not learnt:
        require_learnable(read)
        return read
    history, *others = learnt
    for other in others:
        history.merge(other)
    return history.update(read) if read else history


def learnt_history(
    history: "ValveHistory | list[Recording] | None",
    finder: "MissingPhysicsFinder",
    allowed: Sequence[tuple[str, float]] = (),
) -> "ValveHistory | None":
    """Learn from what `read_history` has read, as far as it is not learnt yet.

    Parameters
    ----------
    history : ValveHistory, list of Recording or None
    finder : MissingPhysicsFinder
        Diagnoses recordings first; it has no history.
    allowed : sequence of (str, float), default=()
        Of ``--allow``; each takes the place of what the history, or the default, allows.
    """
    if history is None:
        return None
    learnt = finder.history_of(history) if isinstance(history, list) else history
    if allowed:
        learnt.allowing(replace(learnt.allowed, **dict(allowed)))
    return learnt


def require_history(history: "ValveHistory | list[Recording] | None", recording: "Recording") -> None:
    """Refuse a history that does not belong to a recording, as far as that shows before the work.

    Parameters
    ----------
    history : ValveHistory, list of Recording or None
        Of `read_history`.
    recording : Recording
        The rows that are to be diagnosed.

    Raises
    ------
    InputError
        With one sentence.
    """
    from sklvalve.history.compatible import require_apart, require_compatible
    from sklvalve.history.learnable import require_no_loop
    from sklvalve.history.sources import sources_of

    if isinstance(history, list):
        require_no_loop(recording)
        require_apart([source for each in history for source in sources_of(each)], recording)
    elif history is not None:
        require_compatible(history, recording)
