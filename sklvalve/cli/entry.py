# SPDX-License-Identifier: BSD-3-Clause
"""From the command line to a command, and from its end to an exit status."""

import errno
import os
import sys
import warnings
from argparse import RawDescriptionHelpFormatter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress

from sklvalve.cli import (
    completion,
    demo,
    diagnose,
    import_export,
    init,
    learn,
    predict,
    screen,
    simulate,
    watch,
)
from sklvalve.cli.interruption import no_other_error, sentence, signals_as_interruption
from sklvalve.cli.parser import Parser, UsageError
from sklvalve.cli.terminal import show

_DESCRIPTION = "Find, name, model and prove the physics that a control-valve simulation leaves out."
_EXAMPLES = """examples:
  sklvalve demo                                    conceal an effect in a simulated recording, and find it
  sklvalve diagnose recording.csv                  a report from a recording, by the names of its columns
  sklvalve import export.csv --out recording.csv   make a historian's export a recording
  sklvalve diagnose --help                         more of one command
"""


class _Help(RawDescriptionHelpFormatter):
    """Help that keeps each command and its words on one line."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog)
        # argparse forgets that commands stand further in than options
        self._action_max_length = len("    completion")


def main(argv: Sequence[str] | None = None) -> int:
    """`sklvalve.cli.main`, once the commands are loaded."""
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="replace")  # a terminal that lacks a letter must not end a diagnosis
    try:
        with signals_as_interruption():
            status = _run(argv)
            if sys.stdout is not None:
                sys.stdout.flush()  # else a full disk would be told only while Python shuts down
            return status
    except KeyboardInterrupt as interruption:
        with suppress(OSError):  # the terminal may be gone
            show(sentence(), file=sys.stderr)
        return getattr(interruption, "status", 130)
    except BrokenPipeError:
        # whoever read the output has seen enough, as `| head` does
        _drop_output()
        return 0
    except OSError as error:
        if not _output_fails():
            raise
        _drop_output()
        return _complain(f"standard output cannot be written ({error.strerror or error}); send it elsewhere")


def _run(argv: Sequence[str] | None) -> int:
    try:
        args = build_parser().parse_args(argv)
    except UsageError as error:
        return _complain(str(error))
    except SystemExit as end:  # argparse ends so after --help and --version
        return int(end.code or 0)
    # only now: reading errors.py loads numpy, and --help must be instant
    from numpy.linalg import LinAlgError

    from sklvalve.recording import InputError

    try:
        with _plain_warnings(), no_other_error():
            return args.run(args)
    except InputError as error:
        return _complain(str(error))
    except ImportError as error:
        if (error.name or "").startswith("sklvalve"):
            return _unforeseen(error)  # a fault of the package, no missing extra
        more = "" if "pip install" in str(error) else ': pip install "sklvalve[all]"'
        return _complain(f"{error}{more}")
    except (ArithmeticError, LinAlgError) as error:
        return _complain(
            f"the numbers of this recording break the computation ({error}); look at them with "
            "sklvalve screen, and correct units or values"
        )
    except MemoryError:
        return _complain("there is not enough memory; give a shorter recording or fewer samples a second")
    except Exception as error:
        if isinstance(error, BrokenPipeError) or (isinstance(error, OSError) and _output_fails()):
            raise
        if isinstance(error, OSError) and error.errno == errno.ENOSPC:
            # output that is not buffered fails where it is printed, and leaves nothing behind to fail again
            return _complain(
                f"the disk is full ({error.strerror}), or standard output goes where nothing fits; free some "
                "space, or send it elsewhere"
            )
        return _unforeseen(error)


def build_parser() -> Parser:
    """Parser of all commands."""
    parser = Parser(
        prog="sklvalve",
        description=_DESCRIPTION,
        epilog=_EXAMPLES,
        formatter_class=_Help,
    )
    parser.add_argument("--version", action="version", version=f"sklvalve {_version()}")
    commands = parser.add_subparsers(
        title="commands", dest="command", metavar="COMMAND", required=True, parser_class=Parser
    )
    for module in (import_export, init, screen, learn, diagnose, watch, predict, simulate, demo, completion):
        module.add_parser(commands)
    return parser


def _version() -> str:
    from sklvalve import __version__

    return __version__


def _complain(sentence: str) -> int:
    show(f"sklvalve: {' '.join(sentence.split())}", file=sys.stderr)
    return 2


def _unforeseen(error: Exception) -> int:
    """The last resort: a person gets a sentence, whoever looks for the fault its traceback."""
    if os.environ.get("SKLVALVE_DEBUG") or sys.flags.dev_mode:
        raise error
    return _complain(
        f"an unexpected error ({type(error).__name__}: {error}); check columns, units and values, "
        "or set SKLVALVE_DEBUG=1 to see where it comes from, and report it"
    )


def _output_fails() -> bool:
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError:
        return True
    return False


def _drop_output() -> None:
    """Let what is left in the buffer go nowhere, so that Python does not stumble over it once more."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@contextmanager
def _plain_warnings() -> Iterator[None]:
    """Warnings as notes of one line, each once; those of a library's insides are left out."""
    shown: set[str] = set()

    def note(message, category, filename, lineno, file=None, line=None) -> None:
        words = " ".join(str(message).split())
        if issubclass(category, UserWarning) and words not in shown:
            shown.add(words)
            show(f"note: {words}", file=sys.stderr)

    with warnings.catch_warnings():
        warnings.simplefilter("default")
        warnings.showwarning = note
        yield
