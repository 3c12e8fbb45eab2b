# SPDX-License-Identifier: BSD-3-Clause
"""The signature of a valve: opening against command, flow against opening at one pressure drop."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from sklvalve.report.displays.base import Diagnosed, Display, legend_above, traces_of
from sklvalve.report.drawing import COLOURS, thin
from sklvalve.report.signals import Signature, capacity_signature, travel_signature

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_NAMES = {"recorded": "recorded", "nominal": "before", "corrected": "after"}


class SignatureDisplay(Display):
    """Opening against command, and flow against opening, as recorded and as simulated before and after.

    Best made by `from_diagnosis` or `from_estimator`.

    Parameters
    ----------
    signatures : sequence of Signature
        One a panel; `Signature` has labels, ``x``, ``recorded``, ``nominal`` and ``corrected``.

    Attributes
    ----------
    ax_ : Axes or ndarray of Axes
        One a panel.
    figure_ : Figure

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.report import SignatureDisplay
    >>> from sklvalve.report.signals import Signature
    >>> command = np.linspace(0.0, 100.0, 50)
    >>> travel = Signature("command [%]", "opening [%]", command, command - 2.0, nominal=command)
    >>> SignatureDisplay([travel]).plot().ax_.get_ylabel()
    'opening [%]'
    """

    def __init__(self, signatures: Sequence[Signature]) -> None:
        self.signatures = list(signatures)

    @classmethod
    def from_diagnosis(cls, diagnosis: Diagnosed, *, ax: Any = None) -> Self:
        """Draw the signatures that the recording of a diagnosis tells.

        Opening against command where both were recorded; flow against opening (against the command where the
        opening was not recorded), divided by the root of the pressure drop in bar where that was recorded.

        Parameters
        ----------
        diagnosis : Diagnosis
        ax : Axes or sequence of Axes, default=None
            One a panel; a new figure where None.

        Raises
        ------
        ValueError
            If the diagnosis has no traces, or neither signature can be told.
        """
        traces = traces_of(diagnosis)
        told = (travel_signature(traces), capacity_signature(traces))
        return cls([signature for signature in told if signature is not None]).plot(ax)

    def plot(self, ax: Any = None, *, points: int = 900) -> Self:
        """Draw.

        Parameters
        ----------
        ax : Axes or sequence of Axes, default=None
            One a panel; a new figure where None.
        points : int, default=900
            Of so many rows, spread evenly, each panel is drawn.

        Raises
        ------
        ValueError
            If there is no panel, or not one Axes for each.
        """
        if not self.signatures:
            raise ValueError("there is nothing to draw: neither opening nor flow was recorded")
        count = len(self.signatures)
        for each, signature in zip(
            self._drawn_on(ax, count, (3.7, 3.3), columns=count), self.signatures, strict=True
        ):
            _draw(each, signature, points)
        return self


def _draw(ax: "Axes", signature: Signature, points: int) -> None:
    rows = thin(len(signature.x), points)
    for model, name in _NAMES.items():
        values = getattr(signature, model)
        if values is None:
            continue
        first = model == "recorded"
        ax.plot(
            signature.x[rows],
            np.asarray(values, dtype=float)[rows],
            linestyle="none",
            marker="o",
            markersize=2.8 if first else 1.6,
            markeredgewidth=0.0,
            color=COLOURS[model],
            alpha=0.45 if first else 0.9,
            label=name if model != "nominal" or signature.corrected is not None else "simulated",
        )
    ax.set_xlabel(signature.x_label)
    ax.set_ylabel(signature.y_label)
    legend_above(ax, columns=3, markerscale=2.5, handletextpad=0.1, columnspacing=1.2)
