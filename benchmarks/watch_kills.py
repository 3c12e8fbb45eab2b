# SPDX-License-Identifier: BSD-3-Clause
"""A watch that is killed again and again, and one whose Dask worker dies: is the state in the end the same?

    python -m benchmarks.watch_kills FOLDER [--kills 40] [--seed 0] [--no-dask]

A small plant of simulated valves is watched once without disturbance. Then it is watched from nothing, and
each run is killed at a random moment, half of them with their processes, before a last one may end. And once
over two Dask workers, of which one is killed while it works. Every file of the three states must be the same,
byte for byte. Ends with 1 where one differs. Needs a POSIX system, and `distributed` unless `--no-dask`.
"""

import argparse
import hashlib
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from sklvalve.datasets.valve_days import write_plant

VALVES, DAYS, ROWS = 3, 30, 700
# a run is killed after so many seconds at most: beginning, learning and reading days all happen in them
LONGEST = 7.0
_CODE = "import sys; from sklvalve.cli import main; sys.exit(main(sys.argv[1:]))"


def command(plant, state, *more):
    """Words of one run."""
    words = ["watch", str(plant / "plant.toml"), "--data", str(plant / "rows"), "--state", str(state)]
    return [sys.executable, "-c", _CODE, *words, *more]


def tree(folder):
    """Checksums of all files that a state holds; drafts of killed runs are none, and swept after an hour."""
    return {
        file.relative_to(folder).as_posix(): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted(folder.rglob("*"))
        if file.is_file() and not file.name.startswith(".")
    }


def undisturbed(plant, state):
    """Seconds of a run that nobody disturbs."""
    began = time.perf_counter()
    subprocess.run(command(plant, state), check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began


def killed(plant, state, times, seed):
    """Watch, killed so many times; how many runs were in fact killed before they ended."""
    dice, many = random.Random(seed), 0
    for _ in range(times):
        run = subprocess.Popen(
            command(plant, state),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        try:
            run.wait(dice.uniform(0.2, LONGEST))
        except subprocess.TimeoutExpired:
            # alone, its processes go on for a while beside the next run
            (os.killpg if dice.random() < 0.5 else os.kill)(run.pid, signal.SIGKILL)
            run.wait()
            many += 1
    subprocess.run(command(plant, state), check=True, stdout=subprocess.DEVNULL)
    return many


def over_dask(plant, state):
    """Watch over two workers, of which one is killed while it works."""
    address = "tcp://127.0.0.1:8796"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "start_new_session": True}
    dask = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard"]
    started = [
        subprocess.Popen(
            [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", "8796", "--no-dashboard"],
            **quiet,
        ),
        subprocess.Popen(dask, **quiet),
        subprocess.Popen(dask, **quiet),
    ]
    try:
        time.sleep(8.0)
        run = subprocess.Popen(command(plant, state, "--scheduler", address), stdout=subprocess.DEVNULL)
        time.sleep(12.0)
        alive = run.poll() is None
        os.killpg(started[2].pid, signal.SIGKILL)
        run.wait()
        return alive and run.returncode == 0
    finally:
        for each in started:
            if each.poll() is None:
                os.killpg(each.pid, signal.SIGKILL)
            each.wait()


def main(arguments=None):
    """Run it; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kills", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--no-dask", action="store_true")
    options = parser.parse_args(arguments)
    folder = options.folder.resolve()
    shutil.rmtree(folder, ignore_errors=True)
    plant = folder / "plant"
    plant.mkdir(parents=True)
    write_plant(plant, valves=VALVES, days=DAYS, rows=ROWS, random_state=options.seed)
    seconds = undisturbed(plant, folder / "undisturbed")
    same = tree(folder / "undisturbed")
    calls = sum(name.startswith("calls/") for name in same)
    print(f"undisturbed: {len(same)} files, {calls} valves with findings, {seconds:.0f} s", flush=True)
    if not calls:
        parser.exit(1, "no valve was found to have changed: findings are not tested; take another seed\n")
    many = killed(plant, folder / "killed", options.kills, options.seed)
    rows = [(f"killed {many} times of {options.kills} runs", tree(folder / "killed") == same)]
    if not options.no_dask:
        ended = over_dask(plant, folder / "dask")
        rows.append(("two Dask workers, one killed at work", ended and tree(folder / "dask") == same))
    for what, equal in rows:
        print(f"| {what} | {'the same, byte for byte' if equal else 'DIFFERENT'} |")
    return 0 if all(equal for _, equal in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
