# SPDX-License-Identifier: BSD-3-Clause
"""Speed and memory of the mechanism: a million rows of liquid rating, and what limits them.

    python benchmarks/mechanism.py [ROWS] [THREADS]

Prints one table. Times are medians of repeats that alternate between the contestants, so that a load from
elsewhere meets all of them. `fluids` (an extra of the tests) sizes, which is the same equations the other way
round, and is given the properties that are computed from the temperature here.
"""

import os
import statistics
import sys
import threading
import time
import tracemalloc

import numpy as np

from sklvalve.mechanism import (
    liquid_flow,
    rate_liquid,
    water_density,
    water_kinematic_viscosity,
    water_vapour_pressure,
)

REPEATS = 15
ROWS_OF_FLUIDS = 20_000
ROWS_IN_CACHE = 16_384
AGAIN = 10
VALVE = {"fl": 0.9, "fd": 0.46, "kv_rated": 100.0, "nominal_size": 0.1}
PIPES = {"inlet_pipe": 0.15, "outlet_pipe": 0.15}


def duties(n):
    """Water through a valve at many openings, a quarter of the rows choked."""
    rng = np.random.default_rng(0)
    p1 = rng.uniform(3e5, 10e5, n)
    return {
        "kv": rng.uniform(1.0, 100.0, n),
        "p1": p1,
        "p2": p1 * rng.uniform(0.05, 1.0, n),
        "temperature": rng.uniform(275.0, 400.0, n),
    }


def contestants(case, threads):
    """Name: (function without arguments, rows it works on)."""
    n = len(case["kv"])
    valve = {name: VALVE[name] for name in ("fl", "nominal_size")}
    few = {name: values[:ROWS_OF_FLUIDS] for name, values in case.items()}
    cached = {name: values[:ROWS_IN_CACHE] for name, values in case.items()}
    one = {name: values[:1] for name, values in case.items()}
    quiet = {"warn": False, "n_jobs": threads}
    found = {
        "properties and choking": (lambda: rate_liquid(**case, fl=0.9, **quiet), n),
        "properties, choking, reducers": (lambda: rate_liquid(**case, **valve, **PIPES, **quiet), n),
        "properties, choking, reducers, viscosity": (
            lambda: rate_liquid(**case, **VALVE, **PIPES, **quiet),
            n,
        ),
        "properties, choking, viscosity": (lambda: rate_liquid(**case, **VALVE, **quiet), n),
        "properties and choking, 1 thread": (lambda: rate_liquid(**case, fl=0.9, warn=False, n_jobs=1), n),
        "with viscosity, 1 thread": (lambda: rate_liquid(**case, **VALVE, warn=False, n_jobs=1), n),
        "properties and choking, 1 thread, in cache": (lambda: again(cached, fl=0.9), AGAIN * ROWS_IN_CACHE),
        "with viscosity, 1 thread, in cache": (lambda: again(cached, **VALVE), AGAIN * ROWS_IN_CACHE),
        "a single row (time of the call)": (lambda: rate_liquid(**one, fl=0.9, warn=False), 1),
        "moving the same bytes": (lambda: move(case, threads), n),
        "elementary functions, choking": (lambda: elementary(few), ROWS_OF_FLUIDS),
        "elementary functions, viscosity": (lambda: elementary(few, **VALVE), ROWS_OF_FLUIDS),
    }
    try:
        import fluids.vectorized
    except ImportError:
        print("fluids is not installed: its rows are left out")
        return found
    given = prepared(few)
    ends = {"D1": 0.1, "D2": 0.1, "d": 0.1, "FL": 0.9, "Fd": 0.46}
    size = fluids.vectorized.size_control_valve_l
    found["fluids.vectorized, sizing, choking"] = (lambda: size(**given, FL=0.9), ROWS_OF_FLUIDS)
    found["fluids.vectorized, sizing, viscosity"] = (lambda: size(**given, **ends), ROWS_OF_FLUIDS)
    return found


def again(case, **valve):
    """The same rows over and over: all but the first time they lie in the cache."""
    for _ in range(AGAIN):
        rate_liquid(**case, **valve, warn=False, n_jobs=1)


def move(case, threads):
    """Read the four inputs and write one output, with hardly any arithmetic."""
    kv, p1, p2, temperature = case.values()
    out = np.empty_like(kv)
    cuts = [len(kv) * k // threads for k in range(threads + 1)]

    def work(k):
        # by pieces, so that what the next sum adds to is still near
        for start in range(cuts[k], cuts[k + 1], 8192):
            part = slice(start, min(start + 8192, cuts[k + 1]))
            np.add(kv[part], p1[part], out=out[part])
            np.add(out[part], p2[part], out=out[part])
            np.add(out[part], temperature[part], out=out[part])

    others = [threading.Thread(target=work, args=(k,)) for k in range(1, threads)]
    for thread in others:
        thread.start()
    work(0)
    for thread in others:
        thread.join()
    return out


def elementary(case, **valve):
    """The functions of the package one after the other, in numpy."""
    temperature = case["temperature"]
    more = {"viscosity": water_kinematic_viscosity(temperature)} if valve else {"fl": 0.9}
    return liquid_flow(
        case["kv"],
        case["p1"],
        case["p2"],
        water_density(temperature),
        p_vapour=water_vapour_pressure(temperature),
        warn=False,
        **more,
        **valve,
    )


def prepared(case):
    """What `fluids` needs to size a valve for the flows of these duties."""
    temperature = case["temperature"]
    density = water_density(temperature)
    return {
        "rho": density,
        "Psat": water_vapour_pressure(temperature),
        "Pc": 22.064e6,
        "mu": water_kinematic_viscosity(temperature) * density,
        "P1": case["p1"],
        "P2": case["p2"],
        "Q": rate_liquid(**case, fl=0.9, warn=False),
    }


def memory(case, **valve):
    """Peak of what a call allocates, its result included, in sizes of the inputs."""
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    kept = rate_liquid(**case, **valve, warn=False)
    peak = tracemalloc.get_traced_memory()[1] - before
    tracemalloc.stop()
    del kept
    return peak / sum(values.nbytes for values in case.values())


def main(rows=1_000_000, threads=2):
    """Print the table."""
    case = duties(rows)
    runs = contestants(case, threads)
    before = os.getloadavg()[0]
    wall, busy = ({name: [] for name in runs} for _ in range(2))
    for run, _ in runs.values():
        run()
    for _ in range(REPEATS):
        for name, (run, n) in runs.items():
            began, began_busy = time.perf_counter(), time.process_time()
            run()
            wall[name].append((time.perf_counter() - began) / n * 1e9)
            busy[name].append((time.process_time() - began_busy) / n * 1e9)
    print(f"{rows} rows, {threads} threads, {REPEATS} repeats, load {before:.1f} before, ", end="")
    print(f"{os.getloadavg()[0]:.1f} after\n")
    print("| what | ns a row, median | least | processor time, all threads |")
    print("|---|---|---|---|")
    median = {name: statistics.median(wall[name]) for name in runs}
    for name in runs:
        least, work = min(wall[name]), statistics.median(busy[name])
        print(f"| {name} | {median[name]:.3g} | {least:.3g} | {work:.3g} |")
    print()
    for kind, ours in (
        ("choking", "properties and choking"),
        ("viscosity", "properties, choking, viscosity"),
    ):
        for other in ("elementary functions", "fluids.vectorized, sizing"):
            name = f"{other}, {kind}"
            if name in median:
                print(f"{ours}: {median[name] / median[ours]:.1f} times as fast as {name}")
    single = {name: values.astype(np.float32) for name, values in case.items()}
    print(f"memory, choking: {memory(case, fl=0.9):.2f} of the inputs")
    print(f"memory, viscosity: {memory(case, **VALVE):.2f} of the inputs")
    print(f"memory, choking, inputs in single precision: {memory(single, fl=0.9):.2f} of the inputs")


if __name__ == "__main__":
    main(*(int(argument) for argument in sys.argv[1:]))
