# SPDX-License-Identifier: BSD-3-Clause
"""From the command line to a command, and from its end to an exit status."""

import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from sklvalve.cli import demo, diagnose, predict, screen
from sklvalve.cli.parser import Parser, UsageError

_DESCRIPTION = "Find, name, model and prove the physics that a control-valve simulation leaves out."


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command and say how it ended.

    Parameters
    ----------
    argv : sequence of str or None, default=None
        Words after ``sklvalve``; None takes them from the command line.

    Returns
    -------
    status : int
        0 it ran, whatever the verdict; 1 a mismatch, only with ``--exit-code``; 2 bad input or a missing
        extra, with one sentence on standard error; 130 interrupted.

    Examples
    --------
    >>> from sklvalve.cli import main
    >>> main(["--version"])
    sklvalve 0.1.0
    0
    """
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="replace")  # a terminal that lacks a letter must not end a diagnosis
    try:
        return _run(argv)
    except UsageError as error:
        return _complain(str(error))
    except KeyboardInterrupt:
        print("interrupted; nothing was written", file=sys.stderr)
        return 130
    except BrokenPipeError:
        # whoever read the output has seen enough, as `| head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except SystemExit as end:  # argparse ends so after --help and --version
        return int(end.code or 0)


def _run(argv: Sequence[str] | None) -> int:
    args = build_parser().parse_args(argv)
    # only now: reading errors.py loads numpy, and --help must be instant
    from numpy.linalg import LinAlgError

    from sklvalve.recording import InputError

    try:
        with _plain_warnings():
            return args.run(args)
    except InputError as error:
        return _complain(str(error))
    except ImportError as error:
        if (error.name or "").startswith("sklvalve"):
            raise  # a fault of the package, no missing extra
        more = "" if "pip install" in str(error) else ': pip install "sklvalve[all]"'
        return _complain(f"{error}{more}")
    except (ArithmeticError, LinAlgError) as error:
        return _complain(
            f"the numbers of this recording break the computation down ({error}); look at them with "
            "sklvalve screen, and correct units or values"
        )
    except MemoryError:
        return _complain("the memory does not suffice; give a shorter recording or fewer samples a second")


def build_parser() -> Parser:
    """Parser of all commands."""
    parser = Parser(prog="sklvalve", description=_DESCRIPTION)
    parser.add_argument("--version", action="version", version=f"sklvalve {_version()}")
    commands = parser.add_subparsers(
        title="commands", dest="command", metavar="COMMAND", required=True, parser_class=Parser
    )
    for module in (demo, diagnose, predict, screen):
        module.add_parser(commands)
    return parser


def _version() -> str:
    from sklvalve import __version__

    return __version__


def _complain(sentence: str) -> int:
    print(f"sklvalve: {' '.join(sentence.split())}", file=sys.stderr)
    return 2


@contextmanager
def _plain_warnings() -> Iterator[None]:
    """Warnings as notes of one line, each once; those of a library's insides are left out."""
    shown: set[str] = set()

    def show(message, category, filename, lineno, file=None, line=None) -> None:
        words = " ".join(str(message).split())
        if issubclass(category, UserWarning) and words not in shown:
            shown.add(words)
            print(f"note: {words}", file=sys.stderr)

    with warnings.catch_warnings():
        warnings.simplefilter("default")
        warnings.showwarning = show
        yield
