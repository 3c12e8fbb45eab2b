# SPDX-License-Identifier: BSD-3-Clause
"""Explanations ranked: which effects a recording speaks for, and how clearly."""

from collections.abc import Sequence
from typing import Any, Self

from sklvalve.report.displays.base import Diagnosed, Display, faint
from sklvalve.report.drawing import COLOURS
from sklvalve.report.rows import Explanation, explanations
from sklvalve.report.words import chance


class ExplanationDisplay(Display):
    """Probability of each effect, found by found, the most probable first.

    Best made by `from_diagnosis` or `from_estimator`.

    Parameters
    ----------
    classes : sequence of sequence of (str, float)
        For each thing found the effects that may be it, with their probabilities.

    Attributes
    ----------
    ax_ : Axes
    figure_ : Figure

    Examples
    --------
    >>> from sklvalve.report import ExplanationDisplay
    >>> display = ExplanationDisplay([[("seat leakage", 0.61), ("an open bypass", 0.36)]])
    >>> [label.get_text() for label in display.plot().ax_.get_yticklabels()]
    ['seat leakage', 'an open bypass']
    """

    def __init__(self, classes: Sequence[Sequence[tuple[str, float]]]) -> None:
        self.classes = [list(members) for members in classes]

    @classmethod
    def from_diagnosis(cls, diagnosis: Diagnosed, *, ax: Any = None) -> Self:
        """Draw the explanations of a diagnosis.

        Parameters
        ----------
        diagnosis : Diagnosis
        ax : Axes, default=None
            A new figure where None.
        """
        return cls([_members(item) for item in explanations(diagnosis.to_dict())]).plot(ax)

    def plot(self, ax: Any = None) -> Self:
        """Draw; where nothing was found this is told in words.

        Parameters
        ----------
        ax : Axes, default=None
            A new figure where None.
        """
        lines = sum(map(len, self.classes)) + max(len(self.classes) - 1, 0)
        ax = self._drawn_on(ax, 1, (6.4, 0.9 + 0.34 * max(lines, 1)))[0]
        ax.set_xlim(0.0, 1.0)
        ax.set_xlabel("probability")
        if not self.classes:
            ax.text(0.5, 0.5, "no effect of the catalogue was found", ha="center", transform=ax.transAxes)
            ax.set_yticks([])
            return self
        places, names, begin = [], [], 0
        for members in self.classes:
            here = [begin + k for k in range(len(members))]
            shares = [share for _, share in members]
            ax.barh(here, [1.0] * len(here), height=0.6, color=faint(), alpha=0.5)
            bars = ax.barh(here, shares, height=0.6, color=COLOURS["corrected"])
            ax.bar_label(bars, [chance(share) for share in shares], padding=4)
            places += here
            names += [name for name, _ in members]
            # an empty line parts one thing found from the next
            begin += len(members) + 1
        ax.set_yticks(places, names)
        ax.invert_yaxis()
        ax.grid(visible=False)
        return self


def _members(item: Explanation) -> list[tuple[str, float]]:
    return [(name, share) for name, share, _ in item.members]
