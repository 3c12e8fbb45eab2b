# SPDX-License-Identifier: BSD-3-Clause
"""How far the signals of a sound valve change between two hours: what `Allowance.response` is taken from.

    python benchmarks/sound_scatter.py --records 60
    python benchmarks/sound_scatter.py --records 60 --first 2000 --nastier

A simulation is calibrated on an hour of a sound valve, and on the recording after it, each with nothing but
the data sheet. Both simulate the recording: how far apart they are is the scatter, rms, in percent of travel
and of the flow's span. Six seconds a record.
"""

import argparse

import numpy as np
from healthy_reference import draw

from sklvalve import ValveHistory
from sklvalve.history.then import simulation_then
from sklvalve.recording import InputError
from sklvalve.simulation.calibration import spans_of


def scatter_of(before, now):
    """Channel -> rms difference of the two simulations of one recording, share of its span."""
    two = [ValveHistory().fit([recording]) for recording in (before, now)]
    first, second = (simulation_then(each).simulate(now) for each in two)
    spans = spans_of(now, two[0].channels)
    return {c: float(np.sqrt(np.nanmean((first[c] - second[c]) ** 2)) / spans[c]) for c in two[0].channels}


def main():
    """Draw, calibrate twice, print quantiles."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--records", type=int, default=60)
    parser.add_argument("--first", type=int, default=1000)
    parser.add_argument(
        "--nastier", action="store_true", help="noise of kinds that the reference has none of"
    )
    settings = parser.parse_args()
    found = {}
    for seed in range(settings.first, settings.first + settings.records):
        now, before, told = draw(seed, nastier=settings.nastier, history=True)
        pressures = "a pressure lacks" if {"P1", "P2"} & set(told["lacks"]) else "both pressures"
        try:
            scatter = scatter_of(before, now)
        except InputError as refused:
            print(f"{seed}: {refused}")
            continue
        for channel, share in scatter.items():
            of = pressures if channel == "flow" else ""
            found.setdefault((channel, told["loop"], of), []).append(100.0 * share)
    print(f"{'channel':10}{'loop':10}{'':20}{'records':>8}{'median %':>10}{'largest %':>10}")
    for (channel, loop, of), shares in sorted(found.items()):
        row = f"{channel:10}{loop:10}{of:20}{len(shares):8d}"
        print(f"{row}{np.median(shares):10.3f}{max(shares):10.3f}")


if __name__ == "__main__":
    main()
