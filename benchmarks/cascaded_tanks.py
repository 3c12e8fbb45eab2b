# SPDX-License-Identifier: BSD-3-Clause
"""A simulation of the user's own, of no valve at all: two tanks, one above the other, that can overflow.

    python benchmarks/cascaded_tanks.py FOLDER

FOLDER holds dataBenchmark.csv. A pump (voltage u) fills the upper tank, which runs into the lower one; its
level is recorded (voltage y). The user's simulation is two tanks with outflows by the square root of the
level, fitted to the rows of the first series in which the lower tank is not nearly full; it knows nothing of
an overflow. It is given as a column. The level takes the place of the flow that the simulation predicts, so
that a unit of m3/s stands for a volt throughout. The diagnosis sees the first series; the second is simulated
freely from the pump's voltage alone. Errors are RMSE in volts.
"""

import os
import sys
import time
from pathlib import Path

import numba as nb
import numpy as np
from scipy.optimize import least_squares

from sklvalve import MissingPhysicsFinder, Recording
from sklvalve.metrics import rmse

STEP = 4.0
# of 10 V, at which the sensor of the lower tank ends [V]
NEARLY_FULL = 8.0
# opening of the outlets, upper and lower, share of the upper outflow seen below, pump, levels to begin with
STARTS = ((0.05, 1.0, 0.05, 0.03, 5.0, 5.0), (0.03, 1.0, 0.03, 0.03, 3.0, 5.0))


@nb.njit(cache=True)
def two_tanks(pump, upper, shared, lower, gain, high, low):
    """Level of the lower tank [V] for the voltage of the pump, by steps of 0.4 s."""
    level = np.empty_like(pump)
    for k in range(len(pump)):
        level[k] = low
        for _ in range(10):
            out = upper * np.sqrt(max(high, 0.0))
            high += 0.1 * STEP * (gain * pump[k] - out)
            low += 0.1 * STEP * (shared * out - lower * np.sqrt(max(low, 0.0)))
    return level


def fitted(pump, level):
    """Parameters of the user's simulation, by least squares of its own free run where no tank is full."""
    low = level < NEARLY_FULL

    def left(p):
        return (two_tanks(pump, *np.abs(p)) - level)[low]

    fits = [least_squares(left, start, x_scale=start, diff_step=1e-4) for start in STARTS]
    return np.abs(min(fits, key=lambda fit: fit.cost).x)


def recording_of(pump, level, simulated):
    """Recording of one series."""
    return Recording.from_frame(
        {
            "time": STEP * np.arange(len(pump)),
            "command": 0.1 * pump,
            "flow": level,
            "simulated_flow": simulated,
        }
    )


def main(folder):
    """Print what is found, where, and the errors."""
    table = np.genfromtxt(Path(folder) / "dataBenchmark.csv", delimiter=",", names=True)
    found_on, tested_on = ((table[f"u{part}"], table[f"y{part}"]) for part in ("Est", "Val"))
    own = fitted(*found_on)
    series = [recording_of(u, y, two_tanks(u, *own)) for u, y in (found_on, tested_on)]
    began = time.perf_counter()
    finder = MissingPhysicsFinder().fit(series[0])
    seconds = time.perf_counter() - began
    found = finder.diagnosis_.to_dict()
    print(f"load {os.getloadavg()[0]:.1f}, {seconds:.0f} s")
    print(f"verdict {found['verdict']}, p {found['mismatch']['p_value']:.2g}")
    for effect in found["effects"]:
        print(f"- {', '.join(m['name'] for m in effect['members'])}: {effect['sentence']}")
    if "unknown" in found:
        print(f"- unknown, depends on {', '.join(found['unknown']['inputs'])}")
    for region in found["location"]["regions"]:
        print(f"- acts where {region['signal']} lies between {region['low']:.2f} and {region['high']:.2f}")
    print("| series | user's own | calibrated | corrected |")
    print("|---|---|---|---|")
    for name, recording in zip(("first, fitted", "second, test"), series, strict=True):
        made = [recording["simulated_flow"]]
        made += [s.predict(recording) for s in (finder.nominal_simulation_, finder.corrected_simulation_)]
        errors = " | ".join(f"{rmse(recording['flow'], flow):.3f}" for flow in made)
        print(f"| {name} | {errors} |")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
