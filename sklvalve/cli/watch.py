# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve watch``: many valves, each day held against the valve's own history."""

import datetime as dt
import sys
from argparse import ArgumentTypeError, Namespace, RawDescriptionHelpFormatter
from collections.abc import Callable
from pathlib import Path

from sklvalve.cli.as_json import add_json_argument, as_json
from sklvalve.cli.parser import folder, seed
from sklvalve.cli.terminal import show

_EXAMPLES = """examples:
  sklvalve watch plant.toml --data rows --state state --site site
  sklvalve watch plant.toml --data rows --state state --site site --serve
  sklvalve watch plant.toml --state state --inspected FV-101 --on 2026-03-01 --note "packing renewed"
"""

_PORT, _MINUTES, _A_WEEK = 8000, 60, 10_080


def add_parser(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "watch",
        help="watch many valves, day after day, and call for attention where one has changed",
        description="Hold each new day of every valve against the valve's own history, and call for "
        "attention where one has changed, no more often without a reason than plant.toml allows. A valve "
        "that calls is diagnosed. Run it once a day; days that were read are not read again.",
        epilog=_EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument("plant", metavar="PLANT", help="plant.toml: valves, their sheets and their rows")
    parser.add_argument("--data", type=folder, metavar="DIR", help="folder in which each valve has its own")
    parser.add_argument("--state", type=folder, required=True, metavar="DIR", help="folder for what is kept")
    parser.add_argument(
        "--site", type=folder, metavar="DIR", help="folder for the pages; none are made without"
    )
    parser.add_argument(
        "--serve", type=_port, nargs="?", const=_PORT, metavar="PORT",
        help=f"show the pages to browsers of this machine until interrupted (default port: {_PORT})",
    )  # fmt: skip
    parser.add_argument(
        "--every",
        type=_minutes,
        metavar="MINUTES",
        help=f"look for new days while serving (default: {_MINUTES})",
    )
    parser.add_argument("--jobs", type=_jobs, metavar="N", help="processes (default: one a processor)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="Dask scheduler, in place of processes")
    parser.add_argument("--inspected", metavar="TAG", help="enter that this valve was inspected or mended")
    parser.add_argument("--on", type=_day, metavar="DAY", help="day of the inspection (default: today)")
    parser.add_argument("--note", default="", metavar="TEXT", help="what was found or done")
    parser.add_argument("--seed", type=seed, default=0, metavar="N", help="of the random draws (default: 0)")
    add_json_argument(parser, "how each valve stands")
    parser.set_defaults(run=run)


def run(args: Namespace) -> int:
    """Watch a plant, or enter an inspection."""
    from sklvalve.recording import InputError
    from sklvalve.watch.plant import read_plant
    from sklvalve.watch.run import inspected
    from sklvalve.watch.serve import serve, server_of

    plant = read_plant(args.plant)
    if args.inspected is not None:
        day = args.on or dt.date.today()
        inspected(plant, args.state, args.inspected, day, args.note)
        show(f"Entered: {args.inspected} inspected on {day}. Its history begins anew from that day on.")
        return 0
    if args.on is not None or args.note:
        raise InputError("--on and --note belong to an inspection; give the valve as --inspected TAG")
    if args.data is None:
        raise InputError("--data is missing; give the folder in which each valve has its own")
    if args.serve is not None and args.site is None:
        raise InputError("--serve shows the pages of --site; give the folder for them as well")
    if args.every is not None and args.serve is None:
        raise InputError("--every belongs to --serve; a run without it looks once")

    if args.serve is None:
        _look(args, plant)
        return 0

    def look_again() -> None:
        try:
            _look(args, plant)
        except Exception as error:
            # a folder that is away for an hour, or a full disk, ends no server
            show(f"Not brought up to date: {type(error).__name__}: {error}", file=sys.stderr)

    # a port that is taken is told before the valves are read
    server = server_of(args.site, args.serve)
    show(f"Open http://127.0.0.1:{args.serve} in a browser of this machine; Ctrl-C ends it.", file=sys.stderr)
    serve(server, lambda: _look(args, plant), look_again, 60.0 * (args.every or _MINUTES))
    return 0


def _look(args: Namespace, plant) -> None:
    """Bring valves and pages up to date, and tell how they stand."""
    from sklvalve.cli.progress import progress
    from sklvalve.watch.run import watch
    from sklvalve.watch.site import write_site

    with progress() as callback:
        watches = watch(
            plant,
            args.data,
            args.state,
            n_jobs=args.jobs,
            scheduler=args.scheduler,
            random_state=args.seed,
            report=report_of(callback),
        )
    content = content_of(plant, watches, Path(args.state))
    lines = lines_of(content)
    if args.site is not None:
        index = write_site(
            args.site, plant, watches, args.state, n_jobs=args.jobs or (1 if args.scheduler else None)
        )
        content |= {"site": str(index)}
        lines += ["", f"Written: {index}"]
    show(as_json(content) if args.json else "\n".join(lines))


def report_of(callback: Callable[[str, float], None] | None) -> Callable[[int, int, str], None] | None:
    """What tells a progress bar of every valve that is done."""
    if callback is None:
        return None
    return lambda done, every, tag: callback(f"watching {tag}", done / every)


def content_of(plant, watches, state: Path) -> dict:
    """How each valve stands, as plain data."""
    from dataclasses import asdict

    from sklvalve.watch.standing import epochs_of, standing_of, state_now
    from sklvalve.watch.store import Store

    store = Store(state)
    valves = []
    for each in watches:
        # of its calls alone: the days need not be read for these
        now = standing_of(each.tag, store, epochs_of(each.tag, store)[-1], records=())
        valves.append(
            {
                "tag": each.tag,
                "state": state_now(each.state, now),
                "said": list(each.said),
                "since": now.since or None,
                "called": now.called or None,
                "call": None if now.call is None else asdict(now.call),
                "looks": [asdict(look) for look in (*now.looks, *now.calls)],
            }
        )
    return {"schema": "sklvalve.watch/1", "plant": plant.name, "valves": valves}


def lines_of(content: dict) -> list[str]:
    """The same for a terminal: what calls for attention first."""
    valves = content["valves"]
    calling = [each for each in valves if each["state"] == "calls"]
    lines = [f"{content['plant']}: {len(calling)} of {len(valves)} valves call for attention."]
    for each in calling:
        call = each["call"]
        lines += [
            "",
            f"{each['tag']}  since {each['since']}, called {each['called']}",
            f"  {call['headline']}",
        ]
    others = [each for each in valves if each["state"] in ("no data", "commissioning", "cannot tell")]
    if others:
        lines += ["", "Nothing is told yet of:"]
        lines += [f"  {each['tag']}: {each['state']}. {' '.join(each['said'])}".rstrip() for each in others]
    noted = [each for each in valves if each not in others and each["said"]]
    if noted:
        lines += ["", "Data to be looked at:"]
        lines += [f"  {each['tag']}: {sentence}" for each in noted for sentence in each["said"][-3:]]
    return lines


def _jobs(text: str) -> int:
    try:
        many = int(text)
    except ValueError:
        many = 0
    if many < 1:
        raise ArgumentTypeError(f"expected a whole number from 1 on; got {text!r}")
    return many


def _minutes(text: str) -> int:
    return _from_one(text, _A_WEEK, "whole minutes")


def _port(text: str) -> int:
    return _from_one(text, 65_535, "a port")


def _from_one(text: str, most: int, what: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= most:
        raise ArgumentTypeError(f"expected {what} from 1 to {most}; got {text!r}")
    return int(text)


def _day(text: str) -> dt.date:
    try:
        return dt.date.fromisoformat(text)
    except ValueError:
        raise ArgumentTypeError(f"expected a day such as 2026-01-31; got {text!r}") from None
