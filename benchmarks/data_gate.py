# SPDX-License-Identifier: BSD-3-Clause
"""Defects planted in healthy recordings of the independent plant, and what the screening says of them.

    python benchmarks/data_gate.py [--seed 0] [--records 12] [--clean 100] [--only WORD] [--whole 0]

Prints one line a defect and size: in how many of the records it was found by its own name and channel, in how
many something else was blamed beside it, and seconds of one core a record. Then how many clean records,
and records with real physics concealed, were blamed of anything. ``--whole N`` diagnoses N planted records
with the whole finder, and shows what was named.
"""

import argparse
import time
from collections import Counter
from dataclasses import dataclass

import numpy as np
from data_defects import defects

from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import CONCEALABLE, make_valve_recording
from sklvalve.recording import InputError, noise_floor, screen_recording

ROLES = {"CV": "command", "X": "opening", "P1": "p1", "P2": "p2", "T1": "temperature", "F": "flow"}
LOOPS = ("wide", "closed", "mixed")
NOISES = (1.0, 1.0, 2.0, 3.0)


@dataclass
class Tally:
    """What became of the records with one defect."""

    records: int = 0
    found: int = 0
    else_blamed: int = 0
    seconds: float = 0.0
    missed: tuple = ()
    wrong: tuple = ()


def healthy(seed, **more):
    """One recording of the plant, loops and noise levels in turn."""
    settings = {"loop": LOOPS[seed % 3], "noise": NOISES[(seed // 3) % 4], "n_later": 0} | more
    return make_valve_recording(random_state=seed, **settings)


def screened(made, columns):
    """Findings (name, role) of a table, and the seconds that they took; an error of the border counts too."""
    try:
        recording = Recording.from_frame(columns, Valve.from_dict(made.valve))
    except InputError:
        return {("refused", None)}, 0.0
    began = time.process_time()
    found = screen_recording(recording)
    return {(each["finding"], each["role"]) for each in found}, time.process_time() - began


def kind(label):
    """What sort of defect a label names."""
    first = label.split()[0]
    return {"swinging": "compression", "box-car": "compression"}.get(first, first)


def group(defect, columns):
    """Row of the pooled table that a defect in such columns counts in."""
    sort, words = kind(defect.label), defect.label.split()
    if sort == "compression":
        size = float(words[-2])
        within = "" if defect.band >= noise_floor(columns[defect.columns[0]]) else ", within the noise"
        return (
            f"compression {'1 % or more' if size >= 1.0 else '0.5 %' if size == 0.5 else '< 0.5 %'}{within}"
        )
    if sort == "quantised":
        return f"quantised {'0.5 % or more' if float(words[-2]) >= 0.5 else '< 0.5 %'}"
    if sort == "clock":
        name, seconds = words[1], int(words[2])
        if abs(seconds) < 5:
            return "clock 2 s"
        if name == "CV":
            return "clock of the command " + ("late" if seconds > 0 else f"early, {columns['loop']} loop")
        return "clock of a pressure" if name in ("P1", "P2") else "clock of opening or flow"
    if sort == "frozen" and words[1] == "CV":
        return f"frozen command, {columns['loop']} loop, {words[2]} s"
    return "scaled P2 alone" if sort == "scaled" and words[1] == "P2" else sort


def planted(seed, records, only):
    """Tallies over healthy records, of each defect and of groups of them."""
    tallies, pooled = {}, {}
    for number in range(records):
        made = healthy(seed + number)
        columns = {name: made.frame[name].to_numpy(dtype=float, copy=True) for name in ("time", *ROLES)}
        for defect in defects(made):
            if only and only not in defect.label:
                continue
            spoilt = defect.plant({k: v.copy() for k, v in columns.items()}, np.random.default_rng(number))
            found, seconds = screened(made, spoilt)
            roles = {ROLES[name] for name in defect.columns} | {None}
            hit = {each for each in found if each[0] in defect.findings and each[1] in roles}
            hit |= found & {("refused", None)}
            rest = {each for each in found - hit if each[0] not in defect.excused}
            row = group(defect, columns | {"loop": made.truth["loop"]})
            for tally in (tallies.setdefault(defect.label, Tally()), pooled.setdefault(row, Tally())):
                tally.records += 1
                tally.found += bool(hit)
                tally.else_blamed += bool(rest)
                tally.seconds += seconds
                if not hit:
                    tally.missed += (f"{made.truth['loop']}{made.truth['noise']:.0f}#{seed + number}",)
                tally.wrong += tuple(sorted(map(str, rest)))
    return tallies, dict(sorted(pooled.items()))


def blamed(seed, records, effects):
    """Findings in records without any defect, by what is concealed in them."""
    tallies = {}
    for number in range(records):
        effect = effects[number % len(effects)]
        more = {} if effect is None else {"onset": None}
        made = healthy(seed + number, effect=effect, **more)
        found, seconds = screened(made, made.frame)
        tally = tallies.setdefault(effect or "nothing", Tally())
        tally.records += 1
        tally.else_blamed += bool(found)
        tally.seconds += seconds
        tally.wrong += tuple(sorted(f"{each}#{seed + number}" for each in found))
    return tallies


def told(made, columns):
    """Verdict, names of physics and findings of the whole finder; a refusal is a verdict of its own here."""
    try:
        recording = Recording.from_frame(columns, Valve.from_dict(made.valve))
        content = MissingPhysicsFinder().fit(recording).diagnosis_.to_dict()
    except InputError:
        return "refused", [], []
    names = ["/".join(member["name"] for member in effect["members"]) for effect in content["effects"]]
    return (
        content["verdict"],
        names,
        sorted({f"{each['finding']} {each['role']}" for each in content["data"]}),
    )


def whole(seed, records, only):
    """What the finder says of planted records, in turn a defect of each kind.

    Only where physics is claimed, named or of no catalogue, is the healthy record itself diagnosed.
    """
    kinds = {}
    for place, defect in enumerate(defects(healthy(seed, n_samples=2880))):
        if not only or only in defect.label:
            kinds.setdefault(kind(defect.label), []).append(place)
    orders = {name: np.random.default_rng(seed).permutation(places) for name, places in kinds.items()}
    verdicts = {name: Counter() for name in kinds}
    print("\n| planted | loop | verdict | physics named | data |" + "\n" + 5 * "|---" + "|")
    for number in range(records):
        name = list(kinds)[number % len(kinds)]
        made = healthy(seed + number, n_samples=2880, noise=1.0)
        defect = defects(made)[orders[name][(number // len(kinds)) % len(orders[name])]]
        columns = {name: made.frame[name].to_numpy(dtype=float, copy=True) for name in ("time", *ROLES)}
        spoilt = defect.plant({k: v.copy() for k, v in columns.items()}, np.random.default_rng(number))
        verdict, names, data = told(made, spoilt)
        if verdict in ("named", "none_of_these"):
            before = told(made, columns)
            verdict = f"{verdict}{', as before planting' if before[:2] == (verdict, names) else ''}"
        verdicts[name][verdict] += 1
        answer = f"{verdict} | {', '.join(names) or '-'} | {', '.join(data) or '-'}"
        print(f"| {defect.label} | {made.truth['loop']}#{seed + number} | {answer} |", flush=True)
    print("\n| kind | records | verdicts |" + "\n|---|---|---|")
    for name, counts in verdicts.items():
        said = ", ".join(f"{verdict} {count}" for verdict, count in counts.most_common())
        print(f"| {name} | {counts.total()} | {said} |")


def show(title, tallies):
    """One table."""
    print(f"\n| {title} | records | found | else blamed | ms | missed in | else |\n" + 7 * "|---" + "|")
    for label, tally in tallies.items():
        wrong = ", ".join(f"{what} x{count}" for what, count in Counter(tally.wrong).most_common(3))
        speed = 1e3 * tally.seconds / tally.records
        print(
            f"| {label} | {tally.records} | {tally.found} | {tally.else_blamed} | {speed:.0f} | "
            f"{' '.join(tally.missed[:6])} | {wrong} |"
        )


def main():
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--records", type=int, default=12)
    parser.add_argument("--clean", type=int, default=100)
    parser.add_argument("--physics", type=int, default=2 * len(CONCEALABLE))
    parser.add_argument("--whole", type=int, default=0)
    parser.add_argument("--only", default="")
    given = parser.parse_args()
    if given.records:
        tallies, pooled = planted(given.seed, given.records, given.only)
        show("planted", tallies)
        show("planted, pooled", pooled)
    if given.clean:
        show("nothing planted", blamed(given.seed + 10_000, given.clean, [None]))
    if given.physics:
        show("physics concealed", blamed(given.seed + 20_000, given.physics, CONCEALABLE))
    if given.whole:
        whole(given.seed + 30_000, given.whole, given.only)


if __name__ == "__main__":
    main()
