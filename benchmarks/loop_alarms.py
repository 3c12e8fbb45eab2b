# SPDX-License-Identifier: BSD-3-Clause
"""False alarms and power of `diagnose_loop` on loops drawn at random (`loop_plant.py`).

    python -m benchmarks.loop_alarms FIRST LAST [OUT.csv]

One loop a seed, from FIRST up to, not including, LAST: kind, scene and whether it sticks are drawn, and so is
what is known of it, a set-point in half of them and that the value is a flow in half of the flows. The tail
of the evidence of the healthy ones is what `sklvalve/mismatch/loop/constants.py` holds (seeds from 61000 and
61700 on); rates are measured on other seeds. Sticking loops count where the band is 25 % or more of the
command's span; a play of that size in a valve drawn as healthy counts as neither.
"""

import sys

import numpy as np
import pandas as pd

from benchmarks.loop_plant import HEALTHY, KINDS, draw_plant
from sklvalve.mismatch.loop import diagnose_loop
from sklvalve.recording import InputError, Recording

_MATTERS = 0.25


def recording_of(drawn, *, is_flow=None, setpoint=True):
    """A drawn loop as a recording; whether its value is known to be a flow is the kind's unless given."""
    is_flow = drawn.kind == "flow" if is_flow is None else is_flow
    time = drawn.sample_time * np.arange(len(drawn.command))
    columns = {"time": time, "command": drawn.command}
    columns["flow" if is_flow else "process_value"] = drawn.process_value
    if setpoint:
        columns["setpoint"] = drawn.setpoint
    return Recording.from_frame(columns)


def drawn_at(seed, *, plant=False):
    """The loop of a seed, whether it sticks, its recording, and the plant behind it if asked for."""
    rng = np.random.default_rng(seed)
    kind, scene = KINDS[rng.integers(len(KINDS))], HEALTHY[rng.integers(len(HEALTHY))]
    sticking = bool(rng.random() < 0.55) and scene != "small_play"
    setpoint, known = bool(rng.random() < 0.5), bool(rng.random() < 0.5)
    drawn, behind = draw_plant(seed, kind, scene, sticking)
    recording = recording_of(drawn, is_flow=known and kind == "flow", setpoint=setpoint)
    return (drawn, sticking, recording, behind) if plant else (drawn, sticking, recording)


def is_either(drawn, sticking):
    """Whether a loop counts neither as sticking nor as healthy, by the size of its band."""
    return sticking != (drawn.share >= _MATTERS)


def measured(seeds):
    """A row for each loop that is not refused."""
    for seed in seeds:
        drawn, sticking, recording = drawn_at(seed)
        if is_either(drawn, sticking):
            continue
        try:
            found = diagnose_loop(recording)
        except InputError:
            continue
        row = {
            "seed": seed, "kind": drawn.kind, "scene": drawn.scene, "form": drawn.form, "sticking": sticking,
            "share": drawn.share, "rows_a_period": drawn.rows_a_period, "setpoint": "setpoint" in recording,
            "known_flow": "flow" in recording, "verdict": found.verdict, "p": found.p_value,
            "evidence": found.evidence, "band": found.band,
        }  # fmt: skip
        if found.effects and drawn.stick > 0.0:
            row |= _kind(found.effects[0], drawn)
        yield row


def _kind(effect, drawn):
    """What was drawn and found of play and jump."""

    def holds(name, size):
        low, high = effect["parameters"][name]["ci95"]
        return low <= size <= high

    return {
        "jump": drawn.slip / drawn.stick,
        "names": "/".join(sorted(m["name"] for m in effect["members"])),
        "grade": effect["grade"]["level"],
        "found_of_band": effect["parameters"]["stick"]["value"] / drawn.stick,
        "band_held": holds("stick", drawn.stick),
        "jump_held": holds("slip", drawn.slip),
    }


def main(first, last, out=None):
    """Print rates; write every loop to OUT."""
    table = pd.DataFrame(list(measured(range(first, last))))
    if out:
        table.to_csv(out, index=False)
    table["called"], table["excluded"] = table.verdict == "named", table.verdict == "no_mismatch"
    table["rows"] = pd.cut(table.rows_a_period, [5, 10, 20, 50, 100, 200, 500], include_lowest=True)
    for sticking, rows in table.groupby("sticking"):
        name = "sticking" if sticking else "healthy"
        print(f"{name}: {rows.called.sum()} of {len(rows)} called sticking, {rows.excluded.sum()} excluded")
        for by in ("kind", "scene", "form", "setpoint", "rows"):
            print(rows.groupby(by, observed=True).called.agg(["sum", "size"]).T.to_string())
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
