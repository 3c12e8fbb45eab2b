# SPDX-License-Identifier: BSD-3-Clause
"""Draw recordings with concealed effects into a folder, for a blind trial.

    python benchmarks/trial/make.py FOLDER --seed 7 --healthy 12 --each 2 --pairs 6
    python benchmarks/trial/make.py FOLDER --seed 8 --healthy 60 --each 5 --times 2

writes one folder per record, named record_000, record_001, ... in an order drawn by the seed, so that a
name tells nothing. In each:

    recording.csv.gz           what to diagnose: time [s], CV, X [%], P1, P2 [kPa], T1 [degC], F [m3/h];
                               SP [m3/h] where a loop is closed
    valve.toml                 what the engineer knows
    later.csv.gz               what comes after, to predict
    truth.json                 what is concealed; not for the eyes of the diagnosis
    flow_without_noise.csv.gz  the flow behind the noise, over recording and later, for the judge

A third of the healthy records command the whole travel, a third run in a closed loop, a third do so with
2.5 times the noise. Effects are drawn one per record, of a size that matters where it acts, from the start
or from a moment on. With --times 2 a size lies between two and four times the smallest one that the record
could show (how: benchmarks/concealed/results/README.md); where that is not possible the record is drawn
anew, and `drawn.json` counts how often. With --pairs, two effects of different blocks share a record.
`seal.txt` holds the SHA-256 of every truth.json: commit it before a trial, so that nobody can change the
truth afterwards. The same arguments give the same files.
"""

import argparse
import hashlib
import json
from collections import Counter
from pathlib import Path

import numpy as np

from sklvalve.datasets import CONCEALABLE, write_concealed
from sklvalve.datasets.concealed import UnreachableSize

# Pairs whose members live in different blocks or regions, so that both can be told from one record.
PAIRS = (
    ("choked_flow", "backlash"),
    ("stiction", "seat_leakage"),
    ("positioner_deadband", "flow_meter_bias"),
    ("dead_time", "clogging"),
    ("supply_pressure_drop", "seat_leakage"),
    ("linkage_backlash", "choked_flow"),
)


def plan(rng, healthy, each, pairs, effects):
    """List of (effects, settings), in a drawn order."""
    cases: list[tuple[list[str], dict]] = []
    for i in range(healthy):
        loop = (None, "wide", "closed")[(i + 1) % 3]
        cases.append(([], {"loop": loop, "noise": 2.5 if loop is None else 1.0}))
    cases += [([name], {"onset": None}) for name in effects for _ in range(each)]
    cases += [(list(PAIRS[i % len(PAIRS)]), {"loop": "wide"}) for i in range(pairs)]
    return [cases[i] for i in rng.permutation(len(cases))]


# with --times: what is wrong with a sheet does not begin while the valve runs
FROM_THE_START = {"wrong_characteristic"}
# so often a record is drawn anew before its effect is left out
ATTEMPTS = 25


def draw(folder, effects, settings, rng):
    """Write one record; returns how often it was drawn anew, or None where no draw was possible."""
    for again in range(ATTEMPTS):
        try:
            write_concealed(folder, effects, **settings, random_state=int(rng.integers(2**31)))
        except UnreachableSize:
            continue
        return again
    return None


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Draw recordings with concealed effects into a folder.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--healthy", type=int, default=12, help="records with nothing in them")
    parser.add_argument("--each", type=int, default=2, help="records per effect")
    parser.add_argument("--pairs", type=int, default=0, help="records with two effects")
    parser.add_argument(
        "--effects", nargs="+", choices=CONCEALABLE, default=list(CONCEALABLE), metavar="NAME"
    )
    parser.add_argument(
        "--times", type=float, help="sizes of this to twice this many times what is detectable"
    )
    options = parser.parse_args(arguments)

    rng = np.random.default_rng(options.seed)
    cases = plan(rng, options.healthy, options.each, options.pairs, options.effects)
    seal, anew, left_out = [], Counter(), Counter()
    for i, (effects, settings) in enumerate(cases):
        folder, who = options.folder / f"record_{i:03d}", " + ".join(effects)
        if options.times is not None and effects:
            settings = settings | {"times": (options.times, 2.0 * options.times)}
            if FROM_THE_START & set(effects):
                settings["onset"] = 0.0
        again = draw(folder, effects, settings, rng)
        if again is None:
            left_out[who] += 1
            continue
        anew[who] += again
        seal.append(f"{hashlib.sha256((folder / 'truth.json').read_bytes()).hexdigest()}  {folder.name}")
        print(f"{folder.name} written ({i + 1} of {len(cases)})", flush=True)
    (options.folder / "seal.txt").write_text("\n".join(seal) + "\n", encoding="utf-8")
    drawn = {"arguments": {k: v for k, v in vars(options).items() if k != "folder"}}
    drawn |= {"drawn anew": +anew, "left out": left_out}
    (options.folder / "drawn.json").write_text(json.dumps(drawn, indent=1) + "\n", encoding="utf-8")
    print(f"drawn anew, so many times the detectable size not being possible: {dict(+anew)}")
    print(f"left out after {ATTEMPTS} draws: {dict(left_out)}")


if __name__ == "__main__":
    main()
