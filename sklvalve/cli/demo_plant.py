# SPDX-License-Identifier: BSD-3-Clause
"""``sklvalve demo --plant``: twenty valves over sixty days, watched, and then the truth."""

import json
from argparse import Namespace
from pathlib import Path

from sklvalve.cli.as_json import as_json
from sklvalve.cli.diagnose import require_extras
from sklvalve.cli.terminal import show
from sklvalve.cli.watch import content_of, lines_of, report_of

_VALVES, _DAYS = 20, 60


def run(args: Namespace) -> int:
    """Make a plant, watch it, tell the truth."""
    from sklvalve.cli.progress import progress
    from sklvalve.datasets.valve_days import write_plant
    from sklvalve.watch.plant import read_plant
    from sklvalve.watch.run import watch
    from sklvalve.watch.site import write_site

    require_extras()
    place = _folder(args.out)
    if not (place / "plant.toml").exists():
        write_plant(place, valves=_VALVES, days=_DAYS, random_state=args.seed)
    plant = read_plant(place / "plant.toml")
    with progress() as callback:
        watches = watch(plant, place / "rows", place / "state", report=report_of(callback))
    index = write_site(place / "site", plant, watches, place / "state", n_jobs=None)
    content = content_of(plant, watches, place / "state")
    truth = json.loads((place / "truth.json").read_text(encoding="utf-8"))
    judgements = {each["tag"]: judge(each, truth[each["tag"]]) for each in content["valves"]}
    if args.json:
        show(
            as_json({"schema": "sklvalve.demo/1", "watch": content, "truth": truth, "judgement": judgements})
        )
        return 0
    show("\n".join(lines_of(content)))
    show("\nThe truth")
    for tag, each in truth.items():
        if each is not None or judgements[tag] != "right":
            what = f"{each['effect']} from {each['first_day']} on" if each else "nothing"
            show(f"  {tag}: {what}. {judgements[tag].capitalize()}.")
    show(f"\nThe pages begin at {index}; all files are in {place}")
    return 0


def judge(valve: dict, truth: dict | None) -> str:
    """Say whether what was told of a valve is right.

    Parameters
    ----------
    valve : dict
        As `content_of` has it.
    truth : dict or None
        Effect and first day; None where nothing was concealed.
    """
    called, call = valve["called"], valve["call"]
    if call is None:
        return "right" if truth is None else "went unnoticed"
    if truth is None:
        return "called without a reason"
    if called < truth["first_day"]:
        return "called before it began"
    named = [set(each.split("/")) for each in call["names"]]
    if not named:
        return f"called on {called}, not named"
    right = len(named) == 1 and truth["effect"] in named[0]
    return f"called on {called}, {'named rightly' if right else 'named wrongly'}"


def _folder(out: str) -> Path:
    """The folder, refused where it holds something else."""
    from sklvalve.recording import InputError

    place = Path(out)
    if place.exists() and not place.is_dir():
        raise InputError(f"--out {place}: this is a file; name a folder")
    ours = {"rows", "sheets", "plant.toml", "truth.json", "state", "site"}
    if place.is_dir() and (strange := {each.name for each in place.iterdir()} - ours):
        raise InputError(f"--out {place}: it holds {min(strange)}, no part of a demonstration; name another")
    return place
