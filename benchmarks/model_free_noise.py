# SPDX-License-Identifier: BSD-3-Clause
"""How well noise told without a model meets the noise that a plant is known to have.

    python benchmarks/model_free_noise.py [--seed 20261121] [--records 12]

Healthy recordings of `sklvalve.datasets.make_valve_recording`, loops and noise in turn. Quick noise: scatter
of recorded less true signal about straight lines of 40 rows; all noise: its standard deviation; of the
opening where the plug rests. Ratios to these; the noise model's floor as a ratio to the steady stretches'.
"""

import argparse

import numpy as np

from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch.signals.steady import LENGTH

LOOPS, NOISES = ("wide", "closed", "mixed"), (1.0, 2.0, 3.0)


def main():
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked.add_argument("--seed", type=int, default=20261121)
    asked.add_argument("--records", type=int, default=12)
    given = asked.parse_args()
    print("| recording | signal | steady / quick | rows | repeats / all | rows | model / steady | verdict |")
    print("|---|---|---|---|---|---|---|---|")
    for k in range(given.records):
        loop, noise = LOOPS[k % 3], NOISES[k // 3 % 3]
        made = make_valve_recording(
            loop=loop, noise=noise, concealed=False, n_later=0, random_state=given.seed + k
        )
        hidden = ["true_opening", "flow_without_noise"]
        recording = Recording.from_frame(made.frame.drop(columns=hidden), Valve.from_dict(made.valve))
        content = MissingPhysicsFinder().fit(recording).diagnosis_.content
        for channel, column, true in (("flow", "F", hidden[1]), ("opening", "X", hidden[0])):
            truth = noise_of(made.frame[column], made.frame[true], channel)
            print(f"| {loop}, noise {noise:g} | {channel} | {row(content, channel, truth)} |", flush=True)


def noise_of(recorded, true, channel):
    """Quick and whole noise of a recorded signal."""
    left, true = (recorded - true).to_numpy(), true.to_numpy()
    starts = np.arange(0, len(left) - LENGTH, LENGTH)
    if channel == "opening":
        starts = [k for k in starts if np.ptp(true[k : k + LENGTH]) < 0.05]
    if not len(starts):
        return np.nan, np.nan
    rows = np.concatenate([np.arange(k, k + LENGTH) for k in starts])
    time = np.arange(LENGTH)
    scatter = [
        np.sum((part - np.polyval(np.polyfit(time, part, 1), time)) ** 2) / (LENGTH - 2)
        for part in left[rows].reshape(-1, LENGTH)
    ]
    return float(np.sqrt(np.mean(scatter))), float(left[rows].std())


def row(content, channel, truth):
    """Cells of the table."""
    told = content["fit"][channel]["model_free"]
    scale = 100.0 if told["unit"] == "1" else 1.0
    cells = []
    for name, true in zip(("steady", "repeats"), truth, strict=True):
        value = told[name]["value"]
        cells += ["-" if value is None else f"{scale * value / true:.2f}", str(told[name]["rows"])]
    steady = told["steady"]["value"]
    above = "-" if steady is None else f"{content['fit'][channel]['noise_floor'] / steady:.2f}"
    return " | ".join([*cells, above, content["verdict"]])


if __name__ == "__main__":
    main()
