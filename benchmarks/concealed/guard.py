# SPDX-License-Identifier: BSD-3-Clause
"""A small benchmark whose draws are kept: healthy records, and one of each effect.

    python -m benchmarks.concealed.guard judge --jobs 2
    python -m benchmarks.concealed.guard draw

`judge` diagnoses every record and prints what became of it (minutes); the tests do so with the healthy ones
and every third of the others. `draw` draws it anew (minutes) and writes `guard.json` beside this file: seeds
and sizes, no recordings. Sizes are three times what each record could just tell; an effect that cannot be so
large in eight plants is left out. `records` makes the recordings again, within seconds.
"""

import argparse
import json
import tempfile
import zlib
from collections import Counter
from dataclasses import replace
from pathlib import Path

from joblib import Parallel, delayed

from benchmarks.concealed.cases import STEPS, Case, plan
from benchmarks.concealed.draw import ATTEMPTS, write
from benchmarks.concealed.judging import line_of
from benchmarks.concealed.plant import EFFECTS
from benchmarks.concealed.record import Impossible, make
from benchmarks.concealed.scoring.detection import alarms
from benchmarks.concealed.scoring.lines import of_kind
from benchmarks.concealed.scoring.naming import wrong_name
from benchmarks.concealed.scoring.outcome import judge

FILE = Path(__file__).with_name("guard.json")
# another seed would be another guard: this one was chosen before anything was diagnosed
SEED, ROWS, HEALTHY = 71203, 2400, 9


def drawn():
    """What `guard.json` holds."""
    kept, seen = [], set()
    for case in plan(SEED, healthy=HEALTHY, each=len(STEPS), pairs=0, outside=0, defects=0):
        new = case.kind == "healthy" or (case.step == max(STEPS) and case.effects not in seen)
        if not new:
            continue
        # what is not recorded is another question
        case = replace(case, nasty=tuple(way for way in case.nasty if not way.startswith("no_")))
        for attempt in range(ATTEMPTS):
            seed = zlib.crc32(f"{SEED} {case.number} {attempt}".encode())
            try:
                strengths = make(case, seed, rows=ROWS, distances=False).truth["strengths"]
            except Impossible:
                continue
            seen.add(case.effects)
            kept.append({"case": vars(case), "seed": seed, "strengths": strengths})
            print(case.name, case.kind, strengths, flush=True)
            break
    return kept


def records(folder, effects=tuple(EFFECTS), *, healthy=True, every=1):
    """Write the records of these effects, and the healthy ones unless told not to, into a folder.

    Parameters
    ----------
    folder : Path
    effects : tuple of str, default=all
    healthy : bool, default=True
    every : int, default=1
        Every so many of those with an effect only.

    Returns
    -------
    places : list of Path
    """
    places, met = [], 0
    for entry in json.loads(FILE.read_text(encoding="utf-8")):
        told = {key: tuple(v) if isinstance(v, list) else v for key, v in entry["case"].items()}
        case = Case(**told)
        if not set(case.effects) <= set(effects) or not (case.effects or healthy):
            continue
        met += bool(case.effects)
        if case.effects and (met - 1) % every:
            continue
        place = Path(folder) / case.name
        write(place, make(case, entry["seed"], rows=ROWS, strengths=entry["strengths"], distances=False))
        places.append(place)
    return places


def lines_of(places, jobs):
    """A line of scores for each record."""
    return Parallel(n_jobs=jobs)(delayed(line_of)(place, "sklvalve") for place in places)


def judged(jobs):
    """Sentences that say what became of every record, and the rates of all."""
    with tempfile.TemporaryDirectory() as folder:
        lines = lines_of(records(folder), jobs)
    single = of_kind(lines, "single")
    for line in single:
        yield f"{line['record']} {', '.join(line['truth']['effects'])}: {judge(line)}"
    yield f"alarms on healthy valves: {alarms(of_kind(lines, 'healthy'))}"
    yield f"records with one effect: {dict(Counter(judge(line) for line in single))}"
    yield f"records with a wrong name: {wrong_name(lines)}"


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.guard", description=__doc__.splitlines()[0]
    )
    parser.add_argument("what", choices=("judge", "draw"))
    parser.add_argument("--jobs", type=int, default=2, help="processes; 2")
    options = parser.parse_args(arguments)
    if options.what == "judge":
        for line in judged(options.jobs):
            print(line)
    else:
        FILE.write_text(json.dumps(drawn(), indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
