# SPDX-License-Identifier: BSD-3-Clause
"""Draw the records of a benchmark into a folder, and seal their truths.

A record's folder appears whole or not at all, so that a draw that was stopped goes on where it was. The seal
holds the SHA-256 of every truth with a salt that is kept beside it: published before a run, it shows
afterwards that nobody has changed a truth.
"""

import gzip
import hashlib
import json
import os
import shutil
import zlib
from pathlib import Path

import numpy as np

from benchmarks.concealed.cases import plan
from benchmarks.concealed.record import Impossible, make
from sklvalve.datasets.concealed import to_toml

ATTEMPTS = 8


def draw(folder, seed, part=(1, 1), report=print, **sizes):
    """Draw what is not there yet of a benchmark's records.

    Parameters
    ----------
    folder : Path
    seed : int
    part : tuple of int
        Which part of the work, of how many.
    report : callable
        Told of every record.
    **sizes
        How many records of each kind (`cases.plan`).
    """
    cases = plan(seed, **sizes)
    folder.mkdir(parents=True, exist_ok=True)
    for case in cases[part[0] - 1 :: part[1]]:
        place = folder / case.name
        skipped = folder / f"{case.name}.impossible"
        if place.exists() or skipped.exists():
            continue
        made = _made(case, seed)
        if made is None:
            skipped.write_text(
                json.dumps({"effects": case.effects, "step": case.step}) + "\n", encoding="utf-8"
            )
            report(f"{case.name}: {' + '.join(case.effects)} is not possible in {ATTEMPTS} plants")
            continue
        write(place, made)
        report(f"{case.name} written")


def _made(case, seed):
    for attempt in range(ATTEMPTS):
        own = zlib.crc32(f"{seed} {case.number} {attempt}".encode())
        try:
            return make(case, own)
        except Impossible:
            continue
    return None


def write(place, made):
    rows = made.truth["rows"]
    waiting = place.with_name(f".{place.name}.{os.getpid()}")
    shutil.rmtree(waiting, ignore_errors=True)
    waiting.mkdir(parents=True)
    _write_csv(waiting / "recording.csv.gz", {k: v[:rows] for k, v in made.table.items()})
    _write_csv(waiting / "later.csv.gz", {k: v[rows:] for k, v in made.table.items()})
    _write_csv(waiting / "behind.csv.gz", made.behind)
    (waiting / "valve.toml").write_text(to_toml(made.valve), encoding="utf-8")
    if made.given is not None:
        (waiting / "valve_given.toml").write_text(to_toml(made.given), encoding="utf-8")
    (waiting / "truth.json").write_text(json.dumps(made.truth, indent=1) + "\n", encoding="utf-8")
    waiting.rename(place)


def _write_csv(path, table):
    cells = [[_cell(v) for v in column] for column in table.values()]
    lines = [",".join(table), *(",".join(row) for row in zip(*cells, strict=True))]
    with path.open("wb") as file, gzip.GzipFile(fileobj=file, mode="wb", mtime=1) as packed:
        packed.write(("\n".join(lines) + "\n").encode())


def _cell(value):
    if isinstance(value, np.integer | int):
        return str(int(value))
    return "" if np.isnan(value) else f"{value:.10g}"


def seal(folder):
    """Write `seal.txt`, a salted hash of every truth; the salt stays in `salt.txt`, for whoever checks it."""
    salt_file = folder / "salt.txt"
    if not salt_file.exists():
        salt_file.write_text(os.urandom(16).hex() + "\n", encoding="utf-8")
    salt = salt_file.read_bytes()
    truths = sorted(folder.glob("record_*/truth.json"))
    lines = [f"{hashlib.sha256(salt + t.read_bytes()).hexdigest()}  {t.parent.name}" for t in truths]
    text = "\n".join(lines) + "\n"
    (folder / "seal.txt").write_text(text, encoding="utf-8")
    return hashlib.sha256(text.encode()).hexdigest()


def broken_seals(folder):
    """Names of records whose truth is not the one that was sealed."""
    folder = Path(folder)
    salt = (folder / "salt.txt").read_bytes()
    wrong = []
    for line in (folder / "seal.txt").read_text(encoding="utf-8").splitlines():
        digest, name = line.split()
        truth = folder / name / "truth.json"
        if not truth.exists() or hashlib.sha256(salt + truth.read_bytes()).hexdigest() != digest:
            wrong.append(name)
    return wrong
