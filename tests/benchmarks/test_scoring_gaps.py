# SPDX-License-Identifier: BSD-3-Clause
"""Whatever a line leaves out, every table is made of the rest."""

import copy

import pytest

from benchmarks.concealed.report.curves import power_curve, reliability_curve
from benchmarks.concealed.report.headline import FIGURES
from benchmarks.concealed.report.trial import report

WHOLE = {
    "record": "record_0001",
    "folder": "set",
    "method": "sklvalve",
    "code": "abc",
    "seconds": 9.0,
    "peak_mb": 480.0,
    "load": 1.0,
    "found": {
        "verdict": "named",
        "mismatch": {"detected": True, "p_value": 0.001, "alpha": 0.01},
        "location": {
            "blocks": ["valve"],
            "regions": [],
            "onset": 1200.0,
            "onset_ci95": [1190.0, 1210.0],
            "intervals": [[1200.0, 3599.0]],
        },
        "effects": [
            {
                "members": [
                    {"name": "erosion", "probability": 0.9},
                    {"name": "clogging", "probability": 0.06},
                ],
                "probability": 0.96,
                "blocks": ["valve"],
                "parameters": {"rate": {"value": 0.1, "unit": "1/h", "ci95": [0.08, 0.12]}},
                "onset": 1200.0,
            }
        ],
    },
    "rows": {"told": [[1200, 3600]], "boxes": [[1000, 3600]], "true": [[1201, 3600]], "of": 3600},
    "errors": {
        "flow": {"nominal": 1e-3, "corrected": 1e-5, "oracle": 5e-6, "floor": 0.0},
        "opening": {"nominal": 1e-4, "corrected": 1e-4, "oracle": 1e-4, "floor": 0.0},
    },
    "truth": {
        "kind": "single",
        "verdict": "named",
        "effects": ["erosion"],
        "concealed": ["erosion"],
        "blocks": ["valve"],
        "onset": 1201.0,
        "abrupt": True,
        "intervals": [[1201.0, 3599.0]],
        "parameters": {"erosion": {"parameter": "rate", "value": 0.11, "unit": "1/h"}},
        "excitation": "wide",
        "nasty": ["wander"],
        "size_step": 3.0,
        "rows": 3600,
        "distances": {"nothing": 225.0, "others": {"clogging": 40.0}},
        "distinguishable": True,
        "class": ["erosion"],
    },
}
# Told of healthy records, other sizes, pairs, no catalogue, effects from the start, and what is left open.
OF_OTHER_RECORDS = [
    "alarms on healthy records",
    "p-value below alpha on healthy records",
    "p-values uniform (Kolmogorov-Smirnov p)",
    "a mismatch is told, one effect of the size that can just be told",
    "- twice as large",
    "pairs: both found, nothing wrong",
    "pairs: at least one found",
    "of no catalogue: `none_of_these` and no name",
    "- `cannot_tell` and no name",
    "- called by a name",
    "onset told, but it was there from the start",
    "D below 6: told as open",
]
# A member without a name is no member, and a truth is what a line is for.
NEEDED = {("truth",), *(("found", "effects", 0, "members", i, "name") for i in (0, 1))}


def paths(value, at=()):
    """Every key on the way down, but those that are needed and what lists of numbers hold."""
    keys = value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    for key in keys:
        here = (*at, key)
        if isinstance(value, dict) and here not in NEEDED:
            yield here
        yield from paths(value[key], here)


def without(path, *, none=False):
    """The whole line but for one key, or with None there."""
    line = copy.deepcopy(WHOLE)
    place = line
    for key in path[:-1]:
        place = place[key]
    if none:
        place[path[-1]] = None
    else:
        del place[path[-1]]
    return line


def test_a_whole_line_fills_all_it_can():
    empty = [figure.label for figure in FIGURES if figure.cell([WHOLE]) == "-"]
    assert empty == OF_OTHER_RECORDS
    assert "record_0001" not in report([WHOLE])


@pytest.mark.parametrize("none", [False, True])
def test_every_key_may_be_missing(none):
    for path in paths(WHOLE):
        line = without(path, none=none)
        text = report([line])  # without a method it is this package's
        assert text.startswith("|  | aimed at | sklvalve |"), path


def test_curves_of_a_line_without_probability_or_size(tmp_path):
    pytest.importorskip("matplotlib")
    assert not reliability_curve([without(("found",))], tmp_path / "a.png")
    assert not power_curve([without(("truth", "size_step"))], tmp_path / "a.png")
