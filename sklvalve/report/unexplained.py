# SPDX-License-Identifier: BSD-3-Clause
"""The picture of what no known effect explains: the residual over the signal that explains most of it."""

import numpy as np

from sklvalve.recording.units import from_si, quantity_of, to_si
from sklvalve.report import signals
from sklvalve.report.drawing import COLOURS, INK, pyplot_free_figure, styled, thin, to_svg
from sklvalve.report.figures import Picture
from sklvalve.report.words import role_words

_CAPTION = "Mean of the fitted residual, by the signal that explains most of it: a description, not a law."


def unexplained_figure(d: dict, traces: dict) -> Picture | None:
    """The fitted residual, and, where nothing else was found, the residual itself; None without one."""
    unknown = d.get("unknown") or {}
    curve = unknown.get("curve")
    if not curve:
        return None
    role, along = unknown["signal"], curve["signal"]
    unit = traces["units"].get(role, "1")
    with styled():
        figure = pyplot_free_figure(5.2, 3.0)
        ax = figure.subplots()
        place = None if d.get("effects") else _along(traces, along, curve["unit"])
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
                label="recorded minus simulated",
            )
            # one wild row must not press all others flat
            low, high = np.nanquantile(rest, [0.005, 0.995])
            edge = 0.15 * max(high - low, 1e-12)
            ax.set_ylim(low - edge, high + edge)
        ax.plot(curve["at"], curve["rest"], color=COLOURS["corrected"], linewidth=1.6, label="fitted, mean")
        ax.axhline(0.0, color=INK, linewidth=0.6)
        own = f" [{curve['unit']}]" if curve["unit"] else ""
        ax.set_xlabel(f"{along}{own}")
        ax.set_ylabel(f"{role_words(role)} residual [{unit}]")
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, markerscale=2.5, borderaxespad=0.0)
        alt = f"What no known effect explains, over the {along}"
        return Picture(to_svg(figure, "unexplained", alt), alt, _CAPTION)


def _along(traces: dict, signal: str, unit: str) -> np.ndarray | None:
    """A signal in the unit that the curve has, where the traces hold it."""
    if signal in ("opening", "command", "temperature"):
        values, own = traces["recorded"].get(signal), traces["units"].get(signal, "1")
        quantity = "temperature" if signal == "temperature" else "fraction"
        if values is None or quantity_of(own) != quantity:
            return None
        return from_si(to_si(np.asarray(values, dtype=float), own, quantity), unit, quantity)
    if signal == "dp" and traces.get("dp") is not None:
        zero, drop = (
            from_si(each, unit, "pressure") for each in (0.0, np.asarray(traces["dp"], dtype=float))
        )
        return drop - zero
    if signal == "pressure ratio" and traces.get("pressure_ratio") is not None:
        return np.asarray(traces["pressure_ratio"], dtype=float)
    return None
