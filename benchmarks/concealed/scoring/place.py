# SPDX-License-Identifier: BSD-3-Clause
"""Whether it is where, and began when, the diagnosis says.

Asked of records in which something is concealed and a mismatch is told; what is missed is counted by
`detection`, not here again.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.concealed.scoring.lines import (
    location_of,
    of_kind,
    size_step,
    told_mismatch,
)
from benchmarks.concealed.scoring.rates import Estimate, mean_of, quantile_of, rate_of

NEAR = 0.01  # of the record
# an onset that is not told counts as wrong by the whole record
_NOT_TOLD = 1.0


def _told(lines, *kinds):
    return [line for line in of_kind(lines, *(kinds or ("single", "pair"))) if told_mismatch(line)]


# ---- blocks


def _blocks(line):
    return set(line["truth"].get("blocks") or ()), set(location_of(line).get("blocks") or ())


def blocks_hold(lines):
    """Every true block is among those told."""
    pairs = [_blocks(line) for line in _told(lines)]
    return rate_of(true <= told for true, told in pairs if true)


def blocks_exact(lines):
    """The blocks told are the true ones and no other."""
    pairs = [_blocks(line) for line in _told(lines)]
    return rate_of(true == told for true, told in pairs if true)


def blocks_told(lines):
    """Mean number of blocks told; without it `blocks_hold` says nothing, for all four hold everything."""
    return mean_of([len(told) for true, told in map(_blocks, _told(lines)) if true], digits=1)


# ---- rows


def mask(spans, rows):
    """Rows within any of the spans [begin, end), as booleans."""
    inside = np.zeros(int(rows), dtype=bool)
    for begin, end in spans:
        inside[max(int(begin), 0) : max(int(end), 0)] = True
    return inside


def overlap(told, true):
    """F1 and intersection over union of two masks; None where nothing is true."""
    common, union = np.sum(told & true), np.sum(told | true)
    if not true.any():
        return None
    return 2.0 * common / (np.sum(told) + np.sum(true)), common / union


@dataclass(frozen=True)
class Region:
    """How the rows told overlap the true ones: means over records.

    Attributes
    ----------
    f1, iou : Estimate
    everywhere : Estimate
        F1 of telling all rows of the same records, which is no art.
    """

    f1: Estimate
    iou: Estimate
    everywhere: Estimate


def region(lines, which="told"):
    """Overlap of rows with those in which the effect acts.

    Parameters
    ----------
    lines : list of dict
    which : {"told", "boxes"}
        Rows flagged as acting, or rows inside the regions and intervals told.

    Returns
    -------
    region : Region
        Of records that tell these rows and have a row in which the effect acts.
    """
    seen = []
    for line in _told(lines):
        rows = line.get("rows") or {}
        if rows.get(which) is None or not rows.get("true"):
            continue
        many = rows.get("of") or max(end for _, end in [*rows["true"], *rows[which]])
        true = mask(rows["true"], many)
        pair = overlap(mask(rows[which], many), true)
        if pair is not None:
            seen.append((*pair, overlap(np.ones_like(true), true)[0]))
    return Region(*(mean_of([row[i] for row in seen]) for i in range(3)))


# ---- times


def duration(line):
    """Length of the record [s]: as told, or rows times ``sample_time``, or to the end of the last interval.

    Rows are taken for seconds where the truth tells no ``sample_time``, unless an interval ends later.
    """
    truth = line["truth"]
    if truth.get("duration"):
        return float(truth["duration"])
    rows = truth.get("rows") or (line.get("rows") or {}).get("of") or 0
    ends = [float(end) for _, end in truth.get("intervals") or ()]
    return max([rows * float(truth.get("sample_time") or 1.0), *ends]) or None


def onset_error(line):
    """Distance of the onset told from the true one, as a share of the record; infinite where none is told.

    None where the effect is not abrupt, was there from the start, or the length is not known.
    """
    truth, seconds = line["truth"], duration(line)
    if not truth.get("abrupt") or not truth.get("onset") or seconds is None:
        return None
    told = location_of(line).get("onset")
    return float("inf") if told is None else abs(told - truth["onset"]) / seconds


def _abrupt(lines, step):
    some = [line for line in _told(lines) if step is None or size_step(line) == step]
    return [error for line in some if (error := onset_error(line)) is not None]


def onset_near(lines, step=None):
    """Of abrupt effects (of one planned size): onset within 1 % of the record; one not told is not near."""
    return rate_of(error <= NEAR for error in _abrupt(lines, step))


def onset_median(lines, step=None):
    """Median error of the onset of abrupt effects; one that is not told is wrong by the whole record."""
    errors = [error if np.isfinite(error) else _NOT_TOLD for error in _abrupt(lines, step)]
    return quantile_of(errors, unit="%", digits=1)


def onset_told(lines, step=None):
    """Of abrupt effects: an onset is told."""
    return rate_of(np.isfinite(error) for error in _abrupt(lines, step))


def onset_invented(lines):
    """Of effects there from the start: an onset is told all the same."""
    some = [line for line in _told(lines) if line["truth"].get("onset") == 0.0]
    return rate_of(location_of(line).get("onset") is not None for line in some)


def onset_coverage(lines):
    """Of onsets told with an interval where there is one: the 95 % interval holds it."""
    answers = []
    for line in _told(lines):
        ends, true = location_of(line).get("onset_ci95"), line["truth"].get("onset")
        if ends and true:
            answers.append(ends[0] <= true <= ends[1])
    return rate_of(answers)


def interval_overlap(lines):
    """Intersection over union of the time told with the true time, meant over records that tell both."""
    return mean_of([_interval_overlap(line) for line in _told(lines)])


def _interval_overlap(line):
    told, true = location_of(line).get("intervals"), line["truth"].get("intervals")
    if told is None or not true:
        return None
    edges = np.unique([float(end) for span in [*told, *true] for end in span])
    middles, lengths = (edges[1:] + edges[:-1]) / 2.0, np.diff(edges)
    inside = [np.any([(a <= middles) & (middles <= b) for a, b in spans], axis=0) for spans in (told, true)]
    either = np.sum(lengths[inside[0] | inside[1]])
    return float(np.sum(lengths[inside[0] & inside[1]]) / either) if either > 0.0 else None
