# SPDX-License-Identifier: BSD-3-Clause
"""Histories for the records of a folder that was drawn before, at the sizes that its truths tell."""

import json
import shutil

from benchmarks.concealed.again import drawn_again, same_record
from benchmarks.concealed.cases import plan
from benchmarks.concealed.draw import HISTORY, PLAN, broken_seals, seal, text_of, write_csv

BEFORE = "seal_without_histories.txt"


def add_histories(folder, report=print):
    """Write a history beside every record that has none, and tell of it in its truth.

    Where truths were sealed, the seal of before is kept as `seal_without_histories.txt`: a truth less its key
    ``history`` is the one that it was made of.

    Parameters
    ----------
    folder : Path
        With the plan of its draw.
    report : callable
        Told of every record.

    Returns
    -------
    names : list of str
        Records that got one.

    Raises
    ------
    ValueError
        If a truth is not the one that was sealed, or the folder holds no plan.
    """
    if not (folder / PLAN).exists():
        raise ValueError(f"{folder} holds no {PLAN}, by which its records were drawn; draw them by a --seed")
    if broken := broken_seals(folder):
        raise ValueError(f"the truth of {', '.join(broken)} is not the one that was sealed")
    told = json.loads((folder / PLAN).read_text(encoding="utf-8"))
    truths = {}
    for case in plan(told["seed"], **told["sizes"]):
        truth = _truth_without(folder / case.name)
        made = None if truth is None else drawn_again(case, told["seed"], truth, histories=True)
        if made is None:
            continue
        if not same_record(truth, made.truth):
            report(f"{case.name}: today's plant makes another record of it, so it gets no history")
            continue
        write_csv(folder / case.name / HISTORY, made.history)
        truths[case.name] = made.truth
        report(f"{case.name}: history written")
    _tell(folder, truths)
    return list(truths)


def _truth_without(place):
    """Truth of a record that tells of no history; None where there is none of the kind."""
    file = place / "truth.json"
    truth = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {"history": None}
    return None if "history" in truth else truth


def _tell(folder, truths):
    """Write truths at once and seal them, so that the two do not part where the drawing is stopped."""
    sealed = folder / "seal.txt"
    if truths and sealed.exists() and not (folder / BEFORE).exists():
        shutil.copy(sealed, folder / BEFORE)
    for name, truth in truths.items():
        (folder / name / "truth.json").write_text(text_of(truth), encoding="utf-8")
    if truths and sealed.exists():
        seal(folder, anew=truths)
