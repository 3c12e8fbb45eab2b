# SPDX-License-Identifier: BSD-3-Clause
"""Judge records of a published run again by the present code, and hold both judgements beside each other.

    python -m benchmarks.concealed.again FOLDER --seed 69400423

Only records with one effect that the generator calls distinguishable are drawn, unless other kinds are asked
for: a run of 650 takes hours, and the figure in question is of these. Each record is drawn by the plan of its
run, with the sizes that its published truth tells; the table says how many came out as published. Stopped and
started again, it goes on where it was. `--histories` gives each record an hour of its plant from before it,
and judges with it; `report.with_history` holds that against a judgement without, of the same folder.
"""

import argparse
import json
import shutil
import sys
from collections import Counter
from pathlib import Path

import numpy as np

from benchmarks.concealed.cases import plan
from benchmarks.concealed.draw import ATTEMPTS, HISTORY, made_of, seed_of, write
from benchmarks.concealed.histories.hour import with_history
from benchmarks.concealed.judging import line_of
from benchmarks.concealed.methods import WITH_HISTORY
from benchmarks.concealed.record import make
from benchmarks.concealed.report.history import RESULTS, SCORES
from benchmarks.concealed.report.markdown import table
from benchmarks.concealed.run import code
from benchmarks.concealed.scoring.agreement import mcnemar, paired
from benchmarks.concealed.scoring.lines import KINDS, distinguishable, kind_of, read_lines
from benchmarks.concealed.scoring.outcome import judge
from benchmarks.concealed.scoring.rates import rate_of


def main(arguments=None):
    """Draw, judge, compare; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.again", description=__doc__.splitlines()[0]
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", required=True, help="of a run in benchmarks/concealed/results")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=["single"])
    parser.add_argument("--all", action="store_true", help="also what nobody could distinguish")
    parser.add_argument("--part", type=int, nargs=2, default=(1, 1), metavar=("I", "OF"))
    parser.add_argument("--table", action="store_true", help="only print the tables of what is judged")
    parser.add_argument(
        "--histories", action="store_true", help="give each record a history, and judge by it"
    )
    options = parser.parse_args(arguments)
    run = RESULTS / f"seed_{options.seed}"
    before = [
        line
        for line in read_lines(run / SCORES)
        if kind_of(line) in options.kinds and (options.all or distinguishable(line))
    ]
    name = "sklvalve_history" if options.histories else "sklvalve"
    scores = options.folder / f"scores_{name}.jsonl"
    if not options.table:
        again(options.folder, run, before[options.part[0] - 1 :: options.part[1]], scores, name)
    print(compared(before, read_lines(scores)))
    return 0


def again(folder, run, lines, scores, method="sklvalve"):
    """Draw and judge the records of these lines by a method, those without a judgement of today."""
    told = json.loads((run / "plan.json").read_text(encoding="utf-8"))
    cases = {case.name: case for case in plan(told["seed"], **told["sizes"])}
    folder.mkdir(parents=True, exist_ok=True)
    done = {line["record"] for line in read_lines(scores)} if scores.exists() else set()
    for line in lines:
        name = line["record"]
        if name in done:
            continue
        place = folder / name
        histories = method in WITH_HISTORY
        if not (place / HISTORY if histories else place).exists():
            shutil.rmtree(place, ignore_errors=True)
            write(place, drawn_again(cases[name], told["seed"], line["truth"], histories))
        judged = line_of(place, method) | {"code": code()}
        with scores.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(judged, default=float) + "\n")
        print(f"{name}: {judge(line)} -> {judge(judged)}", flush=True)


def drawn_again(case, seed, published, histories=False):
    """The record of a published truth, with a history if asked for.

    Sizes and distances take most of a draw, so sizes are those published and distances are left out. A plant
    that remembers how its size was found has other noise then, and is drawn in full.
    """
    for attempt in range(ATTEMPTS):
        made = make(case, seed_of(case, seed, attempt), strengths=published["strengths"], distances=False)
        if same_record(published, made.truth):
            made.truth = published
            break
    else:
        made = made_of(case, seed)
    return with_history(case, made) if histories and made is not None else made


_NOT_DRAWN = {"distances", "distinguishable", "class", "detectable", "history"}


def same_record(published, today):
    """Whether two truths tell of one record: every number to a millionth, what was not sought anew apart."""
    if isinstance(published, dict) and isinstance(today, dict):
        keys = (published.keys() | today.keys()) - _NOT_DRAWN
        return all(same_record(published.get(key), today.get(key)) for key in keys)
    if isinstance(published, list) and isinstance(today, list):
        return len(published) == len(today) and all(map(same_record, published, today))
    if isinstance(published, float) and isinstance(today, float | int):
        return bool(np.isclose(published, today, rtol=1e-6, atol=0.0, equal_nan=True))
    return published == today


def compared(before, today):
    """Outcomes of both judgements on the same records, and how likely chance alone makes their difference."""
    pairs = paired(before, today)
    first, second = [judge(a) for a, _ in pairs], [judge(b) for _, b in pairs]
    lost, won, by_chance = mcnemar([(a == "right", b == "right") for a, b in zip(first, second, strict=True)])
    moved = Counter(zip(first, second, strict=True))
    same = sum(same_record(a["truth"], b["truth"]) for a, b in pairs)
    rates = [str(rate_of(word == "right" for word in words)) for words in (first, second)]
    return "\n\n".join(
        (
            f"{len(pairs)} records, {same} of them with the published truth.",
            table(
                ["outcome", "then", "today"],
                [[word, first.count(word), second.count(word)] for word in sorted({*first, *second})],
            ),
            f"Right: {rates[0]} then, {rates[1]} today; {won} won, {lost} lost. Chance alone makes it as "
            f"uneven with a probability of {by_chance:.2f}.",
            table(
                ["then", "today", "records"],
                [[a, b, many] for (a, b), many in sorted(moved.items()) if a != b],
            ),
        )
    )


if __name__ == "__main__":
    sys.exit(main())
