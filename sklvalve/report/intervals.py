# SPDX-License-Identifier: BSD-3-Clause
"""The picture of parameters with their intervals: how well each is known, and whether it may be zero."""

from sklvalve.report.drawing import COLOURS, GRID, INK, pyplot_free_figure, styled, to_svg
from sklvalve.report.figures import Picture
from sklvalve.report.parameters import Parameter, shown_parameters

_CAPTION = (
    "Each value with its 95 % interval, on its own scale from zero, the vertical line, to the far end of the "
    "interval."
)
# letters of a line of names, so that they leave room for the intervals on a telephone
_LETTERS = 26


def interval_figures(d: dict) -> list[Picture | None]:
    """For each entry of ``effects`` the picture of its parameters; None where none has an interval."""
    return [
        _figure(f"intervals-{count}", shown_parameters(effect, d))
        for count, effect in enumerate(d.get("effects") or [])
    ]


def _figure(name: str, parameters: list[Parameter]) -> Picture | None:
    from textwrap import fill

    known = [p for p in parameters if None not in (p.value, p.low, p.high) and not p.unknown_ends]
    if not known:
        return None
    alt = "Parameters with their 95 % intervals: " + "; ".join(f"{each.name} {each.words}" for each in known)
    with styled():
        figure = pyplot_free_figure(3.7, 0.3 + 0.36 * len(known))
        ax = figure.subplots()
        for place, each in enumerate(known):
            low, value, high = _on_own_scale(each)
            ax.plot(
                [low, high], [place, place], color=COLOURS["corrected"], linewidth=2.2, solid_capstyle="butt"
            )
            ax.plot([value], [place], "o", color=COLOURS["corrected"], markersize=5.0, markeredgewidth=0.0)
        ax.axvline(0.0, color=INK, linewidth=0.8)
        ax.set_yticks(range(len(known)), [fill(each.name.rstrip(","), _LETTERS) for each in known])
        ax.set_ylim(len(known) - 0.5, -0.5)
        ax.set_xlim(min(-0.06, 1.06 * min(_on_own_scale(each)[0] for each in known)), 1.06)
        ax.set_xticks([])
        ax.tick_params(axis="y", length=0.0)
        ax.grid(visible=False)
        ax.grid(axis="y", color=GRID)
        for side in ("left", "bottom"):
            ax.spines[side].set_visible(False)
        return Picture(to_svg(figure, name, alt), alt, _CAPTION)


def _on_own_scale(parameter: Parameter) -> tuple[float, float, float]:
    """Low end, value and high end as shares of the end that lies furthest from zero."""
    assert parameter.low is not None
    assert parameter.value is not None
    assert parameter.high is not None
    ends = parameter.low, parameter.value, parameter.high
    scale = max(map(abs, ends)) or 1.0
    low, value, high = (end / scale for end in ends)
    return low, value, high
