# SPDX-License-Identifier: BSD-3-Clause
"""Runs ended in their midst, by a kill and by two signals: is a result ever half, mixed, lost, or left over?

    python -m benchmarks.kills [--times N] [--only COMMAND ...] [--seed N]

Each command runs N times for each signal, over its own earlier results. Half of the runs are ended at any
moment of their time, half where all results are made and are about to be moved, or are being moved. INT and
TERM must leave the earlier set whole, or the new one. After a KILL the next run in that folder may have to
finish the moves, so a small import comes between. Ends with 1 where something failed. Needs a POSIX system.
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import zipfile
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from sklvalve.datasets import make_valve_recording
from sklvalve.datasets.concealed import to_toml

SIGNALS = {"KILL": signal.SIGKILL, "INT": signal.SIGINT, "TERM": signal.SIGTERM}
_OUT = "out"
_PREFIX = ".sklvalve-"
# a process started in the background may have been told to ignore the signal: not so here
_CODE = (
    "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from sklvalve.cli import main; sys.exit(main(sys.argv[1:]))"
)
_DIAGNOSIS = ("diagnosis.json", "report.html", "corrected_model.skops")


@dataclass(frozen=True)
class Command:
    """Words of a command, and the files that it writes into the folder `out`."""

    words: str
    names: tuple


COMMANDS = {
    "import": Command("import export.csv --out out/clean.csv", ("clean.csv", "clean.import.json")),
    "diagnose": Command("diagnose recording.csv --valve valve.toml --out out", _DIAGNOSIS),
    "predict": Command(
        "predict recording.csv --model model.skops --out out/predictions.csv", ("predictions.csv",)
    ),
    "demo": Command(
        "demo --out out", ("recording.csv", "later.csv", "valve.toml", "truth.json", *_DIAGNOSIS)
    ),
}
_NEXT = Command("import small.csv --out out/next.csv", ("next.csv", "next.import.json"))


def inputs(folder):
    """Write what the commands read: a recording and its valve, an export, and a model of the recording."""
    made = make_valve_recording("clogging", 0.5, loop="wide", n_samples=1200, n_later=0, random_state=3)
    made.frame.to_csv(folder / "recording.csv", index=False)
    (folder / "valve.toml").write_text(to_toml(made.valve), encoding="utf-8")
    for name, rows in (("export.csv", 40_000), ("small.csv", 50)):
        lines = [f"{5 * row},{row % 97},{row % 89}" for row in range(rows)]
        (folder / name).write_text("\n".join(["time,FIC1.PV [m3/h],FIC1.OP [%]", *lines]) + "\n")
    (folder / _OUT).mkdir()
    _finished(folder, COMMANDS["diagnose"])
    (folder / _OUT / "corrected_model.skops").rename(folder / "model.skops")
    for left in (folder / _OUT).iterdir():
        left.unlink()


def ended(folder, command, number, moment, rng):
    """Start a command, end it, and say what is wrong with what it leaves, in a word; "" where nothing is.

    Parameters
    ----------
    folder : Path
    command : Command
    number : signal.Signals
    moment : float or None
        Seconds from the start; None for when all results are made.
    rng : random.Random

    Returns
    -------
    wrong : str
    new : bool
        Whether the new set stands there.
    """
    out = folder / _OUT
    before = _state(out, command)
    work = _started(folder, command)
    if moment is None:
        while work.poll() is None and not _made(out, command):
            time.sleep(0.0005)
        moment = 0.03 * rng.random()
    with suppress(subprocess.TimeoutExpired):
        work.wait(moment)
    work.send_signal(number)
    _, told = work.communicate(timeout=60)
    if number == signal.SIGKILL:
        _finished(folder, _NEXT)
        for name in _NEXT.names:
            (out / name).unlink()
    after = _state(out, command)
    changed = {before[name] != after[name] for name in command.names}
    return _wrong(out, command, before, after, changed, told, number), changed == {True}


def _wrong(out, command, before, after, changed, told, number):
    if any(name.startswith(_PREFIX) for name in os.listdir(out)):
        return "left over"
    if len(changed) > 1:
        return "mixed"
    if any(before[name] is not None and after[name] is None for name in command.names):
        return "lost"
    if any(after[name] is not None and not _whole(out / name) for name in command.names):
        return "half"
    # a traceback that names no file of ours comes from the interpreter's own start
    if number != signal.SIGKILL and "Traceback" in told and f"{os.sep}sklvalve{os.sep}" in told:
        return "a traceback"
    if number != signal.SIGKILL and changed == {True} and "nothing was written" in told:
        return "denied"
    return ""


def _state(out, command):
    """What tells a file from its replacement, for each of a command's files; None where there is none."""
    state = {}
    for name in command.names:
        try:
            told = (out / name).stat()
            state[name] = (told.st_ino, told.st_mtime_ns, told.st_size)
        except FileNotFoundError:
            state[name] = None
    return state


def _made(out, command):
    """Whether a run has all its results where it makes them."""
    with suppress(OSError):
        return any(set(command.names) <= set(os.listdir(held)) for held in out.glob(f"{_PREFIX}*"))
    return False


def _whole(path):
    if path.suffix == ".json":
        with suppress(ValueError):
            return bool(json.loads(path.read_text(encoding="utf-8")))
        return False
    if path.suffix == ".skops":
        with suppress(zipfile.BadZipFile), zipfile.ZipFile(path) as packed:
            return packed.testzip() is None
        return False
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".csv":
        lines = text.splitlines()
        return text.endswith("\n") and len({line.count(",") for line in lines}) == 1
    return text.rstrip().endswith("</html>") if path.suffix == ".html" else text.endswith("\n")


def _started(folder, command):
    return subprocess.Popen(
        [sys.executable, "-c", _CODE, *command.words.split()],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def _finished(folder, command):
    """Run a command to its end; seconds that it took."""
    began = time.perf_counter()
    work = _started(folder, command)
    _, told = work.communicate()
    if work.returncode:
        raise RuntimeError(f"{command.words}: {told}")
    return time.perf_counter() - began


def tried(name, times, seed):
    """Counters of what came of a command's runs, a signal each: runs, new sets, and what was wrong."""
    command, rng = COMMANDS[name], random.Random(seed)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        inputs(folder)
        took = _finished(folder, command)
        for called, number in SIGNALS.items():
            counted = Counter()
            for turn in range(times):
                moment = took * rng.random() if turn % 2 else None
                wrong, new = ended(folder, command, number, moment, rng)
                counted.update(
                    {"runs": 1, "new sets": new, wrong: 1} if wrong else {"runs": 1, "new sets": new}
                )
            yield called, counted


def main(arguments=None):
    """Run and print; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.kills", description=__doc__.splitlines()[0])
    parser.add_argument("--times", type=int, default=60, help="runs of each command for each signal; 60")
    parser.add_argument("--only", nargs="+", choices=COMMANDS, default=list(COMMANDS), metavar="COMMAND")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    failed = False
    print(f"{'command':10}{'signal':8}{'runs':>6}{'new sets':>10}  wrong")
    for name in options.only:
        for called, counted in tried(name, options.times, options.seed):
            wrong = {what: many for what, many in counted.items() if what not in ("runs", "new sets")}
            failed = failed or bool(wrong)
            told = ", ".join(f"{many} {what}" for what, many in wrong.items()) or "none"
            print(f"{name:10}{called:8}{counted['runs']:>6}{counted['new sets']:>10}  {told}", flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
