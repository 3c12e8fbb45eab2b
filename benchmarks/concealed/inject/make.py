# SPDX-License-Identifier: BSD-3-Clause
"""Draw, write and seal."""

from pathlib import Path

from benchmarks.concealed.inject.plan import draw
from benchmarks.concealed.inject.writing import write_record


def make(folder, data, seed=0, counts=None):
    """Write records with effects put into real recordings, and seal their truths.

    Parameters
    ----------
    folder : path
        Gets record_0000, record_0001, ... in a drawn order, and seal.txt, the SHA-256 of every truth.json.
    data : path
        Holds the folders watersafe, damadics and refinery_loops.
    seed : int, default=0
    counts : dict, default=None
        Records with an effect by source ("watersafe", "damadics", "refinery"); a source that is missing or 0
        is left out altogether.

    Returns
    -------
    names : list of str

    Raises
    ------
    FileExistsError
        If `folder` holds records already.
    """
    folder = Path(folder)
    if any(folder.glob("record_*")):
        raise FileExistsError(f"Expected a folder without records; {str(folder)!r} holds some: name another.")
    records = draw(data, seed, counts)
    names = [f"record_{i:04d}" for i in range(len(records))]
    untouched = {
        record["truth"]["base"]: name
        for name, record in zip(names, records, strict=True)
        if record["truth"]["kind"] == "healthy"
    }
    seal = []
    for name, record in zip(names, records, strict=True):
        truth = record["truth"] | {"twin": untouched[record["truth"]["base"]]}
        seal.append(
            write_record(
                folder / name, record["table"], record["behind"], record["sheet"], truth, record["rows"]
            )
        )
    (folder / "seal.txt").write_text("\n".join(seal) + "\n", encoding="utf-8")
    return names
