# SPDX-License-Identifier: BSD-3-Clause
"""The one table: every figure, its target, a column a method."""

from collections.abc import Callable
from dataclasses import dataclass

from benchmarks.concealed.report.markdown import table
from benchmarks.concealed.scoring import (
    calibration,
    cost,
    detection,
    honesty,
    improvement,
    naming,
    parameters,
    place,
    sets,
)
from benchmarks.concealed.scoring.lines import by_method, distinguishable_only

# Onsets and parameters are promised at this size, in times of the detectable one.
LARGE = 3.0


@dataclass(frozen=True)
class Figure:
    """A row of the table.

    Attributes
    ----------
    label : str
    of : callable
        Lines -> Rate, Estimate, or anything that tells itself as text.
    low, high : float or None
        Ends of what was aimed at, as the figure's own value.
    percent : bool
        Whether the target is told in percent.
    """

    label: str
    of: Callable
    low: float | None = None
    high: float | None = None
    percent: bool = True

    @property
    def target(self):
        """What was aimed at, in words."""
        tell = (lambda v: f"{100.0 * v:g} %") if self.percent else (lambda v: f"{v:g}")
        if self.low is not None and self.high is not None:
            return f"{tell(self.low)} to {tell(self.high)}"
        if self.low is not None:
            return f"at least {tell(self.low)}"
        return "" if self.high is None else f"at most {tell(self.high)}"

    def met(self, value):
        """Whether a value is what was aimed at; None where nothing was, or there is no value."""
        if (self.low is None and self.high is None) or value != value:
            return None
        return (self.low is None or value >= self.low) and (self.high is None or value <= self.high)

    def cell(self, lines):
        """The figure as text with the number of records; bold where the target is met."""
        figure = self.of(lines)
        if str(figure) == "-":
            return "-"
        text = f"{figure} of {figure.of}"
        return f"**{text}**" if self.met(getattr(figure, "value", float("nan"))) else text


def _clear(figure, *arguments):
    """The figure of what the generator calls distinguishable."""
    return lambda lines: figure(distinguishable_only(lines), *arguments)


def _sized(figure, size):
    """The figure of records of one planned size."""
    return lambda lines: figure(lines, size)


NULLS = (
    Figure("alarms on healthy records", detection.alarms, high=0.025),
    Figure("p-value below alpha on healthy records", detection.rejected),
    Figure("p-values uniform (Kolmogorov-Smirnov p)", detection.uniformity, low=0.05, percent=False),
    Figure("anything concealed: a mismatch is told", detection.detected),
    Figure(
        "a mismatch is told, one effect of the size that can just be told",
        _sized(detection.detected, 1.0),
        low=0.85,
    ),
    Figure("- twice as large", _sized(detection.detected, 2.0), low=0.95),
    Figure("- three times as large", _sized(detection.detected, LARGE)),
)
NAMES = (
    Figure("class right, distinguishable", _clear(naming.class_right), low=0.9),
    Figure("- names in the right class", _clear(naming.mean_class_size), high=3.0, percent=False),
    Figure("- held by a class, whatever is named beside it", _clear(naming.class_holds)),
    Figure("- most probable name right, whatever the verdict", _clear(naming.top, 1)),
    Figure("- among the first three names", _clear(naming.top, 3), low=0.97),
    Figure("- class right, mean over effects", _clear(naming.macro_right)),
    Figure("class right, all with one effect", naming.class_right),
    Figure("- names in the right class", naming.mean_class_size),
    Figure("- most probable name right", lambda lines: naming.top(lines, 1)),
    Figure("- among the first three names", lambda lines: naming.top(lines, 3)),
    Figure("- class right, mean over effects", naming.macro_right),
    Figure("not distinguishable, by the generator", naming.not_distinguishable),
    Figure("wrong name, of all records", naming.wrong_name, high=0.03),
    Figure("- of them mere candidates (`cannot_tell`)", naming.wrong_candidate),
    Figure("cannot tell, of all with anything concealed", naming.abstention),
    Figure("useful and true less twice wrong", naming.useful_and_true),
)
SETS = (
    Figure("pairs: both found, nothing wrong", sets.exact_set, low=0.6),
    Figure("pairs: at least one found", sets.at_least_one, low=0.95),
    Figure("things named that are true (precision)", sets.precision),
    Figure("things there that are named (recall)", sets.recall),
    Figure("F1 of the two", sets.f1),
    Figure("of no catalogue: `none_of_these` and no name", sets.flagged, low=0.8),
    Figure("- `cannot_tell` and no name", sets.left_undecided),
    Figure("- called by a name", sets.misnamed),
    Figure("of the catalogue: `none_of_these`", sets.falsely_flagged, high=0.05),
)
PLACE = (
    Figure("block: the true ones among those told", place.blocks_hold, low=0.98),
    Figure("- exactly the true ones", place.blocks_exact),
    Figure("- blocks told", place.blocks_told),
    Figure("rows flagged, F1", lambda lines: place.region(lines).f1, low=0.85, percent=False),
    Figure("- intersection over union", lambda lines: place.region(lines).iou, low=0.7, percent=False),
    Figure("- F1 of flagging all rows", lambda lines: place.region(lines).everywhere),
    Figure("rows inside the regions told, F1", lambda lines: place.region(lines, "boxes").f1),
    Figure("onset within 1 % of the record, abrupt, size 3", _sized(place.onset_near, LARGE), low=1.0),
    Figure("- median error", _sized(place.onset_median, LARGE), high=0.01),
    Figure("- an onset is told", _sized(place.onset_told, LARGE)),
    Figure("onset within 1 %, abrupt, all sizes", place.onset_near),
    Figure("onset told, but it was there from the start", place.onset_invented),
    Figure("95 % interval of the onset holds it", place.onset_coverage),
    Figure("time told, intersection over union", place.interval_overlap),
)
SIZES = (
    Figure(
        "main parameter, median error, size 3",
        lambda lines: parameters.accuracy(lines, LARGE).median,
        high=0.15,
    ),
    Figure("- nine in ten below, size 3", lambda lines: parameters.accuracy(lines, LARGE).ninth),
    Figure("- median error, all sizes", lambda lines: parameters.accuracy(lines).median),
    Figure("95 % interval holds it", lambda lines: parameters.accuracy(lines).coverage, low=0.9, high=0.98),
)
AGREES = (
    Figure("pooled skill on the truth without noise", improvement.skill, low=0.9, percent=False),
    Figure("- flow", lambda lines: improvement.skill(lines, ("flow",))),
    Figure("- opening", lambda lines: improvement.skill(lines, ("opening",))),
    Figure("share of the gain of the true structure", improvement.oracle_share, low=0.95, percent=False),
    Figure("no channel made worse, all records", improvement.no_harm),
    Figure("errors not told, of the catalogue", improvement.untold),
)
TRUST = (
    Figure("probability of a class, Brier score", lambda lines: calibration.calibration(lines).brier),
    Figure("- log score", lambda lines: calibration.calibration(lines).log_score),
    Figure(
        "probability of a class, expected calibration error",
        lambda lines: calibration.calibration(lines).expected_error,
        high=0.05,
        percent=False,
    ),
    Figure("D below 6: told as open", honesty.told_open),
    Figure("D above 20: answered by name", honesty.answered),
    Figure("- by true names alone", honesty.one_name),
)
COST = (
    Figure("seconds a record, median", cost.cost),
    Figure("memory a record [MB], median", lambda lines: cost.cost(lines, "peak_mb")),
    Figure("refused as bad input", naming.refusals),
    Figure("the diagnosis broke", naming.breaks),
)
FIGURES = NULLS + NAMES + SETS + PLACE + SIZES + AGREES + TRUST + COST


def headline(lines, figures=FIGURES):
    """Table of all figures, a column a method, the targets beside them; bold is what meets its target.

    Parameters
    ----------
    lines : list of dict
        Of any number of methods.
    figures : iterable of Figure

    Returns
    -------
    text : str
        Markdown.
    """
    methods = by_method(lines)
    rows = [[f.label, f.target, *(f.cell(some) for some in methods.values())] for f in figures]
    return table(["", "aimed at", *methods], rows)
