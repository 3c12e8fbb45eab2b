# SPDX-License-Identifier: BSD-3-Clause
"""Inputs of one kind, read in a process of their own, which may hang or end; another goes on behind that."""

import json
import os
import random
import select
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from unicodedata import category

LONGEST = 10.0  # s
MOST_MEMORY = 1024.0  # MiB, of the whole process
WORKER = ("-m", "benchmarks.fuzz.running")
_MOST_ADDRESSES = 8 << 30  # bytes, beyond which an input asks for too much
# from the start of a process to its first input: imports, seeds, compiled functions
_START = 180.0


@dataclass
class Outcome:
    """What came of the inputs of a kind.

    `escaped` counts, by what came instead, inputs that ended otherwise than by the package's own error;
    `examples` holds the first input of each; `slowest` in s, `memory` in MiB.
    """

    kind: str
    inputs: int = 0
    refused: int = 0
    accepted: int = 0
    escaped: Counter = field(default_factory=Counter)
    examples: dict = field(default_factory=dict)
    slowest: float = 0.0
    memory: float = 0.0


def _peak():
    """Peak of memory of this program [MiB]; that of getrusage holds the process it came from as well."""
    with suppress(OSError, StopIteration):
        status = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
        return float(next(row for row in status if row.startswith("VmHWM")).split()[1]) / 1024.0
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def run(kind, count, seed):
    """Read `count` mutated inputs of a kind.

    Parameters
    ----------
    kind : str
    count, seed : int

    Returns
    -------
    outcome : Outcome
    """
    outcome, at = Outcome(kind), 0
    while at < count:
        at = _some(outcome, at, count, seed)
    return outcome


def _some(outcome, first, count, seed):
    """Read from one input on, to the end or to one that ends the process; the next to begin with."""
    words = [sys.executable, *WORKER, outcome.kind, str(first), str(count), str(seed)]
    root = str(Path(__file__).parents[2])
    path = os.pathsep.join([root, os.environ.get("PYTHONPATH", "")])
    # one thread, and no heap returned late: peaks are those of the input
    settings = os.environ | {"PYTHONPATH": path, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    work = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=settings)
    at, buffer, limit = first, b"", _START
    try:
        while True:
            ready, _, _ = select.select([work.stdout], [], [], limit)
            if not ready:
                work.kill()
                _escaped(outcome, at, seed, f"hangs for more than {limit:g} s")
                return at + 1
            part = os.read(work.stdout.fileno(), 1 << 16)
            if not part:
                break
            *lines, buffer = (buffer + part).split(b"\n")
            for line in lines:
                _count(outcome, json.loads(line), seed)
                at, limit = at + 1, LONGEST
    finally:
        said = work.stderr.read().decode(errors="replace") if work.poll() is not None or at == first else ""
        work.stdout.close()
        status = work.wait()
        work.stderr.close()
    if status != 0:
        if at == first and status > 0:
            raise RuntimeError(f"{outcome.kind}: no input could be read: {said[-2000:]}")
        _escaped(outcome, at, seed, f"ends the process ({status})")
        return at + 1
    return count


def _count(outcome, told, seed):
    outcome.slowest = max(outcome.slowest, told["took"])
    outcome.memory = max(outcome.memory, told["memory"])
    if told["end"] == "refused":
        outcome.refused += 1
    elif told["end"] == "accepted":
        outcome.accepted += 1
    else:
        _escaped(outcome, told["at"], seed, told["end"])
        return
    outcome.inputs += 1


def _escaped(outcome, at, seed, what):
    outcome.inputs += 1
    outcome.escaped[what] += 1
    if what not in outcome.examples:
        outcome.examples[what] = content_of(outcome.kind, at, seed)


def content_of(kind, at, seed):
    """The input of a number."""
    from benchmarks.fuzz.mutating import mutated
    from benchmarks.fuzz.seeds import corpus

    return mutated(kind, corpus(kind), random.Random(f"{seed} {kind} {at}"))


def _safe(sentence):
    """Whether a terminal shows a sentence as it is: letters, signs and blanks of any width, up to 1,000."""
    return len(sentence) <= 1000 and all(each.isprintable() or category(each) == "Zs" for each in sentence)


def _work(kind, first, count, seed):
    import resource

    from benchmarks.fuzz.mutating import mutated
    from benchmarks.fuzz.seeds import corpus
    from benchmarks.fuzz.targets import NAMES, reader
    from sklvalve.recording import InputError

    resource.setrlimit(resource.RLIMIT_AS, (_MOST_ADDRESSES, _MOST_ADDRESSES))
    seeds, read = corpus(kind), reader(kind)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / NAMES[kind]
        for at in range(first, count):
            rng = random.Random(f"{seed} {kind} {at}")
            path.write_bytes(mutated(kind, seeds, rng))
            begun = time.perf_counter()
            try:
                read(path, rng)
                end = "accepted"
            except InputError as error:
                end = "refused" if _safe(str(error)) else "unsafe sentence"
            except BaseException as error:
                end = f"{type(error).__name__}: {str(error)[:80]}"
            took = time.perf_counter() - begun
            memory = _peak()
            print(json.dumps({"at": at, "end": end, "took": took, "memory": memory}), flush=True)


if __name__ == "__main__":
    _work(sys.argv[1], *map(int, sys.argv[2:]))
