# SPDX-License-Identifier: BSD-3-Clause
"""One record from its drawing to the judgement: a line of plain data."""

import time

from benchmarks.concealed.next_test import outcome as of
from benchmarks.concealed.next_test.stand import Stand, drawn
from benchmarks.concealed.record import Impossible
from sklvalve.mismatch import MissingPhysicsFinder


def line_of(seed, number, kinds=()):
    """Line of the record of this number.

    Parameters
    ----------
    seed, number : int
    kinds : sequence of str, default=()
        Effects that are drawn from; all of water unless given.

    Returns
    -------
    line : dict
        ``outcome`` is None where the diagnosis left nothing open that holds the truth, or the effect could
        not be as large as drawn.
    """
    began, what = time.process_time(), drawn(seed, number, kinds)
    line = {"number": number, **vars(what), "outcome": None}
    try:
        line |= _judged(Stand(what))
    except Impossible as error:
        line["why"] = str(error)
    except Exception as error:
        # a diagnosis that breaks is told, and no reason to leave the others undone
        line["failed"] = f"{type(error).__name__}: {error}"
    return line | {"cpu_seconds": round(time.process_time() - began, 1)}


def _judged(stand):
    finder, told = MissingPhysicsFinder(n_jobs=1).fit(stand.recording), stand.told
    classes = [list(c) for c in finder.diagnosis_.effects]
    line = {"told": told, "strength": stand.strengths[stand.what.effect], "classes": classes}
    line |= {"verdict": finder.diagnosis_.verdict, "before": of.open_class(classes, told)}
    if not line["before"]:
        return line
    line["sentence"] = finder.diagnosis_.content["next_test"]
    others = [n for n in line["before"] if n != told]
    plan = finder.next_test_
    if plan is None or plan.sensor or not plan.pairs:
        best = stand.apart_at_best(others)
        kind = of.SENSOR if plan is not None and plan.sensor else of.NO_PROGRAM
        return line | {"outcome": kind, "at_best": best, "true": of.says_truly(best)}
    pairs = [
        {
            "names": list(p.names),
            "now": round(p.now, 1),
            "expected": round(p.expected, 1),
            "told_apart": bool(p.separates),
        }
        for p in plan.pairs
    ]
    line |= {"program": plan.name, "pairs": pairs, "promised": of.promised(pairs, told)}
    both, scene = stand.tested(plan)
    if not line["promised"]:
        best = stand.apart_at_best(others)
        return line | {"outcome": of.NO_PROMISE, "at_best": best, "true": of.says_truly(best)}
    line["reached"] = stand.apart(scene, others)
    again = MissingPhysicsFinder(n_jobs=1).fit(both).diagnosis_
    line |= {"verdict_after": again.verdict, "after": [list(c) for c in again.effects]}
    line["outcome"], line["left"] = of.outcome(
        told, line["promised"], line["reached"], again.verdict, line["after"]
    )
    return line
