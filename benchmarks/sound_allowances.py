# SPDX-License-Identifier: BSD-3-Clause
"""Which allowances sound valves are likeliest with: how far a calibration moves from one hour to the next.

    python benchmarks/sound_allowances.py --records 30

Each pair is an hour of a sound valve and the recording after it, of both kinds of plant that
`healthy_reference` draws. Each says of the calibration what its rows say, to second order, and no more; what
the two differ by beyond that is what is allowed. Printed is the log likelihood of all pairs, and of the one
that likes it least, where one allowance is so many times its default and the others stand. Two seconds each.
"""

import argparse
from dataclasses import fields, replace

import numpy as np
from healthy_reference import draw

from sklvalve import ValveHistory
from sklvalve.history import Allowance
from sklvalve.history.posterior import FromSheet
from sklvalve.recording import InputError

TIMES = (0.25, 0.5, 1.0, 2.0, 4.0)
# first seeds of the two kinds of plant
PLAIN, NASTIER = 1000, 2000


class Pair:
    """What two recordings say of one calibration, in groups of channels."""

    def __init__(self, before, now):
        history = ValveHistory().fit([before, now])
        rows = np.cumsum([w.rows for w in history.windows_])
        self.split = 1 + int(np.searchsorted(rows, len(before)))
        if rows[self.split - 1] != len(before):
            raise InputError("a window of both recordings")
        self.history, self.groups = history, history._groups_

    def log_likelihood(self, allowance):
        """Of the changes between both, where so much is allowed."""
        return sum(self._of_group(k, allowance) for k in range(len(self.groups)))

    def _of_group(self, k, allowance):
        windows, group = self.history.windows_, self.groups[k]
        sheet = FromSheet.of(group.parameters, self.history.values_)
        each = [w.information[k] for w in windows]
        moves = np.average([i.moves for i in each], axis=0, weights=[w.rows for w in windows])
        change = np.linalg.inv(allowance.covariance(group.parameters, self.history.spans_, moves))
        first, second = (
            (sum(i.hessian for i in part), sum(i.pull for i in part))
            for part in (each[: self.split], each[self.split :])
        )
        # both calibrations at once: the first as the sheet expects it, the second beside the first
        prior = np.block([[np.diag(sheet.precision) + change, -change], [-change, change]])
        mean = np.tile(sheet.begin, 2)
        told, nothing = np.concatenate([first[1], second[1]]), np.zeros_like(change)
        both = prior + np.block([[first[0], nothing], [nothing, second[0]]])
        pull = told + prior @ mean
        size = np.linalg.slogdet(prior)[1] - np.linalg.slogdet(both)[1]
        return 0.5 * (size + pull @ np.linalg.solve(both, pull) - mean @ prior @ mean)


def pairs_of(records):
    """Pairs of both kinds of plant that a history can be learnt of."""
    for first, nastier in ((PLAIN, False), (NASTIER, True)):
        for seed in range(first, first + records):
            now, before, _ = draw(seed, history=True, nastier=nastier)
            try:
                yield Pair(before, now)
            except InputError as refused:
                print(f"{seed}: {refused}")


def main():
    """Draw, ask, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--records", type=int, default=30, help="pairs of each kind; 30")
    settings = parser.parse_args()
    pairs, allowed = list(pairs_of(settings.records)), Allowance()
    before = np.array([pair.log_likelihood(allowed) for pair in pairs])
    print(f"{len(pairs)} pairs: log likelihood beside that of the defaults, and of the pair that loses most")
    print(f"{'allowance':15}{'default':>10}" + "".join(f"{f'x {times:g}':>18}" for times in TIMES))
    for field in fields(Allowance):
        default, told = getattr(allowed, field.name), []
        for times in TIMES:
            other = replace(allowed, **{field.name: times * default})
            change = np.array([pair.log_likelihood(other) for pair in pairs]) - before
            told.append(f"{change.sum():10.1f} ({change.min():.1f})")
        print(f"{field.name:15}{default:10g}" + "".join(f"{each:>18}" for each in told))


if __name__ == "__main__":
    main()
