# SPDX-License-Identifier: BSD-3-Clause
"""Check that the truths of a draw are those that were sealed.

    python -m benchmarks.concealed.check_seal FOLDER

FOLDER holds `seal.txt`, `salt.txt`, and the truths: `record_*/truth.json` of a draw, or its scores
(`scores_*.jsonl`, `partial_*.jsonl`, packed or not), whose lines hold them too. A truth is sealed by the
SHA-256 of the bytes of `salt.txt`, its line end included, with those of `truth.json` behind them. Printed is
the SHA-256 of `seal.txt`, which was published, and what does not match. Ends with 1 where anything does not,
or where a draw lacks a sealed truth; of scores of a part of the records that part is checked. Files named
`again_*` are left out: some of their records were drawn with other sizes later.
"""

import argparse
import hashlib
import sys
from pathlib import Path

from benchmarks.concealed.draw import broken_seals, hash_of, sealed_hashes, text_of, unsealed
from benchmarks.concealed.scoring.lines import read_lines


def main(arguments=None):
    """Check a folder; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.check_seal", description=__doc__.splitlines()[0]
    )
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args(arguments).folder
    missing = [name for name in ("seal.txt", "salt.txt") if not (folder / name).is_file()]
    if missing:
        parser.error(f"expected {' and '.join(missing)} in {folder}")
    sealed = sealed_hashes(folder)
    digest = hashlib.sha256((folder / "seal.txt").read_bytes()).hexdigest()
    print(f"seal.txt: {len(sealed)} truths, SHA-256 {digest}")
    outcomes = list(_checked(folder, sealed))
    if not outcomes:
        parser.error(f"expected record_*/truth.json or files of scores in {folder}")
    for what, checked, wrong in outcomes:
        told = f"; not as sealed: {', '.join(wrong)}" if wrong else ""
        print(f"{what}: {checked - len(wrong)} of {checked} truths are as sealed{told}")
    return int(any(wrong for _, _, wrong in outcomes))


def _checked(folder, sealed):
    """What was checked, how many truths of it, and the names of those that are not as sealed."""
    if any(folder.glob("record_*/truth.json")):
        strange = unsealed(folder)
        yield "record_*/truth.json", len(sealed) + len(strange), sorted([*broken_seals(folder), *strange])
    kinds = ("scores_*.jsonl", "partial_*.jsonl")
    for file in sorted(path for kind in kinds for path in (*folder.glob(kind), *folder.glob(f"{kind}.gz"))):
        yield file.name, *of_scores(file, (folder / "salt.txt").read_bytes(), sealed)


def of_scores(file, salt, sealed):
    """Number of truths in a file of scores, and the names of those that are not as sealed.

    Parameters
    ----------
    file : Path
    salt : bytes
        As `salt.txt` holds it.
    sealed : dict
        Record -> hash.
    """
    lines = read_lines(file)
    hashes = {line["record"]: hash_of(text_of(line["truth"]).encode(), salt) for line in lines}
    return len(hashes), sorted(name for name, own in hashes.items() if sealed.get(name) != own)


if __name__ == "__main__":
    sys.exit(main())
