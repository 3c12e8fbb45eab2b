# SPDX-License-Identifier: BSD-3-Clause
"""How often what a diagnosis says of where and when is true, on recordings of the plant drawn anew.

    python benchmarks/locate.py [--effects 60] [--healthy 60] [--noise 200] [--rows 2400] [--seed 0]

Prints, for effects drawn one per recording with an onset drawn over the middle of it (three in four, the
others from the start): how often the interval of the onset holds the true one, and how wide it is; how the
rows of the region overlap those in which the same plant without the effect differs by a fifth of the most;
then how often any mean leaves its simultaneous band in healthy recordings, and in simulated noise with a
quick part and a wander whose model is fitted each time.
"""

import argparse
import os
import sys
import time
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

sys.path.insert(0, str(Path(__file__).parents[1]))
from benchmarks.concealed.methods.rows import overlap, told_rows
from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import CONCEALABLE, make_valve_recording
from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.describe.bands import simultaneous_bands
from sklvalve.mismatch.describe.cells import cells_of, cells_of_signals, rate_of_travel
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.simulation.noise_fit import fit_noise

IN_NO_CATALOGUE = ("trim_rotation", "thermal_bow", "hydrate_pulses")
NAMED = tuple(name for name in CONCEALABLE if name not in IN_NO_CATALOGUE)


def recording_of(made):
    """The recording of a table that the plant wrote."""
    return Recording.from_frame(made.frame, Valve.from_dict(made.valve))


def truly_acting(made, twin, onset):
    """Rows in which the plant differs from its twin without the effect by a fifth of the most."""
    n = len(made.frame)
    if made.truth["blocks"] == ["actuator"]:
        gap = np.abs(made.frame["X"] - twin.frame["X"]).to_numpy()
    else:
        gap = np.abs(made.flow_without_noise["flow"] - twin.flow_without_noise["flow"]).to_numpy()[:n]
    return (gap > 0.2 * np.quantile(gap[int(onset) :], 0.99)) & (gap > 0.0)


def effects(many, rows, rng):
    """Effects drawn, diagnosed, and held against the truth."""
    held = wide = given = throughout = right_throughout = late = 0
    shares, widths = [], []
    for i in range(many):
        name, seed = NAMED[int(rng.integers(len(NAMED)))], int(rng.integers(2**31))
        onset = float(int(rng.uniform(0.15, 0.8) * rows)) if i % 4 else 0.0
        # a loop that is open does the same without the effect
        settings = {"loop": "wide", "n_samples": rows, "n_later": 0, "random_state": seed}
        made = make_valve_recording(name, onset=onset, **settings)
        twin = make_valve_recording(name, 0.0, onset=onset, **settings)
        recording = recording_of(made)
        began = time.perf_counter()
        diagnosis = MissingPhysicsFinder().fit(recording).diagnosis_
        took = time.perf_counter() - began
        location = diagnosis.content["location"]
        found = diagnosis.verdict != "no_mismatch"
        right = any(made.truth["effects"][0] in names for names in diagnosis.effects)
        ci = location.get("onset_ci95")
        text = "-"
        if right and onset > 0.0:
            late += 1
            if ci is not None:
                given += 1
                hit = ci[0] <= onset <= ci[1]
                held += hit
                widths.append(ci[1] - ci[0])
                text = (
                    f"{location['onset'] or 0.0:.0f} in [{ci[0]:.0f}, {ci[1]:.0f}]{'' if hit else ' MISSED'}"
                )
            else:
                text = "not seen"
        elif right:
            throughout += 1
            right_throughout += location["onset"] is None
            text = "the start" if location["onset"] is None else f"{location['onset']:.0f} WRONG"
        share = float("nan")
        if found and right:
            true = truly_acting(made, twin, onset)
            seconds = made.frame["time"].to_numpy(dtype=float)
            ratio = diagnosis.traces["pressure_ratio"]
            share = overlap(told_rows(diagnosis.content, recording, seconds, pressure_ratio=ratio), true)
            shares.append((share, overlap(np.ones(rows, dtype=bool), true)))
            wide += share > 0.5
        place = "; ".join(_told(region) for region in location["regions"]) or "-"
        print(
            f"| {name} | {seed} | {'right' if right else diagnosis.verdict} | {onset:.0f} | {text} "
            f"| {location.get('course', '-')} | {share:.2f} | {place} | {took:.0f} |",
            flush=True,
        )
    print(
        f"onset within the recording: {late} named right, {given} with an onset told, of these the interval"
    )
    print(f"holds the true one in {held}; median width {np.median(widths or [0]):.0f} s")
    print(f"from the start: {throughout} named right, {right_throughout} told so")
    mean = np.mean(shares or [(0, 0)], axis=0)
    print(
        f"overlap of rows (intersection over union): mean {mean[0]:.2f}, above a half in {wide} of", end=" "
    )
    print(f"{len(shares)}; all rows of the recording would have {mean[1]:.2f}")


def _told(region):
    bounds = [f"{b['signal']} {b['low']:.3g}..{b['high']:.3g}" for b in (region, region.get("and")) if b]
    return " and ".join(bounds) + (f" {region['direction']}" if region["direction"] else "")


def healthy(many, rows, rng, alpha=0.01):
    """Healthy recordings in which any mean leaves its band."""
    out = 0
    for i in range(many):
        settings = {"noise": (1.0, 2.5)[i % 3 == 2], "loop": (None, "wide", "closed")[i % 3]}
        made = make_valve_recording(
            n_samples=rows, n_later=0, random_state=int(rng.integers(2**31)), **settings
        )
        problem = prepared_problem(recording_of(made))
        problem, model = calibrated(problem)
        problem = problem.with_noise_of(model)
        model = problem.fit((), start=model)
        left, parts = problem.residuals(model), []
        for c in problem.channels:
            cells = cells_of(model.chain, model.values, c, model.predictions[c])
            parts.append((problem.noise[c], left[c], [left[c]], cells))
        bands = simultaneous_bands(parts, alpha=alpha)
        out += any(b.beyond.any() for channel in bands for several in channel for b in several)
    print(f"healthy recordings, a region at alpha {alpha}: {out} of {many}", flush=True)


def noise_alone(many, rng, rows=3000):
    """Simulated noise, quick and wandering, in which any mean leaves its band."""

    def wandering(size, seconds):
        keep = np.exp(-1.0 / seconds)
        return size * lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], rng.standard_normal(rows))

    drawn = []
    for _ in range(many):
        opening = 0.5 + wandering(0.3, 200.0)
        signals = {"opening": opening, "pressure_ratio": 0.4 + wandering(0.1, 600.0)}
        signals["rate"] = rate_of_travel(opening, np.arange(rows, dtype=float))
        left = 0.01 * (rng.standard_normal(rows) + wandering(0.7, 10.0) + wandering(0.6, 333.0))
        drawn.append(
            (fit_noise(left, opening, np.ones(rows)), left, [left], cells_of_signals(signals, "flow"))
        )
    for alpha in (0.05, 0.01):
        out = 0
        for part in drawn:
            ((bands,),) = simultaneous_bands([part], alpha=alpha)
            out += any(band.beyond.any() for band in bands)
        print(f"noise alone, any mean out of its band at alpha {alpha}: {out} of {many}", flush=True)


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Hold what is said of where and when against the truth.")
    parser.add_argument("--effects", type=int, default=60)
    parser.add_argument("--healthy", type=int, default=60)
    parser.add_argument("--noise", type=int, default=200)
    parser.add_argument("--rows", type=int, default=2400)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    print(f"load {os.getloadavg()[0]:.1f}")
    rng = np.random.default_rng(options.seed)
    if options.noise:
        noise_alone(options.noise, rng)
    if options.healthy:
        healthy(options.healthy, options.rows, rng)
    if options.effects:
        head = ("effect", "seed", "name", "true onset [s]", "told, 95 %", "course", "overlap", "region", "s")
        print("| " + " | ".join(head) + " |\n|" + "---|" * len(head))
        effects(options.effects, options.rows, rng)


if __name__ == "__main__":
    main()
