# SPDX-License-Identifier: BSD-3-Clause
"""Where the flow deviates: its mean residual by opening and pressure ratio, before and after."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sklvalve.report import signals
from sklvalve.report.displays.base import Diagnosed, Display, faint, ink, traces_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RATIO_LABEL = "pressure ratio dp / (p1 - FF pv)"
_HEADINGS = {"nominal": "before", "corrected": "after"}


class ResidualMapDisplay(Display):
    """Mean residual by two signals, one panel a model, on one scale.

    Best made by `from_diagnosis`, `from_estimator` or `from_predictions`.

    Parameters
    ----------
    x_edges, y_edges : ndarray of shape (n_columns + 1,), (n_rows + 1,)
    means : dict of ndarray of shape (n_columns, n_rows)
        Recorded minus simulated, by model, ``nominal`` first; NaN is an empty bin.
    flagged : ndarray of bool of shape (n_columns, n_rows)
        Bins to be outlined.
    x_label, y_label, label : str
        Of the two signals, and of the residual.

    Attributes
    ----------
    limit : float
        Size of residual at the ends of the scale: 98 % of the bins before the correction lie within.
    ax_ : Axes or ndarray of Axes
        One a panel.
    figure_ : Figure

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.report import ResidualMapDisplay
    >>> rng = np.random.default_rng(0)
    >>> opening, ratio = rng.uniform(0.0, 100.0, 2000), rng.uniform(0.2, 0.8, 2000)
    >>> display = ResidualMapDisplay.from_predictions(
    ...     opening, ratio, y_true=0.1 * opening + (ratio > 0.6), y_pred=0.1 * opening, label="flow [m3/h]"
    ... )
    >>> round(display.limit, 2)
    1.0
    """

    def __init__(
        self,
        x_edges: NDArray[np.float64],
        y_edges: NDArray[np.float64],
        means: dict[str, NDArray[np.float64]],
        flagged: NDArray[np.bool_],
        *,
        x_label: str = "opening [%]",
        y_label: str = RATIO_LABEL,
        label: str = "recorded minus simulated",
    ) -> None:
        self.x_edges, self.y_edges, self.means, self.flagged = x_edges, y_edges, means, flagged
        self.x_label, self.y_label, self.label = x_label, y_label, label
        sizes = np.abs(means["nominal"][np.isfinite(means["nominal"])])
        # one scale for all panels, or the second would look as bad as the first
        self.limit = float(np.quantile(sizes, 0.98)) if len(sizes) and sizes.any() else 1.0

    @classmethod
    def from_diagnosis(cls, diagnosis: Diagnosed, *, ax: Any = None) -> Self:
        """Draw the residual of flow by opening and pressure ratio, before and after the correction.

        Outlined are the bins in which what was found acts noticeably.

        Parameters
        ----------
        diagnosis : Diagnosis
        ax : Axes or sequence of Axes, default=None
            One a panel; a new figure where None.

        Raises
        ------
        ValueError
            If the diagnosis has no traces, or flow, opening or command, or pressures are missing from them.
        """
        made = cls.of_traces(traces_of(diagnosis))
        if made is None:
            raise ValueError(
                "a residual map needs flow, both pressures, and opening or command, in thirty rows or more; "
                "this diagnosis lacks one of them"
            )
        return made.plot(ax)

    @classmethod
    def of_traces(cls, traces: dict) -> Self | None:
        """The display of traces as a diagnosis has them, not yet drawn; None where signals lack."""
        shape, place = signals.residual_map(traces), signals.position(traces)
        if shape is None or place is None:
            return None
        label = f"recorded minus simulated [{traces['units'].get('flow', '1')}]"
        return cls(*shape, x_label=place[1], label=label)

    @classmethod
    def from_predictions(
        cls,
        x: ArrayLike,
        y: ArrayLike,
        *,
        y_true: ArrayLike,
        y_pred: ArrayLike,
        y_corrected: ArrayLike | None = None,
        flagged: ArrayLike | None = None,
        x_label: str = "",
        y_label: str = "",
        label: str = "recorded minus simulated",
        ax: Any = None,
    ) -> Self:
        """Draw the residual of any predictions by any two signals.

        Parameters
        ----------
        x, y : array-like of shape (n,)
            The two signals.
        y_true, y_pred : array-like of shape (n,)
            What was recorded, and what was predicted.
        y_corrected : array-like of shape (n,) or None, default=None
            A second prediction, for a second panel.
        flagged : array-like of bool of shape (n,) or None, default=None
            Rows whose bins are outlined.
        x_label, y_label, label : str
            Of the two signals, and of the residual.
        ax : Axes or sequence of Axes, default=None
            One a panel; a new figure where None.

        Raises
        ------
        ValueError
            If fewer than thirty rows are whole.
        """
        true = np.asarray(y_true, dtype=float)
        residuals = {"nominal": true - np.asarray(y_pred, dtype=float)}
        if y_corrected is not None:
            residuals["corrected"] = true - np.asarray(y_corrected, dtype=float)
        shape = signals.binned(x, y, residuals, flagged)
        if shape is None:
            raise ValueError("a residual map needs thirty rows or more without a gap; there are fewer")
        return cls(*shape, x_label=x_label, y_label=y_label, label=label).plot(ax)

    def plot(self, ax: Any = None, *, models: Sequence[str] | None = None) -> Self:
        """Draw.

        Parameters
        ----------
        ax : Axes or sequence of Axes, default=None
            One a panel; a new figure where None.
        models : sequence of str or None, default=None
            Which of ``means`` to draw; all where None.

        Raises
        ------
        ValueError
            If there is not one Axes for each panel.
        """
        chosen = list(self.means if models is None else models)
        axes = self._drawn_on(ax, len(chosen), (3.7, 3.1), columns=len(chosen))
        for each, model in zip(axes, chosen, strict=True):
            self._draw(each, self.means[model])
            if len(chosen) > 1:
                each.set_title(_HEADINGS.get(model, model))
        return self

    def _draw(self, ax: "Axes", means: NDArray[np.float64]) -> None:
        from matplotlib.collections import LineCollection

        ax.grid(visible=False)
        mesh = ax.pcolormesh(
            self.x_edges,
            self.y_edges,
            means.T,
            cmap=_colours(),
            vmin=-self.limit,
            vmax=self.limit,
            linewidth=0.0,
        )
        border = signals.outline(self.x_edges, self.y_edges, self.flagged)
        ax.add_collection(LineCollection(border, colors=ink(), linewidths=1.4))
        bar = ax.figure.colorbar(mesh, ax=ax, label=self.label)
        bar.outline.set_edgecolor(faint())
        ax.set_xlabel(self.x_label)
        ax.set_ylabel(self.y_label)


def _colours() -> Any:
    """Colour by sign, strength by opacity: no residual looks like the page, be it light or dark."""
    from matplotlib.colors import ListedColormap

    steps = np.linspace(-1.0, 1.0, 41)[:, None]
    rgb = np.where(steps < 0.0, [[0.0, 0.45, 0.7]], [[0.84, 0.37, 0.0]])
    return ListedColormap(np.hstack([rgb, 0.08 + 0.92 * np.abs(steps)]))
