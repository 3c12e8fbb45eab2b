# SPDX-License-Identifier: BSD-3-Clause
"""One recording by the command line, in a process of its own, and what came of it."""

import hashlib
import json
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd

import sklvalve
from benchmarks.real.judging import errors_of, judged, referee

_CLI = [sys.executable, "-c", "import sys; from sklvalve.cli import main; sys.exit(main(sys.argv[1:]))"]
#: A diagnosis that takes longer is reported as a timeout [s].
LIMIT = 1800.0


def code_state():
    """Digest of the package and of what cuts and judges: a row made by another one is made again."""
    package, here = Path(sklvalve.__file__).parent, Path(__file__).parent
    own = [here / name for name in ("recordings.py", "running.py", "judging.py", "labels.toml")]
    digest = hashlib.sha256()
    for file in [*sorted(package.rglob("*.py")), *sorted(package.rglob("*.toml")), *own]:
        digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()[:12]


def _ran(arguments, limit):
    return subprocess.run([*_CLI, *arguments], capture_output=True, text=True, timeout=limit, check=False)


def _sampling(table):
    """Median time between rows [s]."""
    times = table.iloc[:, 0]
    if times.dtype.kind in "fiu":
        return round(float(times.diff().median()), 3)
    return round(pd.to_datetime(times, format="ISO8601").diff().median().total_seconds(), 3)


def judge(case, folder, state, limit=LIMIT):
    """Row of a case; its files go to a folder of its own in `folder`."""
    into = Path(folder) / case.name
    into.mkdir(parents=True, exist_ok=True)
    table = case.table()
    file, sheet, out = into / "recording.csv", into / "valve.toml", into / "out"
    table.to_csv(file, index=False)
    row = {"recording": case.name, "kind": case.kind, "rows": len(table), "sampling_s": _sampling(table)}
    row |= {"label": case.label, "until": case.until, "note": case.note, "code": state}
    (out / "diagnosis.json").unlink(missing_ok=True)
    began = time.perf_counter()
    try:
        if case.sheet is None:
            run = _ran(["init", str(file), "--out", str(sheet), "--yes", "--force"], limit)
        else:
            sheet.write_text(case.sheet, encoding="utf-8")
            run = None
        if run is None or run.returncode == 0:
            until = ["--until", case.until] if case.until else []
            run = _ran(["diagnose", str(file), "--valve", str(sheet), "--out", str(out), *until], limit)
    except subprocess.TimeoutExpired:
        row |= {"verdict": "timeout", "judgement": "failed", "reason": f"longer than {limit:.0f} s"}
    else:
        row |= _answer(run, out / "diagnosis.json", case.label, str(into))
    return row | {"seconds": round(time.perf_counter() - began, 1)}


def _answer(run, file, label, folder):
    """What a finished process gives: its diagnosis, a refusal in a sentence, or a crash."""
    if run.returncode or not file.is_file():
        last = (run.stderr.strip().splitlines() or ["no word"])[-1].replace(folder + "/", "")
        if "Traceback" in run.stderr or run.returncode < 0 or not run.returncode:
            return {"verdict": "crash", "judgement": "failed", "reason": last}
        return {"verdict": "refused", "judgement": "abstained" if label else "unjudged", "reason": last}
    found = json.loads(file.read_text(encoding="utf-8"))
    judgement, sure = judged(found, label)
    names = [
        {
            "members": [m["name"] for m in effect["members"]],
            "probability": effect.get("probability"),
            "grade": effect.get("grade"),
            "kind": effect.get("kind"),
        }
        for effect in found.get("effects", [])
    ]
    reason = (found.get("reasons") or [""])[0]
    row = {"verdict": found["verdict"], "names": names, "judgement": judgement, "sure": sure}
    return row | {"errors": errors_of(found), "referee": referee(found), "reason": reason}
