# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of a report, one function each: drawn from the traces of a diagnosis, returned as SVG."""

import numpy as np

from sklvalve.report import signals
from sklvalve.report.drawing import COLOURS, GRID, INK, decimate, pyplot_free_figure, styled, thin, to_svg
from sklvalve.report.words import role_words

_ALT_FLAGGED = "; shaded where what was found acts noticeably"


def where_present(traces: dict, location: dict) -> dict:
    """Traces whose rows are flagged only within the times that the page names.

    Parameters
    ----------
    traces : dict
    location : dict
        Its ``intervals`` are those at which what was found is there [s from the first sample].
    """
    intervals = location.get("intervals")
    if not intervals:
        return traces
    time = np.asarray(traces["time"], dtype=float)
    begun = time - time[0]
    inside = np.any([(begun >= start) & (begun <= stop) for start, stop in intervals], axis=0)
    return traces | {"flagged": np.asarray(traces["flagged"], dtype=bool) & inside}


def recording_figure(traces: dict) -> str:
    """Recorded signals over time, flagged rows shaded; recordings and rows used marked."""
    recorded = traces["recorded"]
    panels = [
        group
        for group in (("command", "opening"), ("flow",), ("process_value",), ("p1", "p2"))
        if any(recorded.get(role) is not None for role in group)
    ]
    with styled():
        figure = pyplot_free_figure(7.6, 1.35 * len(panels) + 0.5)
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        time, unit = signals.clock(traces)
        for ax, group in zip(axes, panels, strict=True):
            present = [role for role in group if recorded.get(role) is not None]
            for role in present:
                first = role in ("command", "p1") and len(present) > 1
                colour = COLOURS["other"] if first else COLOURS["recorded"]
                values = np.asarray(recorded[role], dtype=float)
                ax.plot(*decimate(time, values), color=colour, label=signals.label(traces, role))
            _shade(ax, traces, time)
            _mark_until(ax, traces, time)
            ax.legend(loc="lower left", bbox_to_anchor=(0.0, 0.97), ncols=2, borderaxespad=0.0)
        axes[-1].set_xlabel(f"{signals.time_words(traces)} [{unit}]")
        return to_svg(figure, "recording", "The recorded signals over time" + _ALT_FLAGGED)


def residual_figure(traces: dict) -> str | None:
    """Recorded less simulated over time, before and after; None where nothing can be compared."""
    compared = ("opening", "flow", "process_value")
    roles = [role for role in compared if signals.residual(traces, role, "nominal") is not None]
    if not roles:
        return None
    with styled():
        figure = pyplot_free_figure(7.6, 1.5 * len(roles) + 0.5)
        axes = figure.subplots(len(roles), 1, sharex=True, squeeze=False)[:, 0]
        time, unit = signals.clock(traces)
        for ax, role in zip(axes, roles, strict=True):
            for model, name in (("nominal", "before"), ("corrected", "after")):
                values = signals.residual(traces, role, model)
                if values is not None:
                    ax.plot(
                        *decimate(time, values),
                        color=COLOURS[model],
                        label=f"{name}: {signals.label(traces, role)}",
                        linewidth=0.8,
                    )
            ax.axhline(0.0, color=INK, linewidth=0.6)
            _shade(ax, traces, time)
            _mark_until(ax, traces, time)
            ax.legend(loc="lower left", bbox_to_anchor=(0.0, 0.97), ncols=2, borderaxespad=0.0)
        axes[-1].set_xlabel(f"{signals.time_words(traces)} [{unit}]")
        shown = " and ".join(map(role_words, roles))
        alt = f"Recorded less simulated {shown} over time, before and after the correction"
        return to_svg(figure, "residual", alt + _ALT_FLAGGED)


def travel_figure(traces: dict) -> str | None:
    """Opening against command, the classic valve signature; None without a position sensor."""
    recorded = traces["recorded"]
    if recorded.get("command") is None or recorded.get("opening") is None:
        return None
    with styled():
        figure = pyplot_free_figure(3.7, 3.3)
        ax = figure.subplots()
        command = np.asarray(recorded["command"], dtype=float)
        _clouds(ax, traces, command, {model: _opening(traces, model) for model in _MODELS})
        ax.set_xlabel(signals.label(traces, "command"))
        ax.set_ylabel(signals.label(traces, "opening"))
        return to_svg(figure, "travel", "Opening against command: recorded, simulated before and after")


def capacity_figure(traces: dict) -> str | None:
    """Flow against opening, divided by the root of the pressure drop where that was recorded."""
    place, flow = signals.position(traces), traces["recorded"].get("flow")
    if place is None or flow is None:
        return None
    drop = signals.pressure_drop(traces)
    root = np.ones(len(place[0])) if drop is None else np.sqrt(drop / 100.0)
    clouds = {
        model: None if values is None else np.asarray(values, dtype=float) / root
        for model, values in (
            ("recorded", flow),
            ("nominal", traces["nominal"].get("flow")),
            ("corrected", traces["corrected"].get("flow")),
        )
    }
    with styled():
        figure = pyplot_free_figure(3.7, 3.3)
        ax = figure.subplots()
        _clouds(ax, traces, place[0], clouds)
        ax.set_xlabel(place[1])
        per_bar = "" if drop is None else " at a pressure drop of 1 bar"
        ax.set_ylabel(f"flow{per_bar} [{traces['units'].get('flow', '1')}]")
        alt = f"Flow{per_bar} against opening: recorded, simulated before and after"
        return to_svg(figure, "capacity", alt)


def map_figures(traces: dict) -> list[tuple[str, str]]:
    """Mean flow residual by opening and pressure ratio, before and after: pairs of heading and SVG."""
    shape = signals.residual_map(traces)
    place = signals.position(traces)
    if shape is None or place is None:
        return []
    sizes = np.abs(shape.means["nominal"][np.isfinite(shape.means["nominal"])])
    # one scale for both pictures, or the second would look as bad as the first
    top = float(np.quantile(sizes, 0.98)) if len(sizes) else 1.0
    return [
        (heading, _map(traces, shape, model, top or 1.0, place[1], heading))
        for model, heading in (("nominal", "before"), ("corrected", "after"))
    ]


def _map(traces: dict, shape: signals.ResidualMap, model: str, top: float, x_label: str, heading: str) -> str:
    with styled():
        from matplotlib.collections import LineCollection
        from matplotlib.colors import ListedColormap

        # colour by sign, strength by opacity: no residual looks like the page, be it light or dark
        steps = np.linspace(-1.0, 1.0, 41)[:, None]
        rgb = np.where(steps < 0.0, [[0.0, 0.45, 0.7]], [[0.84, 0.37, 0.0]])
        colours = ListedColormap(np.hstack([rgb, 0.08 + 0.92 * np.abs(steps)]))
        figure = pyplot_free_figure(3.7, 3.1)
        ax = figure.subplots()
        ax.grid(visible=False)
        mesh = ax.pcolormesh(
            shape.x, shape.y, shape.means[model].T, cmap=colours, vmin=-top, vmax=top, linewidth=0.0
        )
        ax.add_collection(LineCollection(signals.outline(shape), colors=INK, linewidths=1.4))
        bar = figure.colorbar(
            mesh, ax=ax, label=f"recorded less simulated [{traces['units'].get('flow', '1')}]"
        )
        bar.outline.set_edgecolor(GRID)
        ax.set_xlabel(x_label)
        ax.set_ylabel("pressure ratio dp / (p1 - FF pv)")
        alt = f"Mean flow residual {heading} the correction by opening and pressure ratio"
        return to_svg(figure, f"map-{model}", alt)


_MODELS = ("recorded", "nominal", "corrected")
_NAMES = {"recorded": "recorded", "nominal": "simulated before", "corrected": "simulated after"}


def _opening(traces: dict, model: str) -> np.ndarray | None:
    values = traces[model].get("opening")
    return None if values is None else np.asarray(values, dtype=float)


def _clouds(ax, traces: dict, x: np.ndarray, clouds: dict[str, np.ndarray | None]) -> None:
    rows = thin(len(x))
    for model in _MODELS:
        values = clouds[model]
        if values is not None:
            ax.plot(
                x[rows],
                values[rows],
                linestyle="none",
                marker="o",
                markersize=2.4 if model == "recorded" else 1.4,
                markeredgewidth=0.0,
                color=COLOURS[model],
                alpha=0.45 if model == "recorded" else 0.9,
                label=_NAMES[model],
            )
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, markerscale=2.5, borderaxespad=0.0)


def _shade(ax, traces: dict, time: np.ndarray, buckets: int = 1200) -> None:
    flagged = np.asarray(traces["flagged"], dtype=bool)
    if not flagged.any():
        return
    starts = np.unique(np.linspace(0, len(time), min(buckets, len(time)) + 1).astype(int))[:-1]
    # a bucket with one flagged row is shaded: rare events must not vanish from the picture
    shaded = np.append(np.maximum.reduceat(flagged, starts), False)
    ax.fill_between(
        np.append(time[starts], time[-1]),
        0.0,
        1.0,
        where=shaded,
        step="post",
        transform=ax.get_xaxis_transform(),
        color=COLOURS["flagged"],
        alpha=0.28,
        linewidth=0.0,
    )


def _mark_until(ax, traces: dict, time: np.ndarray) -> None:
    for row in traces.get("begins", [])[1:]:
        ax.axvline(time[row], color=GRID, linewidth=0.9)
    rows = traces.get("until")
    if rows and rows < len(time):
        ax.axvline(time[rows], color=INK, linewidth=0.9, linestyle=(0, (4, 3)))
