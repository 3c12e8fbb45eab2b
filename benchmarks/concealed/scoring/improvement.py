# SPDX-License-Identifier: BSD-3-Clause
"""Whether the corrected simulation agrees with the truth without noise, on rows that were not used.

Errors are mean squares, as a share of the span squared, so that records can be added up.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.concealed.scoring.lines import of_kind
from benchmarks.concealed.scoring.rates import Estimate, Rate, rate_of, resampled

CHANNELS = ("flow", "opening")
# Harm is an rms error larger by this share and by this much of the span: less is no difference.
HARM, MATTERS = 0.05, 0.0005


def errors_of(line, channel):
    """Mean squares: nominal, corrected, oracle, floor; None where one of the first two is missing."""
    told = (line.get("errors") or {}).get(channel)
    if not isinstance(told, dict) or told.get("nominal") is None or told.get("corrected") is None:
        return None
    return {"oracle": None, "floor": 0.0} | told


def _all_errors(lines, channels):
    """Errors of each record, a list a record; records that tell of no channel are left out."""
    records = [[errors_of(line, c) for c in channels] for line in lines]
    return [known for record in records if (known := [e for e in record if e is not None])]


def skill(lines, channels=CHANNELS):
    """Pooled skill of records with effects of the catalogue.

    S* = (MSE_nominal - MSE_corrected) / (MSE_nominal - floor^2), each summed over the records (and channels);
    the floor is 0 against a truth without noise. Records that tell no errors are left out: `untold` counts
    them. The interval draws the records anew.
    """
    columns = []
    for record in _all_errors(of_kind(lines, "single", "pair"), channels):
        gain = sum(e["nominal"] - e["corrected"] for e in record)
        columns.append((gain, sum(e["nominal"] - (e["floor"] or 0.0) ** 2 for e in record)))
    return resampled(columns, lambda sums: sums[0] / sums[1])


def oracle_share(lines, channels=CHANNELS):
    """Share of the gain that the true structure, fitted to the same record, reaches."""
    columns = []
    for record in _all_errors(of_kind(lines, "single", "pair"), channels):
        known = [e for e in record if e["oracle"] is not None]
        if known:
            gain = sum(e["nominal"] - e["corrected"] for e in known)
            columns.append((gain, sum(e["nominal"] - e["oracle"] for e in known)))
    return resampled(columns, lambda sums: sums[0] / sums[1])


def harmed(errors):
    """Whether the corrected rms error is larger than the nominal one by more than does not matter."""
    nominal, corrected = np.sqrt(errors["nominal"]), np.sqrt(errors["corrected"])
    return bool(corrected > (1.0 + HARM) * nominal and corrected > nominal + MATTERS)


def no_harm(lines, channels=CHANNELS):
    """Of all records that tell errors, healthy ones too: no channel is worse than before."""
    return rate_of(not any(harmed(e) for e in record) for record in _all_errors(lines, channels))


def untold(lines, channels=CHANNELS):
    """Of records with effects of the catalogue: no errors are told, as where the diagnosis broke."""
    some = of_kind(lines, "single", "pair")
    return Rate(len(some) - len(_all_errors(some, channels)), len(some))


@dataclass(frozen=True)
class Improvement:
    """Figures of one channel, or of both."""

    channel: str
    skill: Estimate
    oracle: Estimate
    no_harm: Rate


def improvement(lines):
    """Rows of `Improvement`: flow, opening, both."""
    parts = [("flow", ("flow",)), ("opening", ("opening",)), ("both", CHANNELS)]
    return [
        Improvement(name, skill(lines, some), oracle_share(lines, some), no_harm(lines, some))
        for name, some in parts
    ]
