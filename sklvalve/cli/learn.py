# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve learn``: what is known of a valve from its own recordings, as a file for later diagnoses."""

from argparse import Namespace, RawDescriptionHelpFormatter
from pathlib import Path

from sklvalve.cli.as_json import add_json_argument, as_json
from sklvalve.cli.history_files import ENDING
from sklvalve.cli.known import add_valve_argument, known_valve, mended_by_a_draft, tell
from sklvalve.cli.parser import seed
from sklvalve.cli.terminal import show, text_width

_EXAMPLES = f"""examples:
  sklvalve learn january.csv february.csv --valve fv101.toml --out fv101{ENDING}
  sklvalve diagnose march.csv --valve fv101.toml --history fv101{ENDING}
"""


def add_parser(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "learn",
        help="learn a valve from its own recordings, best from those in which nothing is missing",
        description="Calibrate the valve's simulation on recordings of its sound operation, and keep what "
        "each part of them says. A later diagnosis that is given the file tells what has changed since. The "
        "recordings are diagnosed by themselves first: what that names is kept as known, so that a later "
        "diagnosis tells how it has changed.",
        epilog=_EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "recording",
        metavar="RECORDING",
        nargs="+",
        help="a .csv, .csv.gz or .parquet file; several of one valve are learnt together",
    )
    add_valve_argument(parser)
    parser.add_argument("--out", required=True, metavar="FILE", help=f"file for what is learnt, NAME{ENDING}")
    parser.add_argument("--seed", type=seed, default=0, metavar="N", help="of the random draws (default: 0)")
    add_json_argument(parser, "what was learnt")
    parser.set_defaults(run=run)


def run(args: Namespace) -> int:
    """Learn a valve."""
    from threadpoolctl import threadpool_limits

    from sklvalve.cli.learnt import asked_of, content_of, lines_of
    from sklvalve.cli.progress import progress
    from sklvalve.cli.staging import Staging
    from sklvalve.history.learnable import require_learnable
    from sklvalve.mismatch import MissingPhysicsFinder, save_history
    from sklvalve.recording import read_recording

    out = _target(args)
    _require_skops()
    first = args.recording[0]
    known = known_valve(args.valve, first)
    with mended_by_a_draft(known, first):
        read = [read_recording(path, known.valve) for path in args.recording]
        require_learnable(read)
    with Staging(out.parent, [out.name], called=f"--out {out.name} in") as staging:
        tell(known)
        with progress() as callback, threadpool_limits(1, user_api="blas"):
            finder = MissingPhysicsFinder(random_state=args.seed, callback=callback)
            history = finder.history_of(read)
        save_history(staging.path(out.name), history)
        staging.commit()
    content = content_of(history, read[0], finder.diagnosis_.to_dict())
    if args.json:
        show(as_json({"schema": "sklvalve.learn/1", "written": str(out)} | content))
    else:
        lines = lines_of(content, asked_of(history, read[0]), text_width())
        show("\n".join([*lines, "", f"Written: {out}"]))
    return 0


def _target(args: Namespace) -> Path:
    """Path of the file, refused where another command would not know it, or it would replace an input."""
    from sklvalve.recording import InputError

    out = Path(args.out)
    if not out.name.endswith(ENDING) or out.name == ENDING:
        raise InputError(f"--out {out}: what is learnt is kept in a file named so; name it NAME{ENDING}")
    for given in args.recording:
        if given.endswith(".skops"):
            raise InputError(
                f"{given}: a valve is learnt from recordings, and this is named as a file of what was learnt "
                "already; give recordings, and join histories as --history of a diagnosis"
            )
    return out


def _require_skops() -> None:
    try:
        import skops.io  # noqa: F401
    except ImportError:
        raise ImportError('what is learnt is kept by skops: pip install "sklvalve[skops]"') from None
