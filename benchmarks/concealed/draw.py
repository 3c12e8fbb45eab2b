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
from benchmarks.concealed.histories import with_history
from benchmarks.concealed.record import Impossible, make
from sklvalve.datasets.concealed import to_toml

ATTEMPTS = 8
PLAN = "plan.json"
HISTORY = "history.csv.gz"


def draw(folder, seed, part=(1, 1), report=print, histories=False, **sizes):
    """Draw what is not there yet of a benchmark's records.

    Parameters
    ----------
    folder : Path
    seed : int
    part : tuple of int
        Which part of the work, of how many.
    report : callable
        Told of every record.
    histories : bool, default=False
        Whether to draw a history for every record; the record stays the same.
    **sizes
        How many records of each kind (`cases.plan`).
    """
    cases = plan(seed, **sizes)
    only_of(folder, seed, sizes)
    for case in cases[part[0] - 1 :: part[1]]:
        place = folder / case.name
        skipped = folder / f"{case.name}.impossible"
        if place.exists() or skipped.exists():
            continue
        made = made_of(case, seed)
        if made is None:
            skipped.write_text(
                json.dumps({"effects": case.effects, "step": case.step}) + "\n", encoding="utf-8"
            )
            report(f"{case.name}: {' + '.join(case.effects)} is not possible in {ATTEMPTS} plants")
            continue
        write(place, with_history(case, made) if histories else made)
        report(f"{case.name} written")


def only_of(folder, seed, sizes):
    """Make the folder one of this plan alone: records of two plans would pass for one draw."""
    folder.mkdir(parents=True, exist_ok=True)
    told, file = {"seed": seed, "sizes": sizes}, folder / PLAN
    if not file.exists():
        waiting = file.with_name(f".{PLAN}.{os.getpid()}")
        waiting.write_text(json.dumps(told) + "\n", encoding="utf-8")
        waiting.replace(file)
    before = json.loads(file.read_text(encoding="utf-8"))
    if before != told:
        raise ValueError(
            f"{folder} holds records of seed {before['seed']} and sizes {before['sizes']}; got seed {seed} "
            f"and sizes {sizes}: give another folder"
        )


def made_of(case, seed):
    for attempt in range(ATTEMPTS):
        try:
            return make(case, seed_of(case, seed, attempt))
        except Impossible:
            continue
    return None


def seed_of(case, seed, attempt):
    """Seed of one attempt at a case."""
    return zlib.crc32(f"{seed} {case.number} {attempt}".encode())


def write(place, made):
    rows = made.truth["rows"]
    waiting = place.with_name(f".{place.name}.{os.getpid()}")
    shutil.rmtree(waiting, ignore_errors=True)
    waiting.mkdir(parents=True)
    write_csv(waiting / "recording.csv.gz", {k: v[:rows] for k, v in made.table.items()})
    write_csv(waiting / "later.csv.gz", {k: v[rows:] for k, v in made.table.items()})
    write_csv(waiting / "behind.csv.gz", made.behind)
    if made.history is not None:
        write_csv(waiting / HISTORY, made.history)
    (waiting / "valve.toml").write_text(to_toml(made.valve), encoding="utf-8")
    if made.given is not None:
        (waiting / "valve_given.toml").write_text(to_toml(made.given), encoding="utf-8")
    (waiting / "truth.json").write_text(text_of(made.truth), encoding="utf-8")
    try:
        waiting.rename(place)
    except OSError:
        # a draw that was stopped may have left a process that wrote the same record meanwhile
        if not place.is_dir():
            raise
        shutil.rmtree(waiting)


def text_of(truth):
    """A truth as its file holds it."""
    return json.dumps(truth, indent=1) + "\n"


def write_csv(path, table):
    """Write columns as a packed file of the same bytes each time."""
    cells = [[_cell(v) for v in column] for column in table.values()]
    lines = [",".join(table), *(",".join(row) for row in zip(*cells, strict=True))]
    with path.open("wb") as file, gzip.GzipFile(fileobj=file, mode="wb", mtime=1) as packed:
        packed.write(("\n".join(lines) + "\n").encode())


def _cell(value):
    if isinstance(value, np.integer | int):
        return str(int(value))
    return "" if np.isnan(value) else f"{value:.10g}"


def seal(folder, anew=()):
    """Add to `seal.txt` a salted hash of every truth that it has none of; what was sealed stays.

    The salt stays in `salt.txt`, for whoever checks it. `anew` names records that are sealed once more.

    Returns
    -------
    digest : str
        SHA-256 of the seal.
    """
    salt_file = folder / "salt.txt"
    sealed = sealed_hashes(folder)
    if not salt_file.exists():
        if sealed:
            raise FileNotFoundError(f"{folder} holds seal.txt, and not the salt.txt of it; put it back")
        salt_file.write_text(os.urandom(16).hex() + "\n", encoding="utf-8")
    salt = salt_file.read_bytes()
    for truth in folder.glob("record_*/truth.json"):
        if truth.parent.name not in sealed or truth.parent.name in anew:
            sealed[truth.parent.name] = hash_of(truth.read_bytes(), salt)
    text = "".join(f"{sealed[name]}  {name}\n" for name in sorted(sealed))
    waiting = folder / f".seal.{os.getpid()}"
    waiting.write_text(text, encoding="utf-8")
    waiting.replace(folder / "seal.txt")
    return hashlib.sha256(text.encode()).hexdigest()


def hash_of(truth, salt):
    """Hash that seals a truth: SHA-256 of the bytes of `salt.txt`, and behind them those of `truth.json`."""
    return hashlib.sha256(salt + truth).hexdigest()


def sealed_hashes(folder):
    """Record -> hash of its truth, as `seal.txt` of a folder has them; empty where there is none."""
    file = Path(folder) / "seal.txt"
    if not file.exists():
        return {}
    return {name: digest for digest, name in (line.split() for line in file.read_text("utf-8").splitlines())}


def broken_seals(folder):
    """Names of sealed records whose truth is gone or not the one that was sealed."""
    folder = Path(folder)
    sealed = sealed_hashes(folder)
    if not sealed:
        return []
    salt = (folder / "salt.txt").read_bytes()
    wrong = []
    for name, digest in sealed.items():
        truth = folder / name / "truth.json"
        if not truth.exists() or hash_of(truth.read_bytes(), salt) != digest:
            wrong.append(name)
    return wrong


def unsealed(folder):
    """Names of records that the seal knows nothing of."""
    names = {truth.parent.name for truth in Path(folder).glob("record_*/truth.json")}
    return sorted(names - set(sealed_hashes(folder)))
