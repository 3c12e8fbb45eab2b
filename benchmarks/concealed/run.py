# SPDX-License-Identifier: BSD-3-Clause
"""Judge every record of a folder by some methods, side by side, going on where a run was stopped."""

import json
import multiprocessing
import os
import subprocess
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from benchmarks.concealed.draw import HISTORY, draw, only_of
from benchmarks.concealed.judging import line_of
from benchmarks.concealed.methods import WITH_HISTORY
from benchmarks.concealed.scoring.lines import read_lines

# workers are replaced after so many records each, so that their peak of memory is that of few; a pool that
# replaces them by itself comes to a stand in some versions of Python
_RECORDS_A_WORKER = 40
GIVEN = "valve_given.toml"


def draw_all(folder, seed, jobs, histories=False, **sizes):
    """Draw all records, with histories where asked for, by some processes at once."""
    only_of(folder, seed, sizes)
    if jobs == 1:
        draw(folder, seed, histories=histories, **sizes)
        return
    parts = [
        multiprocessing.get_context("spawn").Process(
            target=draw, args=(folder, seed, (i + 1, jobs)), kwargs=sizes | {"histories": histories}
        )
        for i in range(jobs)
    ]
    for part in parts:
        part.start()
    for part in parts:
        part.join()
    if any(part.exitcode for part in parts):
        raise RuntimeError("a process that draws records stopped; start again to go on")


def judge_all(folder, names, jobs, *, given=False, every=1, report=print):
    """Append a line of scores for every record and method that has none yet.

    Parameters
    ----------
    folder : Path
    names : sequence of str
        Methods.
    jobs : int
        Processes.
    given : bool, default=False
        Judge by the user's own simulation of the flow, the records that have one; method ``sklvalve`` only.
    every : int, default=1
        Of all records judge the first, and so many on, for a method that is slow.
    report : callable
        Told of the progress.

    Returns
    -------
    files : list of Path
    """
    commit, files, work = code(), [], []
    cache = folder / "learnt"
    for name in names:
        file = folder / (f"scores_{name}_given.jsonl" if given else f"scores_{name}.jsonl")
        done = {line["record"] for line in whole_lines(file)}
        files.append(file)
        places = sorted(p.parent for p in folder.glob("record_*/truth.json"))
        places = places[::every]
        if given:
            places = [p for p in places if (p / GIVEN).exists()]
        if name in WITH_HISTORY:
            places = [p for p in places if (p / HISTORY).exists()]
        work += [
            (p, name, file, GIVEN if given else "valve.toml", cache) for p in places if p.name not in done
        ]
    # methods take turns, so that a load from elsewhere weighs on all alike
    work.sort(key=lambda item: item[0].name)
    began = time.perf_counter()
    log(folder, f"{len(work)} diagnoses of {', '.join(names)}, code {commit}, {jobs} processes")
    for many, (file, line) in enumerate(_all_judged(work, jobs), start=1):
        with file.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(line | {"code": commit}, default=float) + "\n")
        if many % 20 == 0 or many == len(work):
            report(f"{many} of {len(work)} after {(time.perf_counter() - began) / 60.0:.0f} min", flush=True)
    log(folder, f"done after {(time.perf_counter() - began) / 60.0:.1f} min")
    return files


def _all_judged(work, jobs):
    """Files and lines of all work, as they are done."""
    step = jobs * _RECORDS_A_WORKER
    for first in range(0, len(work), step):
        with ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn")) as pool:
            # a worker that the system ends raises here, instead of being waited for
            for done in as_completed([pool.submit(_judged, item) for item in work[first : first + step]]):
                yield done.result()


def whole_lines(file):
    """Lines of a file of scores; one that was cut off by an interruption is taken away first."""
    return read_lines(file) if plain_lines(file) else []


def plain_lines(file):
    """Lines of any file that holds an object a line, mended as those of scores are."""
    if not file.exists():
        return []
    text = file.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        waiting = file.with_suffix(".waiting")
        waiting.write_text(whole, encoding="utf-8")
        waiting.replace(file)
    return [json.loads(line) for line in whole.splitlines()]


def _judged(item):
    place, name, file, valve, cache = item
    return file, line_of(place, name, valve=valve, cache=cache)


def log(folder, text):
    """Every run is logged beside the records: when, what, with which state of the code."""
    with (folder / "runs.log").open("a", encoding="utf-8") as stream:
        stream.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')} load {os.getloadavg()[0]:.1f}: {text}\n")


def code():
    """Commit that is judged, with a mark where the package was changed; nothing outside a repository."""
    here = Path(__file__).parents[2]

    def told(*words):
        return subprocess.run(words, cwd=here, capture_output=True, text=True, check=False).stdout.strip()

    try:
        commit = told("git", "rev-parse", "--short", "HEAD")
        return commit + ("+" if told("git", "status", "--porcelain", "--", "sklvalve") else "")
    except OSError:
        return ""
