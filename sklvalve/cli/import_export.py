# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve import``: a historian's export made a clean recording, and what was done to it."""

import json
import math
import re
from argparse import ArgumentTypeError, Namespace, RawDescriptionHelpFormatter
from pathlib import Path

from sklvalve.cli.as_json import add_json_argument, as_json
from sklvalve.cli.parser import column_name
from sklvalve.cli.terminal import show

_EXAMPLES = """examples:
  sklvalve import export.csv --out recording.csv
  sklvalve import export.txt --out recording.csv --timezone Europe/Warsaw
  sklvalve import monday.csv tuesday.csv --out recording.parquet --period 5
  sklvalve import campaign.csv --out run.csv --time-column elapsed --skip-rows 3
  sklvalve import year.csv --out march.csv --from 2026-03-01 --until 2026-03-07
"""


def add_parser(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "import",
        help="make a historian's export a clean recording",
        description="Read an export as it is (long or wide format, local time, decimal commas, bad-quality "
        "texts, uneven stamps, titles above the table), write a recording on one regular time base, and say "
        "what was done to each tag; the same goes beside it as RECORDING.import.json. Where the clock starts "
        "again, as in runs put one behind the other, each run becomes a recording: RECORDING_1, RECORDING_2.",
        epilog=_EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument("export", metavar="EXPORT", nargs="+", help="text files of one export")
    parser.add_argument("--out", required=True, metavar="RECORDING", help="a .csv, .csv.gz or .parquet file")
    parser.add_argument("--timezone", metavar="ZONE", help="of local times: Europe/Warsaw, or +01:00")
    parser.add_argument(
        "--time-column", type=column_name, metavar="NAME", help="column of the times (default: detected)"
    )
    parser.add_argument(
        "--skip-rows",
        type=_lines,
        default=0,
        metavar="N",
        help="leave out the first N lines of each file (default: 0)",
    )
    parser.add_argument(
        "--header",
        type=_header,
        metavar="LINE",
        help="line of the file, from 1, with the names of the columns, or none (default: detected)",
    )
    parser.add_argument(
        "--period", type=_positive, metavar="S", help="seconds between rows (default: from the stamps)"
    )
    parser.add_argument(
        "--from",
        dest="begin",
        metavar="TIME",
        help="leave out what is earlier: 2026-01-12, or with a time of day",
    )
    parser.add_argument("--until", metavar="TIME", help="leave out what is later; a day is kept whole")
    parser.add_argument(
        "--gap",
        type=_steps,
        default=5.0,
        metavar="N",
        help="leave gaps of more than N usual steps empty (default: 5)",
    )
    parser.add_argument(
        "--dates", choices=("day-first", "month-first"), help="how to read 03/04/2024 (default: detected)"
    )
    parser.add_argument(
        "--decimal", choices=("point", "comma"), help="what decimals begin with (default: detected)"
    )
    parser.add_argument("--encoding", metavar="NAME", help="of the files, such as cp1250 (default: detected)")
    parser.add_argument("--keep-uncertain", action="store_true", help="keep values of uncertain quality")
    parser.add_argument(
        "--hold", action="append", default=[], metavar="TAG", help="hold the last value between its reports"
    )
    parser.add_argument(
        "--linear",
        action="append",
        default=[],
        metavar="TAG",
        help="draw a straight line between its reports",
    )
    add_json_argument(parser, "the account")
    parser.set_defaults(run=run)


def run(args: Namespace) -> int:
    """Import an export."""
    from sklvalve.cli.progress import progress
    from sklvalve.cli.staging import Staging
    from sklvalve.recording.historian import ImportSettings, import_runs
    from sklvalve.recording.historian.summary import summary
    from sklvalve.recording.historian.write import write_recording

    out, beside = _targets(args)
    settings = ImportSettings(
        zone=args.timezone,
        period=args.period,
        gap=args.gap,
        day_first=None if args.dates is None else args.dates == "day-first",
        decimal={"point": ".", "comma": ",", None: None}[args.decimal],
        encoding=args.encoding,
        keep_uncertain=args.keep_uncertain,
        hold=tuple(args.hold),
        linear=tuple(args.linear),
        time_column=args.time_column,
        skip_rows=args.skip_rows,
        header=args.header,
        begin=args.begin,
        end=args.until,
    )
    with (
        Staging(out.parent, (out.name, beside.name), called=f"--out {out.name} in") as staging,
        progress() as say,
    ):
        made = import_runs(args.export, settings, say)
        outs = [out]
        if len(made.runs) > 1:
            outs = _numbered(out, len(made.runs))
            _require_no_export(outs, args.export)
            staging.instead(out.name, [each.name for each in outs])
            for run, each in zip(made.account["runs"], outs, strict=True):
                run["recording"] = each.name
        for stale in _earlier(out, beside) - set(outs):
            if not _is_one_of(stale, args.export):
                staging.drop(stale.name)
        told = as_json(made.account)
        for run, each in zip(made.runs, outs, strict=True):
            write_recording(staging.path(each.name), run.stamps, run.columns)
        staging.path(beside.name).write_text(told + "\n", encoding="utf-8")
        staging.commit()
    if args.json:
        show(told)
        return 0
    show(summary(made.account))
    written = str(out) if len(outs) == 1 else f"{outs[0]} to {outs[-1].name}"
    show(f"\nWritten: {written}, {beside}\nNext: sklvalve init {outs[0]}")
    return 0


def _targets(args: Namespace) -> tuple[Path, Path]:
    """Paths of the recording and of the account, refused where they would overwrite an input."""
    from sklvalve.recording.historian.write import require_suffix

    out = Path(args.out)
    require_suffix(out)
    _require_no_export([out], args.export)
    return out, out.with_name(f"{_parted(out)[0]}.import.json")


def _require_no_export(outs: list[Path], exports: list[str]) -> None:
    from sklvalve.recording import InputError

    for out in outs:
        if _is_one_of(out, exports):
            raise InputError(f"--out {out}: this is the export itself; name another file")


def _is_one_of(path: Path, exports: list[str]) -> bool:
    return path.exists() and any(Path(given).exists() and path.samefile(given) for given in exports)


def _parted(out: Path) -> tuple[str, str]:
    """Name of the recording without its ending, and the ending."""
    stem = out.name
    for suffix in (".gz", ".csv", ".parquet"):
        stem = stem[: -len(suffix)] if stem.lower().endswith(suffix) else stem
    return stem, out.name[len(stem) :]


def _numbered(out: Path, count: int) -> list[Path]:
    """Paths of the recordings of several runs."""
    stem, suffix = _parted(out)
    digits = len(str(count))
    return [out.with_name(f"{stem}_{number:0{digits}d}{suffix}") for number in range(1, count + 1)]


def _earlier(out: Path, beside: Path) -> set[Path]:
    """The recordings that the account of an earlier import says it made under this name."""
    try:
        runs = json.loads(beside.read_text(encoding="utf-8"))["runs"]
        told = {run["recording"] for run in runs}
    except (OSError, ValueError, LookupError, TypeError):
        return set()
    # of an account that was changed by hand, only names that such an import gives
    stem, suffix = map(re.escape, _parted(out))
    names = {name for name in told if isinstance(name, str) and re.fullmatch(rf"{stem}_\d+{suffix}", name)}
    return {out.with_name(name) for name in names}


def _lines(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = -1
    if value < 0:
        raise ArgumentTypeError(f"expected a number of lines, 0 or more; got {text!r}")
    return value


def _header(text: str) -> int:
    """Line of the names; 0 where there are none."""
    if text.strip().casefold() == "none":
        return 0
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise ArgumentTypeError(f"expected the number of a line, 1 or more, or none; got {text!r}")
    return value


def _steps(text: str) -> float:
    value = _positive(text)
    if value > 1e6:
        raise ArgumentTypeError(f"expected at most 1e6 steps; got {text!r}")
    return value


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise ArgumentTypeError(f"expected a number above 0; got {text!r}")
    return value
