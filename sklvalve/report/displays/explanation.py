# SPDX-License-Identifier: BSD-3-Clause
"""Explanations ranked: which effects a recording speaks for, how clearly, and what would tell them apart."""

from collections.abc import Sequence
from textwrap import fill
from typing import TYPE_CHECKING, Any, Protocol, Self

from sklvalve.report.displays.base import Diagnosed, Display, faint, ink
from sklvalve.report.drawing import COLOURS
from sklvalve.report.rows import Explanation, explanations
from sklvalve.report.words import chance, number, spoken

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# of a line of words below panels of 6.4 inch
_LETTERS = 72
# the distance at which a class ends: a chance of 3 % of taking one for the other
_TOLD_APART = 14.0


class Pair(Protocol):
    """Two effects, and how far they lie apart now and with the next test: one of `TestPlan.pairs`."""

    @property
    def names(self) -> tuple[str, str]: ...

    @property
    def now(self) -> float: ...

    @property
    def expected(self) -> float: ...


class ExplanationDisplay(Display):
    """Probability of each effect, found by found, the most probable first; and what would tell them apart.

    Best made by `from_diagnosis` or `from_estimator`.

    Parameters
    ----------
    classes : sequence of sequence of (str, float or None)
        For each thing found the effects that may be it, with their probabilities; None where not known.
    next_test : str, default=""
        What to do to tell them apart.
    pairs : sequence of Pair, default=()
        ``names`` of two effects, with the distance D between them ``now`` and as ``expected`` after the test,
        for a second panel; `sklvalve.mismatch.plan_next_test` gives them as ``pairs`` of its plan.

    Attributes
    ----------
    ax_ : Axes or ndarray of Axes
        Two with pairs, else one.
    figure_ : Figure

    Examples
    --------
    >>> from sklvalve.report import ExplanationDisplay
    >>> display = ExplanationDisplay([[("seat leakage", 0.61), ("an open bypass", 0.36)]])
    >>> [label.get_text() for label in display.plot().ax_.get_yticklabels()]
    ['seat leakage', 'an open bypass']
    """

    def __init__(
        self,
        classes: Sequence[Sequence[tuple[str, float | None]]],
        next_test: str = "",
        pairs: Sequence[Pair] = (),
    ) -> None:
        self.classes = [list(members) for members in classes]
        self.next_test = next_test
        self.pairs = list(pairs)

    @classmethod
    def from_diagnosis(cls, diagnosis: Diagnosed, *, plan: Any = None, ax: Any = None) -> Self:
        """Draw the explanations of a diagnosis.

        Parameters
        ----------
        diagnosis : Diagnosis
        plan : TestPlan, default=None
            As `sklvalve.mismatch.plan_next_test` gives it: its pairs are drawn, and its sentence stands in
            place of the diagnosis's own.
        ax : Axes or sequence of Axes, default=None
            Two with the pairs of a plan, else one; a new figure where None.
        """
        d = diagnosis.to_dict()
        told = (d.get("next_test") or "") if plan is None else plan.sentence
        pairs = () if plan is None else plan.pairs
        return cls([_members(item) for item in explanations(d)], told, pairs).plot(ax)

    def plot(self, ax: Any = None) -> Self:
        """Draw; where nothing was found this is said in words.

        Parameters
        ----------
        ax : Axes or sequence of Axes, default=None
            One a panel; a new figure where None, high enough for what to do next, which stands below.

        Raises
        ------
        ValueError
            If there is not one Axes for each panel.
        """
        lines = sum(map(len, self.classes)) + max(len(self.classes) - 1, 0)
        panels = 2 if self.pairs else 1
        height = 0.9 + 0.34 * max(lines, len(self.pairs), 1)
        told = fill(f"Next test: {self.next_test}", _LETTERS) if self.next_test else ""
        # the words get their own strip, so that they take no height from the bars
        first, *more = self._drawn_on(ax, panels, (6.4, height + _strip(told) / panels))
        self._draw_classes(first)
        for each in more:
            self._draw_pairs(each)
        if told and ax is None:
            self.figure_.supxlabel(told, x=0.02, horizontalalignment="left", fontsize="medium")
        elif told:
            last = more[-1] if more else first
            last.set_xlabel(f"{last.get_xlabel()}\n\n{told}")
        return self

    def _draw_classes(self, ax: "Axes") -> None:
        ax.set_xlim(0.0, 1.0)
        ax.set_xlabel("probability")
        if not self.classes:
            ax.text(0.5, 0.5, "no effect of the catalogue was found", ha="center", transform=ax.transAxes)
            ax.set_yticks([])
            return
        places, names, begin = [], [], 0
        for members in self.classes:
            here = [begin + k for k in range(len(members))]
            shares = [share for _, share in members]
            ax.barh(here, [1.0] * len(here), height=0.6, color=faint(), alpha=0.5)
            bars = ax.barh(here, [share or 0.0 for share in shares], height=0.6, color=COLOURS["corrected"])
            ax.bar_label(bars, [chance(share) for share in shares], padding=4)
            places += here
            names += [name for name, _ in members]
            # an empty line parts one thing found from the next
            begin += len(members) + 1
        ax.set_yticks(places, names)
        ax.invert_yaxis()
        ax.grid(visible=False)

    def _draw_pairs(self, ax: "Axes") -> None:
        """Distance of each pair now, and as expected with the test; dashed where a pair counts as told."""
        for place, pair in enumerate(self.pairs):
            ax.plot([pair.now, pair.expected], [place, place], color=COLOURS["corrected"], linewidth=1.2)
            ax.plot([pair.now], [place], "o", color=COLOURS["recorded"], label="" if place else "now")
            label = "" if place else "expected with the test"
            ax.plot([pair.expected], [place], "o", color=COLOURS["corrected"], label=label)
            words = f"{number(pair.now)} to {number(pair.expected)}"
            ax.annotate(
                words,
                (max(pair.now, pair.expected), place),
                (6.0, 0.0),
                textcoords="offset points",
                va="center",
            )
        ax.axvline(_TOLD_APART, color=ink(), linewidth=1.0, linestyle=(0, (4, 3)))
        names = [" or ".join(spoken(name) for name in pair.names) for pair in self.pairs]
        ax.set_yticks(range(len(names)), [fill(name, 34) for name in names])
        ax.set_ylim(len(names) - 0.5, -0.5)
        largest = max(max(pair.now, pair.expected) for pair in self.pairs)
        ax.set_xlim(0.0, 1.25 * max(largest, _TOLD_APART))
        ax.set_xlabel("separation of two explanations; dashed: told apart")
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 0.98), ncols=2, borderaxespad=0.0, frameon=False)
        ax.grid(visible=False)


def _strip(told: str) -> float:
    """Height that words take below the panels [inch]."""
    from matplotlib import rcParams

    lines = told.count("\n") + 1 if told else 0
    return 1.3 * lines * rcParams["font.size"] / 72.0


def _members(item: Explanation) -> list[tuple[str, float | None]]:
    return [(name, share) for name, share, _ in item.members]
