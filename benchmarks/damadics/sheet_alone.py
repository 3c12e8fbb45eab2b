# SPDX-License-Identifier: BSD-3-Clause
"""How often the finder alarms on sound runs that are held against the data sheet alone.

    python -m benchmarks.damadics.sheet_alone [SEEDS]

The package's own simulation of positioner and actuator, calibrated within the tolerances of a sheet, against
sound runs of 20 minutes: as it is; told of the push of the fluid on the stem; and with 6 s and 3 % of travel
left open for its response and static error in place of 3 s and 1 %. No name is right there: what is found is
what the benchmark's actuator has and a data sheet does not tell.
"""

import sys
import time

from sklvalve import MissingPhysicsFinder, Recording, Valve
from sklvalve.damadics import make_damadics, valve_sheet
from sklvalve.mismatch import CATALOGUE
from sklvalve.simulation import Tolerance, ValveSimulation

_STEM_LOAD = tuple(effect for effect in CATALOGUE if effect.key == "stem_load")
TOLD = {
    "sheet": {},
    "sheet and stem load": {"simulation": ValveSimulation(effects=_STEM_LOAD)},
    "sheet, wider": {"tolerance": Tolerance(response=6.0, static_error=0.03)},
}
_SETTLES, _LASTS = 300, 1500.0


def main(seeds):
    """Print a line for each sound run."""
    valve = Valve.from_dict(valve_sheet())
    print("| told | seed | verdict | named | opening error, nominal | corrected | s |")
    print("|---|---|---|---|---|---|---|")
    for told, parameters in TOLD.items():
        for seed in range(401, 401 + seeds):
            frame = make_damadics(None, duration=_LASTS, random_state=seed).iloc[_SETTLES:]
            began = time.process_time()
            finder = MissingPhysicsFinder(n_jobs=1, **parameters).fit(Recording.from_frame(frame, valve))
            found = finder.diagnosis_.to_dict()
            named = " + ".join("/".join(names) for names in finder.diagnosis_.effects) or "-"
            error = found["fit"]["opening"]["rmse"]
            errors = f"{error['nominal']:.2f} % | {error['corrected']:.2f} %"
            seconds = time.process_time() - began
            print(
                f"| {told} | {seed} | {found['verdict']} | {named} | {errors} | {seconds:.0f} |", flush=True
            )


if __name__ == "__main__":
    asked = sys.argv[1] if len(sys.argv) > 1 else "5"
    if not asked.isdecimal():
        sys.exit(f"Expected a number of seeds, got {asked!r}.")
    main(int(asked))
