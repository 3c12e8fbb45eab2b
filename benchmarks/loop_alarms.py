# SPDX-License-Identifier: BSD-3-Clause
"""False alarms and power of `diagnose_loop` on loops drawn at random (`loop_plant.py`).

    python -m benchmarks.loop_alarms FIRST LAST [OUT.csv]

Seeds from FIRST up to, not including, LAST, for each process and each scene, healthy and sticking. The tail
of the evidence of the healthy ones is what `sklvalve/mismatch/loop/evidence.py` holds (seeds 10000 to 10029);
rates are measured on other seeds. Sticking loops count where the band is 25 % or more of the command's span.
Of all called sticking the kinds are told, by the jump's share of the band, and how often intervals hold.
"""

import sys

import numpy as np
import pandas as pd

from benchmarks.loop_plant import HEALTHY, KINDS, draw_loop
from sklvalve.mismatch.loop import diagnose_loop
from sklvalve.recording import InputError, Recording


def recording_of(drawn):
    """A drawn loop as a recording."""
    role = "flow" if drawn.kind == "flow" else "process_value"
    time = 10.0 * np.arange(len(drawn.command))
    columns = {"time": time, "command": drawn.command, role: drawn.process_value, "setpoint": drawn.setpoint}
    return Recording.from_frame(columns)


def measured(seeds, sticking):
    """A row for each loop that is not refused."""
    for seed in seeds:
        rows = (500, 750, 750, 1000)[seed % 4]
        for kind in KINDS:
            for scene in HEALTHY:
                if sticking and scene == "small_play":
                    continue
                drawn = draw_loop(seed, kind, scene, sticking, rows)
                try:
                    found = diagnose_loop(recording_of(drawn))
                except InputError:
                    continue
                yield {
                    "seed": seed, "kind": kind, "scene": scene, "sticking": sticking, "share": drawn.share,
                    "verdict": found.verdict, "p": found.p_value, "evidence": found.evidence,
                    "band": found.band, **_kind(found, drawn),
                }  # fmt: skip


def _kind(found, drawn):
    """What was drawn and told of play and jump."""
    if not (found.effects and drawn.stick > 0.0):
        return {}
    effect = found.effects[0]

    def holds(name, size):
        low, high = effect["parameters"][name]["ci95"]
        return low <= size <= high

    return {
        "jump": drawn.slip / drawn.stick,
        "names": "/".join(sorted(m["name"] for m in effect["members"])),
        "found_of_band": effect["parameters"]["stick"]["value"] / drawn.stick,
        "band_held": holds("stick", drawn.stick),
        "jump_held": holds("slip", drawn.slip),
    }


def main(first, last, out=None):
    """Print rates; write every loop to OUT."""
    table = pd.DataFrame(
        [row for sticking in (False, True) for row in measured(range(first, last), sticking)]
    )
    if out:
        table.to_csv(out, index=False)
    table["called"] = table.verdict == "named"
    healthy, ill = table[~table.sticking], table[table.sticking & (table.share >= 0.25)]
    for name, rows in (("healthy", healthy), ("sticking", ill)):
        print(f"{name}: {rows.called.sum()} of {len(rows)} called sticking")
        print(rows.groupby(["scene", "kind"]).called.mean().unstack().round(3).to_string())
    print(healthy.groupby("kind").p.agg(lambda p: (p <= 0.05).mean()).to_string())
    if "jump" in table:
        named = table[table.sticking & table.called]
        shares = pd.cut(named.jump, [0.0, 0.1, 0.2, 1.0], include_lowest=True)
        print(named.groupby([shares, "names"], observed=True).size().to_string())
        print(
            f"{len(named)} called: band found / drawn {named.found_of_band.median():.2f}, intervals hold "
            f"the band in {named.band_held.sum():.0f}, the jump in {named.jump_held.sum():.0f}"
        )


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(int(sys.argv[1]), int(sys.argv[2]), *sys.argv[3:])
