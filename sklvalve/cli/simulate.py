# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve simulate``: a recording of the DAMADICS benchmark's actuator, sound or with a fault."""

from argparse import ArgumentTypeError, Namespace, RawDescriptionHelpFormatter
from pathlib import Path
from typing import TYPE_CHECKING

from sklvalve.cli.as_json import add_json_argument, as_json
from sklvalve.cli.parser import folder, seconds, seed
from sklvalve.cli.terminal import show

if TYPE_CHECKING:
    from pandas import DataFrame

    from sklvalve.damadics import LevelLoop, Profile
    from sklvalve.damadics.scenarios import Scenario

_SHEET = "valve.toml"
# a loop's level and stem have come to rest by then [s]
_SETTLES = 300
_PROFILES = ("abrupt", "incipient", "short", "medium", "long")
_DESCRIPTION = """\
Record the actuator of the DAMADICS benchmark once a second, sound, in one of the benchmark's scenarios, or
with a fault of your own, and write beside it the valve.toml with which sklvalve diagnose reads it. The
column X_nominal is the stem of the sound actuator: the simulation that the diagnosis corrects. A --loop
has none, because its command would differ: it is diagnosed by its data sheet, and recorded only once it
has settled."""
_EPILOG = """\
scenarios: a fault and its size, f7_big or f2_incipient; the fault begins after 900 s
  small, medium, big  f1 f7 f8 f10 f12 f13 f14 f16 f18 f19
  big alone           f2 f11 f15 f17
  incipient           f2 f3 f4 f5 f6 f9 f11 f13 f17 f18

examples:
  sklvalve simulate --out run/sound.csv --seed 1
  sklvalve simulate --scenario f13_incipient --out run/f13.csv.gz
  sklvalve simulate --fault f7 --strength 0.5 --begins 300 --duration 1800 --out run/f7.parquet
  sklvalve simulate --loop --out loop/sound.csv
  sklvalve diagnose run/f13.csv.gz --valve run/valve.toml --out results"""


def add_parser(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "simulate",
        help="record the actuator of the DAMADICS benchmark, with a fault or without",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--out", type=folder, required=True, metavar="FILE", help="a .csv, .csv.gz or .parquet file"
    )
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--scenario", metavar="NAME", help="one of the benchmark's, see below")
    which.add_argument("--fault", metavar="F", help="f1 to f19")
    parser.add_argument(
        "--strength",
        type=float,
        metavar="X",
        help="of the fault, from 0 or -1 to 1 (default: 0.75 where it comes at once, else 1, of the "
        "benchmark's sign); one such as -1e-1 is written --strength=-1e-1",
    )
    parser.add_argument(
        "--profile",
        choices=_PROFILES,
        help="of the fault: at once (the default), growing as fast as the benchmark has it, or to a strength "
        "of 1 within 900, 3600 or 86400 s",
    )
    parser.add_argument("--begins", type=float, metavar="SECONDS", help="when the fault does (default: 900)")
    parser.add_argument(
        "--duration",
        type=seconds,
        metavar="SECONDS",
        help="of the recording (default: the scenario's own; till 600 s after a fault has developed; 1500 s)",
    )
    parser.add_argument(
        "--actuator", type=int, choices=(1, 2, 3), default=3, help="3 is the benchmark's own (default)"
    )
    parser.add_argument("--loop", action="store_true", help="the valve holds the level of a tank")
    parser.add_argument(
        "--settled",
        type=_settled,
        metavar="SECONDS",
        help="whole seconds that the actuator has run from rest before the recording begins (default: 300 in "
        "a --loop, else 0, as the benchmark has it)",
    )
    parser.add_argument("--seed", type=seed, default=0, metavar="N", help="of the noise (default: 0)")
    parser.add_argument("--without-noise", action="store_true", help="of the sensors")
    parser.add_argument(
        "--extended", action="store_true", help="add chamber pressure, controller output and true values"
    )
    add_json_argument(parser, "what was written")
    parser.set_defaults(run=run)


def run(args: Namespace) -> int:
    """Simulate and write."""
    from sklvalve.cli.progress import progress
    from sklvalve.cli.staging import Staging
    from sklvalve.damadics import make_damadics, valve_sheet
    from sklvalve.damadics.scenarios import Scenario
    from sklvalve.datasets.concealed import to_toml
    from sklvalve.recording import InputError

    scenario = _scenario(args)
    profile = scenario.profile if isinstance(scenario, Scenario) else scenario
    if profile and args.duration and args.duration <= profile.begins:
        raise InputError(
            f"--duration {args.duration:g}: {profile.fault} begins after {profile.begins:g} s; give more, or "
            "an earlier --begins"
        )
    loop = _loop(args)
    # without a simulated stem the start from rest would be found to be a fault
    settled = args.settled if args.settled is not None else _SETTLES if loop else 0
    tag = f"DAMADICS actuator {args.actuator}"
    sheet = to_toml(valve_sheet(args.actuator, nominal=not loop, tag=tag))
    out = _target(args.out, sheet)
    with (
        Staging(
            out.parent,
            [out.name, _SHEET],
            called=f"--out {out.name} in",
            guard=lambda: _target(args.out, sheet),
        ) as staging,
        progress() as say,
    ):
        frame = make_damadics(
            scenario,
            duration=args.duration,
            settled=settled,
            actuator=args.actuator,
            loop=loop,
            extended=args.extended,
            nominal=not loop,
            noise=not args.without_noise,
            random_state=args.seed,
            callback=say,
        )
        _write(frame, staging.path(out.name))
        staging.path(_SHEET).write_text(sheet, encoding="utf-8")
        staging.commit()
    sheet_file = out.parent / _SHEET
    if args.json:
        written = {"written": [str(out), str(sheet_file)], "rows": len(frame), "fault": _content(profile)}
        show(as_json({"schema": "sklvalve.simulate/1"} | written))
    else:
        begun = f" begun {settled} s after a start from rest," if settled else ""
        show(f"Written: {out} ({len(frame)} rows,{begun} {_told(profile)}) and {sheet_file}")
    return 0


def _settled(text: str) -> int:
    """Whole seconds, 0 or more."""
    if not text.isdecimal():
        raise ArgumentTypeError(f"expected whole seconds, 0 or more; got {text!r}")
    return int(text)


def _loop(args: Namespace) -> "LevelLoop | None":
    """The benchmark's loop, where it is asked for and fits the actuator."""
    from sklvalve.damadics import LevelLoop, preset
    from sklvalve.recording import InputError

    if not args.loop:
        return None
    loop = LevelLoop()
    try:
        loop.require_fit(preset(args.actuator))
    except ValueError as error:
        raise InputError(f"--loop --actuator {args.actuator}: {str(error).rstrip('.')}") from None
    return loop


def _scenario(args: Namespace) -> "Scenario | Profile | None":
    """What is asked of the faults; a ValueError of theirs is one of the words on the command line."""
    from sklvalve.damadics import FAULTS, SCENARIOS, course
    from sklvalve.recording import InputError
    from sklvalve.recording.errors import hint

    own = {name: getattr(args, name) for name in ("strength", "profile", "begins")}
    given = {name: value for name, value in own.items() if value is not None}
    if given and not args.fault:
        raise InputError(f"--{next(iter(given))} says how a --fault is; name the fault too, f1 to f19")
    if args.scenario:
        if args.scenario not in SCENARIOS:
            raise InputError(
                f"--scenario {args.scenario}: no such scenario; {hint(args.scenario, SCENARIOS)}"
            )
        return SCENARIOS[args.scenario]
    if not args.fault:
        return None
    if args.fault not in FAULTS:
        raise InputError(f"--fault {args.fault}: no such fault; give one of f1 to f19")
    try:
        return course(args.fault, **given)
    except ValueError as error:
        told = str(error).rstrip(".")
        options = " or ".join(f"--{name}" for name in given)
        # a few sentences say themselves what to give
        mend = "" if "; give " in told else f"; change {options}, or leave it out"
        raise InputError(f"--fault {args.fault}: {told}{mend}") from None


def _target(name: str, sheet: str) -> Path:
    """Path of the recording, refused where its kind is not known or another valve's sheet lies beside it."""
    from sklvalve.recording import InputError
    from sklvalve.recording.reader import SUFFIXES

    out = Path(name)
    if not out.name.endswith(SUFFIXES):
        raise InputError(f"--out {out}: expected a file named .csv, .csv.gz or .parquet; name it so")
    beside = out.parent / _SHEET
    there = beside.read_text(encoding="utf-8", errors="replace") if beside.is_file() else sheet
    if there != sheet:
        # the tag stands in the line below the first
        same = there.splitlines()[:2] == sheet.splitlines()[:2]
        what = "this valve's recordings of the other kind, --loop or not," if same else "another valve"
        raise InputError(f"--out {out}: {beside} describes {what} and would be replaced; name another folder")
    return out


def _write(frame: "DataFrame", path: Path) -> None:
    if path.suffix == ".parquet":
        frame.to_parquet(path, index=False)
        return
    # a fixed time stamp inside the archive, so that one seed gives the same bytes
    packing = {"method": "gzip", "mtime": 1} if path.suffix == ".gz" else None
    frame.to_csv(path, index=False, float_format="%.7g", compression=packing)


def _content(profile: "Profile | None") -> dict[str, object] | None:
    if profile is None:
        return None
    return {key: getattr(profile, key) for key in ("fault", "strength", "begins", "takes")}


def _told(profile: "Profile | None") -> str:
    """What is wrong with the actuator, in a few words."""
    from sklvalve.damadics import FAULTS

    if profile is None:
        return "no fault"
    takes = abs(profile.strength) * profile.takes
    how = "at once" if takes == 0.0 else f"grown in {takes:g} s"
    title = FAULTS[profile.fault].title
    return f"{profile.fault}, {title}, of {profile.strength:g} from {profile.begins:g} s on, {how}"
