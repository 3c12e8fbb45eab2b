# SPDX-License-Identifier: BSD-3-Clause
"""The picture of what no known effect explains: the rest over the signal that tells most of it."""

import numpy as np

from sklvalve.report import signals
from sklvalve.report.drawing import COLOURS, INK, pyplot_free_figure, styled, thin, to_svg
from sklvalve.report.figures import Picture
from sklvalve.report.words import role_words

_CAPTION = "Mean of what was learnt, by the signal that tells most of it: a description, and no law."


def unexplained_figure(d: dict, traces: dict) -> Picture | None:
    """What was learnt of the rest, and, where nothing else was found, the rest itself; None without one."""
    unknown = d.get("unknown") or {}
    curve = unknown.get("curve")
    if not curve:
        return None
    role, along = unknown["signal"], curve["signal"]
    unit = traces["units"].get(role, "1")
    with styled():
        figure = pyplot_free_figure(5.2, 3.0)
        ax = figure.subplots()
        place = None if d.get("effects") else _along(traces, along)
        rest = signals.residual(traces, role, "nominal")
        if place is not None and rest is not None:
            rows = thin(len(rest))
            ax.plot(
                place[rows],
                rest[rows],
                linestyle="none",
                marker="o",
                markersize=2.2,
                markeredgewidth=0.0,
                color=COLOURS["recorded"],
                alpha=0.4,
                label="recorded less simulated",
            )
            # one wild row must not press all others flat
            low, high = np.nanquantile(rest, [0.005, 0.995])
            edge = 0.15 * max(high - low, 1e-12)
            ax.set_ylim(low - edge, high + edge)
        ax.plot(curve["at"], curve["rest"], color=COLOURS["corrected"], linewidth=1.6, label="learnt, mean")
        ax.axhline(0.0, color=INK, linewidth=0.6)
        own = f" [{curve['unit']}]" if curve["unit"] else ""
        ax.set_xlabel(f"{along}{own}")
        ax.set_ylabel(f"rest of {role_words(role)} [{unit}]")
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, markerscale=2.5, borderaxespad=0.0)
        alt = f"What no known effect explains, over the {along}"
        return Picture(to_svg(figure, "unexplained", alt), alt, _CAPTION)


def _along(traces: dict, signal: str) -> np.ndarray | None:
    """A signal as the curve has it, where the traces hold it."""
    if signal in ("opening", "command", "temperature"):
        values, unit = traces["recorded"].get(signal), traces["units"].get(signal, "1")
        if values is None or unit not in ("%", "1", "degC", "K"):
            return None
        values = np.asarray(values, dtype=float)
        return {"1": 100.0 * values, "K": values - 273.15}.get(unit, values)
    if signal == "dp" and traces.get("dp") is not None:
        return np.asarray(traces["dp"], dtype=float) / 1e3
    if signal == "pressure ratio" and traces.get("pressure_ratio") is not None:
        return np.asarray(traces["pressure_ratio"], dtype=float)
    return None
