# SPDX-License-Identifier: BSD-3-Clause
"""A small benchmark whose draws are kept, for the tests: healthy records, and one of each effect.

    python -m benchmarks.concealed.guard

draws it anew (minutes) and writes `guard.json` beside this file: seeds and sizes, no recordings. Sizes are
three times what each record could just tell; an effect that cannot be so large in eight plants is left out.
`records` makes the recordings again, within seconds.
"""

import json
import zlib
from dataclasses import replace
from pathlib import Path

from benchmarks.concealed.cases import STEPS, Case, plan
from benchmarks.concealed.draw import ATTEMPTS, write
from benchmarks.concealed.plant import EFFECTS
from benchmarks.concealed.record import Impossible, make

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


def records(folder, effects=tuple(EFFECTS), *, healthy=True):
    """Write the records of these effects, and the healthy ones unless told not to, into a folder.

    Returns
    -------
    places : list of Path
    """
    places = []
    for entry in json.loads(FILE.read_text(encoding="utf-8")):
        told = {key: tuple(v) if isinstance(v, list) else v for key, v in entry["case"].items()}
        case = Case(**told)
        if not set(case.effects) <= set(effects) or not (case.effects or healthy):
            continue
        place = Path(folder) / case.name
        write(place, make(case, entry["seed"], rows=ROWS, strengths=entry["strengths"], distances=False))
        places.append(place)
    return places


if __name__ == "__main__":
    text = json.dumps(drawn(), indent=1)
    FILE.write_text(text + "\n", encoding="utf-8")
