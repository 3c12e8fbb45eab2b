# SPDX-License-Identifier: BSD-3-Clause
"""How long a diagnosis takes, this code against that of another commit, on the same recordings in turns.

    python -m benchmarks.speed FOLDER [--against COMMIT] [--times 3] [--only NAME ...] [--jobs 2]

FOLDER holds a folder for each recording (`recording.csv` or `.csv.gz`, and `valve.toml`). The other commit is
checked out beside the repository for the time of the run. Each code fits in one process of its own that has
compiled before; they take turns at every recording, so that a load from elsewhere weighs on both alike. Three
tables: seconds and their ratio, with the verdicts of both; where the time of this code goes; recordings an
hour when some processes diagnose side by side.
"""

import argparse
import cProfile
import json
import os
import pstats
import resource
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: The commit that first held what is measured here.
AGAINST = "f2c266f"
#: Where the time goes: file and function, and what it does. The first guess holds runs of the stem.
PARTS = {
    ("first_values.py", "first_values"): "first guess of the actuator",
    ("stem.py", "positioner_and_actuator"): "stem",
    ("chain.py", "flow"): "flow",
    ("robust.py", "least_within"): "bounded least squares",
    ("noise_fit.py", "fit_noise"): "noise",
    ("black_box.py", "black_box_prediction"): "black box",
    ("black_box.py", "_of_one_sign"): "black box of a loop",
    ("unknown.py", "look_for_residual"): "rest that no effect explains",
    ("change.py", "find_change"): "dating of a change",
    ("intermittent.py", "intermittent"): "episodes",
}


def main(arguments=None):
    """Measure and print; or, as a worker, fit what is asked for on the standard input."""
    asked = _parser().parse_args(arguments)
    if asked.worker:
        _work()
        return
    places = [p.parent for p in sorted(Path(asked.folder).glob("*/valve.toml"))]
    places = [p for p in places if not asked.only or p.name in asked.only]
    if not places:
        raise SystemExit(f"no folder with a valve.toml and a recording in {asked.folder}")
    print(f"load before {os.getloadavg()[0]:.1f}, {asked.times} turns, processor time of one thread\n")
    with _other(asked.against) as other:
        _in_turns(places, asked.times, {"this": ROOT, asked.against: other})
    _where(places)
    _side_by_side(places, asked.jobs)
    print(f"\nload after {os.getloadavg()[0]:.1f}")


def _parser():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", nargs="?", default=".")
    parser.add_argument("--against", default=AGAINST)
    parser.add_argument("--times", type=int, default=3)
    parser.add_argument("--only", nargs="+")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    return parser


@contextmanager
def _other(commit):
    """A checkout of another commit, removed in the end."""
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        git = ["git", "-C", str(ROOT), "worktree"]
        subprocess.run([*git, "add", "--detach", "--quiet", str(tree), commit], check=True)
        try:
            yield tree
        finally:
            subprocess.run([*git, "remove", "--force", str(tree)], check=True)


def _in_turns(places, times, codes):
    workers = {name: Worker(tree) for name, tree in codes.items()}
    try:
        for worker in workers.values():
            worker.fit(places[0])
        this, other = codes
        print(
            f"| recording | {this} [s] | {other} [s] | ratio | {this} | {other} |\n|---|---|---|---|---|---|"
        )
        ratios = []
        for place in places:
            runs = {name: [] for name in codes}
            for turn in range(times):
                order = list(codes) if turn % 2 == 0 else list(codes)[::-1]
                for name in order:
                    runs[name].append(workers[name].fit(place))
            seconds = {name: statistics.median(r["seconds"] for r in each) for name, each in runs.items()}
            ratios.append(seconds[other] / seconds[this])
            found = " | ".join(runs[name][0]["found"] for name in codes)
            print(
                f"| {place.name} | {seconds[this]:.2f} | {seconds[other]:.2f} | {ratios[-1]:.2f} | {found} |",
                flush=True,
            )
        memory = ", ".join(f"{name} {w.fit(places[0])['mib']:.0f} MiB" for name, w in workers.items())
        print(
            f"\nmedian of the ratios {statistics.median(ratios):.2f}, least {min(ratios):.2f}; peak {memory}"
        )
    finally:
        for worker in workers.values():
            worker.close()


class Worker:
    """A process that imports the package from a tree and fits the recordings it is told."""

    def __init__(self, tree):
        threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
        self._process = subprocess.Popen(
            # this file, whichever the tree: an older one has none
            [sys.executable, str(Path(__file__).resolve()), "--worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=tree,
            env=os.environ | threads | {"PYTHONPATH": str(tree)},
        )

    def fit(self, place):
        """Seconds of processor time, what was found, and the process's peak of memory [MiB]."""
        self.begin(place)
        return self.result()

    def begin(self, place):
        """Let it fit; `result` waits for it."""
        self._process.stdin.write(f"{place.resolve()}\n")
        self._process.stdin.flush()

    def result(self):
        """What came of the fit begun last."""
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("a process that fits recordings ended")
        return json.loads(line)

    def close(self):
        """End it."""
        self._process.stdin.close()
        self._process.wait()


def _work():
    for line in sys.stdin:
        began = time.process_time()
        finder = _fitted(Path(line.strip()))
        told = {
            "seconds": time.process_time() - began,
            "found": _found(finder.diagnosis_.to_dict()),
            "mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        }
        print(json.dumps(told), flush=True)


def _fitted(place):
    # the package of the tree that the process was begun in
    from sklvalve import MissingPhysicsFinder, read_recording

    file = next(place / name for name in ("recording.csv", "recording.csv.gz") if (place / name).exists())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return MissingPhysicsFinder(random_state=0, n_jobs=1).fit(read_recording(file, place / "valve.toml"))


def _found(diagnosis):
    classes = ["/".join(sorted(m["name"] for m in e["members"])) for e in diagnosis["effects"]]
    return " + ".join(classes) or diagnosis["verdict"]


def _where(places):
    """Share of the time of each part, of this code, over all recordings."""
    _fitted(places[0])
    profile = cProfile.Profile()
    for place in places:
        profile.enable()
        _fitted(place)
        profile.disable()
    stats = pstats.Stats(profile)
    shares = dict.fromkeys(PARTS, 0.0)
    for (file, _, name), (*_, cumulative, _) in stats.stats.items():
        part = Path(file).name, name
        if part in shares:
            shares[part] += cumulative / stats.total_tt
    print("\n| part (some hold others) | share of the time |\n|---|---|")
    for part, share in sorted(shares.items(), key=lambda item: -item[1]):
        print(f"| {PARTS[part]} | {share:.0%} |")


def _side_by_side(places, jobs):
    workers = [Worker(ROOT) for _ in range(jobs)]
    try:
        for worker in workers:
            worker.fit(places[0])
        began, many = time.perf_counter(), 0
        for batch in (places[i : i + jobs] for i in range(0, len(places), jobs)):
            # a batch waits for its slowest: recordings of unlike length cost a little by that
            for worker, place in zip(workers, batch, strict=False):
                worker.begin(place)
            many += len([worker.result() for worker, _ in zip(workers, batch, strict=False)])
        print(f"\n{3600.0 * many / (time.perf_counter() - began):.0f} recordings an hour in {jobs} processes")
    finally:
        for worker in workers:
            worker.close()


if __name__ == "__main__":
    main()
