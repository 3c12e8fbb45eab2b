# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve demo``: conceals an effect, finds it from the files alone, then tells the truth."""

import json
from argparse import Namespace, RawDescriptionHelpFormatter
from pathlib import Path
from typing import TYPE_CHECKING

from sklvalve.cli.as_json import add_json_argument, as_json
from sklvalve.cli.diagnose import RESULTS, diagnose, require_extras
from sklvalve.cli.parser import folder, seed
from sklvalve.cli.terminal import show, text_width

if TYPE_CHECKING:
    from sklvalve.mismatch import MissingPhysicsFinder

# Nothing at all, effects that the catalogue knows, and three that no catalogue holds.
DRAWN = (
    None,
    "backlash",
    "linkage_backlash",
    "stiction",
    "positioner_deadband",
    "supply_pressure_drop",
    "dead_time",
    "choked_flow",
    "seat_leakage",
    "bypass_open",
    "clogging",
    "wrong_characteristic",
    "piping_reducers",
    "capacity_error",
    "position_sensor_bias",
    "flow_meter_gain",
    "flow_meter_bias",
    "trim_rotation",
    "thermal_bow",
    "hydrate_pulses",
)
# Forty minutes are diagnosed in seconds. That they tell as much as hours of a quiet loop, the command goes
# over most of the travel, and the sensors are good ones.
_TELLING = {"loop": "wide", "noise": 0.5, "n_samples": 2400, "n_later": 600}
# of the draws one that conceals play behind the stem: the position looks sound, the flow does not
_SEED = 34
_EXAMPLES = """examples:
  sklvalve demo
  sklvalve demo --seed 7 --out another
  sklvalve demo --plant --out plant
"""
_FILES = ("recording.csv", "later.csv", "valve.toml", "truth.json")


def add_parser(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "demo",
        help="conceal an effect, find it, then tell the truth",
        description="Record a simulated valve loop in which an effect drawn by the seed (or none) is "
        "concealed, by a simulator that shares no code with the diagnosis; diagnose the files; then tell "
        "what was concealed and whether the finding is right.",
        epilog=_EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--out", type=folder, default="sklvalve-demo", metavar="DIR", help="folder (default: %(default)s)"
    )
    parser.add_argument(
        "--plant",
        action="store_true",
        help="make twenty valves over sixty days instead, in five of which something develops, and watch "
        "them; takes some minutes",
    )
    parser.add_argument(
        "--seed", type=seed, default=_SEED, metavar="N", help="of the draw (default: %(default)s)"
    )
    add_json_argument(parser, "diagnosis, truth and judgement")
    parser.set_defaults(run=run)


def run(args: Namespace) -> int:
    """Conceal, diagnose, tell."""
    if args.plant:
        from sklvalve.cli import demo_plant

        return demo_plant.run(args)
    from sklvalve.cli.staging import Staging
    from sklvalve.datasets import make_valve_recording
    from sklvalve.datasets.concealed import to_toml
    from sklvalve.recording import read_recording
    from sklvalve.report import to_text

    require_extras()
    settings = draw(args.seed)
    with Staging(args.out, (*_FILES, *RESULTS)) as staging:
        made = make_valve_recording(**settings, return_truth=False)
        made.frame.to_csv(staging.path("recording.csv"), index=False)
        made.later.to_csv(staging.path("later.csv"), index=False)
        staging.path("valve.toml").write_text(to_toml(made.valve), encoding="utf-8")
        if not args.json:
            show(f"Recorded a valve loop with something, or nothing, concealed in it (seed {args.seed}).\n")

        recording = read_recording(staging.path("recording.csv"), staging.path("valve.toml"))
        finder = diagnose(recording, staging, until=None, seed=0)
        found = finder.diagnosis_.to_dict()
        if not args.json:
            show(to_text(found, width=text_width()))
            show(_on_later(finder, staging.path("later.csv"), staging.path("valve.toml")))

        # the same draw again, and only now with its truth
        truth = make_valve_recording(**settings).truth
        staging.path("truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
        staging.commit()
    if args.json:
        told = {"diagnosis": found, "truth": truth, "judgement": judge(found, truth)}
        show(as_json({"schema": "sklvalve.demo/1", "written": args.out} | told))
        return 0
    show(f"\nThe truth     {tell(truth)}\n              {judge(found, truth)}")
    show(f"\nThe report is {Path(args.out) / 'report.html'}; all files are in {args.out}")
    return 0


def draw(seed: int) -> dict:
    """Settings of the recording that a seed stands for."""
    import numpy as np

    rng = np.random.default_rng(seed)
    return {
        "effect": DRAWN[rng.integers(len(DRAWN))],
        "onset": None,
        "random_state": int(rng.integers(2**31 - 1)),
        **_TELLING,
    }


def judge(found: dict, truth: dict) -> str:
    """Say in a sentence whether a finding is right.

    Named effects are right where each true one lies in a class and no class lacks a true one.
    """
    classes = [{member["name"] for member in effect["members"]} for effect in found["effects"]]
    true = set(truth["effects"])
    if found["verdict"] == "cannot_tell":
        among = true and true <= set().union(*classes)
        listed = "among the candidates" if among else "not among the candidates"
        return f"The finding left it open; the truth is {listed}." if true else "The finding left it open."
    if found["verdict"] == "no_mismatch" != truth["verdict"]:
        return "The finding is wrong: what was concealed went unnoticed."
    if found["verdict"] != truth["verdict"]:
        return "The finding is wrong."
    if truth["verdict"] != "named":
        return "The finding is right."
    covered = all(any(name in members for members in classes) for name in true)
    if covered and all(members & true for members in classes):
        return "The finding is right."
    return "The finding is right in part only." if covered else "The finding is wrong."


def tell(truth: dict) -> str:
    """The truth of a recording in a sentence."""
    from sklvalve.report.place import duration
    from sklvalve.report.words import either, number, spoken

    if not truth["concealed"]:
        return "Nothing was concealed: a healthy valve within its data-sheet tolerances."
    sizes = [
        f"{spoken(name)} ({number(truth['strengths'][name])} {_unit(truth['units'][name])})"
        for name in truth["concealed"]
    ]
    since = f"from {duration(truth['onset'])} on" if truth["onset"] > 0.0 else "from the start"
    alien = "" if truth["effects"] else ", which is not in the catalogue"
    return f"Concealed: {either(sizes, 'and')}, {since}{alien}."


def _unit(unit: str) -> str:
    return {"1": "as a share", "kv_rated": "of the rated capacity", "span": "of the span"}.get(unit, unit)


def _on_later(finder: "MissingPhysicsFinder", path: Path, valve: Path) -> str:
    """Errors on the recording's continuation, which the diagnosis has not seen."""
    import numpy as np

    from sklvalve.metrics import rmse
    from sklvalve.recording import read_recording
    from sklvalve.report.words import number

    later = read_recording(path, valve)
    parts = []
    for role in ("opening", "flow"):
        errors = []
        for simulation in (finder.nominal_simulation_, finder.corrected_simulation_):
            pair = [
                later.in_recorded_units(role, values)
                for values in (later[role], simulation.simulate(later)[role])
            ]
            good = np.isfinite(pair[0]) & np.isfinite(pair[1])
            errors.append(number(rmse(pair[0][good], pair[1][good])))
        parts.append(f"{role} {errors[0]} before, {errors[1]} after the correction [{later.unit(role)}]")
    return f"\nLater rows    RMSE in later.csv, which no step has used: {'; '.join(parts)}"
