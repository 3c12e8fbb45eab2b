# SPDX-License-Identifier: BSD-3-Clause
"""Signals over time, with the rows flagged in which what was found acts."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from sklvalve.recording.calendar_time import first_stamp
from sklvalve.recording.thinning import decimate
from sklvalve.report import signals
from sklvalve.report.courses import Panel, recorded_panels, residual_panels
from sklvalve.report.displays.base import Diagnosed, Display, faint, ink, legend_above, traces_of
from sklvalve.report.drawing import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sklvalve.recording import Recording


class RecordingDisplay(Display):
    """Signals over time, flagged times shaded.

    Best made by `from_diagnosis`, `from_estimator` or `from_recording`.

    Parameters
    ----------
    time : array-like of shape (n,)
        Numbers, or datetime64 for an axis by the calendar.
    panels : sequence of list of Course
        The signals of each panel; `Course` has name, unit, colour and values of shape (n,).
    time_label : str, default="time [s]"
    flagged : array-like of bool of shape (n,) or None, default=None
        Rows to be shaded.
    begins : sequence of int, default=()
        Rows at which recordings begin that were joined.
    until : int or None, default=None
        Rows that served for finding; those behind them are marked.

    Attributes
    ----------
    ax_ : Axes or ndarray of Axes
        One a panel.
    figure_ : Figure

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.report import RecordingDisplay
    >>> from sklvalve.report.courses import Course
    >>> flow = Course("flow", "m3/h", "recorded", np.sin(np.arange(200.0) / 20.0))
    >>> display = RecordingDisplay(time=np.arange(200.0), panels=[[flow]], flagged=np.arange(200) > 150)
    >>> display.plot().ax_.get_xlabel()
    'time [s]'
    """

    def __init__(
        self,
        *,
        time: ArrayLike,
        panels: Sequence[Panel],
        time_label: str = "time [s]",
        flagged: ArrayLike | None = None,
        begins: Sequence[int] = (),
        until: int | None = None,
    ) -> None:
        time = np.asarray(time)
        self.time = time if time.dtype.kind == "M" else time.astype(float)
        self.panels = list(panels)
        self.time_label = time_label
        self.flagged = np.zeros(len(self.time), dtype=bool) if flagged is None else np.asarray(flagged, bool)
        self.begins = begins
        self.until = until

    @classmethod
    def from_diagnosis(
        cls,
        diagnosis: Diagnosed,
        *,
        show: Literal["recorded", "residual"] = "recorded",
        ax: Any = None,
    ) -> Self:
        """Draw the recording of a diagnosis, or what its simulation leaves of it.

        Parameters
        ----------
        diagnosis : Diagnosis
        show : {"recorded", "residual"}, default="recorded"
            The signals as recorded, or recorded minus simulated, before and after the correction.
        ax : Axes or sequence of Axes, default=None
            One a panel; a new figure where None.

        Raises
        ------
        ValueError
            If `show` is neither of the two, if the diagnosis has no traces, or if there is nothing to show.
        """
        return cls.of_traces(traces_of(diagnosis), show=show).plot(ax)

    @classmethod
    def from_recording(cls, recording: "Recording", *, ax: Any = None) -> Self:
        """Draw a recording as it is, before any diagnosis.

        Parameters
        ----------
        recording : Recording
        ax : Axes or sequence of Axes, default=None
        """
        shown = [role for role in recording.signals if role not in recording.constants]
        traces = {
            "time": recording.time,
            "units": {role: recording.unit(role) for role in shown},
            "recorded": {role: recording.in_recorded_units(role, recording[role]) for role in shown},
            "flagged": np.zeros(len(recording), dtype=bool),
            "begins": [low for low, _ in recording.spans],
            "first_stamp": first_stamp(recording),
        }
        return cls.of_traces(traces).plot(ax)

    @classmethod
    def of_traces(cls, traces: dict, *, show: str = "recorded") -> Self:
        """The display of traces as a diagnosis has them, not yet drawn."""
        kinds = {"recorded": recorded_panels, "residual": residual_panels}
        if show not in kinds:
            raise ValueError(f'show must be "recorded" or "residual"; got {show!r}')
        clock = signals.clock(traces)
        return cls(
            time=clock.values if clock.begins is None else clock.stamps,
            panels=kinds[show](traces),
            time_label=signals.time_words(traces) + (f" [{clock.unit}]" if clock.begins is None else ""),
            flagged=traces["flagged"],
            begins=traces.get("begins", ()),
            until=traces.get("until"),
        )

    def plot(self, ax: Any = None, *, points: int = 1500) -> Self:
        """Draw.

        Parameters
        ----------
        ax : Axes or sequence of Axes, default=None
            One a panel; a new figure where None.
        points : int, default=1500
            To so many each course is thinned, its peaks kept.

        Raises
        ------
        ValueError
            If there is no panel, or not one Axes for each.
        """
        if not self.panels:
            raise ValueError("there is nothing to draw: none of the signals was recorded, or none simulated")
        axes = self._drawn_on(ax, len(self.panels), (7.6, 1.5), same_x=True)
        spans = signals.flagged_spans(self.time, self.flagged)
        for each, panel in zip(axes, self.panels, strict=True):
            self._draw(each, panel, points)
            self._mark(each, spans)
        axes[-1].set_xlabel(self.time_label)
        if self.time.dtype.kind == "M":
            _by_the_calendar(axes[-1])
        return self

    def _draw(self, ax: "Axes", panel: Panel, points: int) -> None:
        for depth, course in enumerate(panel):
            residual = course.colour in signals.MODELS
            ax.plot(
                *decimate(self.time, course.values, points),
                color=COLOURS[course.colour],
                # what is measured stands before what was asked for, what is left after before what was
                zorder=2.0 + (0.1 if residual else -0.1) * depth,
                linewidth=0.9,
                label=f"{course.name} [{course.unit}]",
            )
            if residual:
                ax.axhline(0.0, color=ink(), linewidth=0.6)
        legend_above(ax)

    def _mark(self, ax: "Axes", spans: list[tuple[float, float]]) -> None:
        bars = [(start, stop - start) for start, stop in spans]
        across = ax.get_xaxis_transform()
        ax.broken_barh(
            bars, (0.0, 1.0), transform=across, color=COLOURS["flagged"], alpha=0.28, linewidth=0.0
        )
        for row in list(self.begins)[1:]:
            ax.axvline(self.time[row], color=faint(), linewidth=0.9)
        if self.until and self.until < len(self.time):
            ax.axvline(self.time[self.until], color=ink(), linewidth=0.9, linestyle=(0, (4, 3)))
        ax.margins(x=0.01)


def _by_the_calendar(ax: "Axes") -> None:
    """Ticks at round times, the date where it changes and beside the axis."""
    from matplotlib.dates import AutoDateLocator, ConciseDateFormatter

    locator = AutoDateLocator(minticks=3, maxticks=8)
    ax.xaxis.set_major_locator(locator)
    days = "%Y-%m-%d"
    beside = ["", "%Y", "%Y-%m", days, days, f"{days} %H:%M"]
    ax.xaxis.set_major_formatter(ConciseDateFormatter(locator, offset_formats=beside))
