# SPDX-License-Identifier: BSD-3-Clause
"""What all displays share: where they come from, and the axes that they draw on."""

from typing import TYPE_CHECKING, Any, Protocol, Self

import numpy as np

from sklvalve.report.drawing import NO_MATPLOTLIB
from sklvalve.report.signals import as_shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Diagnosed(Protocol):
    """What is drawn: a `Diagnosis`."""

    @property
    def traces(self) -> dict: ...

    def to_dict(self) -> dict: ...


class Display:
    """A picture as numbers, drawn by `plot` as often as wanted.

    Attributes
    ----------
    ax_ : Axes or ndarray of Axes
        What was drawn on last: one Axes where there is one panel, else one for each.
    figure_ : Figure
    """

    ax_: Any
    figure_: Any

    @classmethod
    def from_diagnosis(cls, diagnosis: Diagnosed, *, ax: Any = None) -> Self:
        """Draw a diagnosis; each display says what of it."""
        raise NotImplementedError

    @classmethod
    def from_estimator(cls, estimator: Any, **settings: Any) -> Self:
        """Draw what a fitted `MissingPhysicsFinder` found.

        Parameters
        ----------
        estimator : MissingPhysicsFinder
        **settings
            As `from_diagnosis` takes them.

        Raises
        ------
        NotFittedError
            If it is not fitted.
        """
        from sklearn.utils.validation import check_is_fitted

        check_is_fitted(estimator, "diagnosis_")
        return cls.from_diagnosis(estimator.diagnosis_, **settings)

    def _drawn_on(
        self, ax: Any, count: int, size: tuple[float, float], *, columns: int = 1, same_x: bool = False
    ) -> list["Axes"]:
        """Axes for so many panels of a size [inch]: the caller's, or those of a new figure."""
        if ax is None:
            rows = -(-count // columns)
            figure, made = _pyplot().subplots(
                rows,
                columns,
                figsize=(size[0] * columns, size[1] * rows),
                squeeze=False,
                sharex=same_x,
                layout="constrained",
            )
            axes = list(made.flat)
        else:
            axes = list(np.ravel(np.asarray(ax, dtype=object)))
            if len(axes) != count:
                raise ValueError(f"ax must hold {count} axes, one a panel; got {len(axes)}")
            figure = axes[0].figure
        self.figure_ = figure
        self.ax_ = axes[0] if count == 1 else np.array(axes, dtype=object)
        return axes


def traces_of(diagnosis: Diagnosed) -> dict:
    """Traces of a diagnosis, flagged within the times that it names.

    Raises
    ------
    ValueError
        If it has none.
    """
    if not diagnosis.traces:
        raise ValueError(
            "expected a diagnosis with its traces, as MissingPhysicsFinder.fit makes it; this one has none "
            "(diagnosis.json does not hold them): fit again to draw it"
        )
    return as_shown(diagnosis.traces, diagnosis.to_dict().get("location") or {})


def ink() -> str:
    """Colour of lines that belong to no signal: that of the axes, so that a dark style is kept."""
    from matplotlib import rcParams

    return rcParams["axes.edgecolor"]


def faint() -> str:
    """Colour of lines that stand back: that of the grid."""
    from matplotlib import rcParams

    return rcParams["grid.color"]


def legend_above(ax: "Axes", columns: int = 2, **settings: Any) -> None:
    """A legend where it covers no row."""
    ax.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 0.98),
        ncols=columns,
        borderaxespad=0.0,
        frameon=False,
        **settings,
    )


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise ImportError(NO_MATPLOTLIB) from None
    return plt
