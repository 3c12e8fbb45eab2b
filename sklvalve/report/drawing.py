# SPDX-License-Identifier: BSD-3-Clause
"""How a figure becomes part of a page: few points, theme colours, identifiers of its own."""

import io
import re
from html import escape
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# In a page all of these are replaced by its variables, so that one picture serves light and dark pages; ink
# and grid are drawn in colours that nothing else has.
INK = "#010203"
GRID = "#0a0b0c"
# as the light page has them; far apart for those who cannot tell red from green, too
COLOURS = {
    "recorded": "#47505b",
    "nominal": "#d55e00",
    "corrected": "#0072b2",
    "flagged": "#e6b800",
    "other": "#2a8f8f",
    "black_box": "#8a6fb0",
}
_VARIABLES = {INK: "currentColor", GRID: "var(--grid)"} | {
    colour: f"var(--{name})" for name, colour in COLOURS.items()
}

_STYLE = {
    "svg.fonttype": "none",
    "svg.hashsalt": "sklvalve",
    "font.family": "sans-serif",
    "font.size": 9.0,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": GRID,
    "grid.linewidth": 0.5,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.0,
    "path.simplify": False,
}


NO_MATPLOTLIB = 'pictures need matplotlib: pip install "sklvalve[report]"'


def pyplot_free_figure(width: float, height: float) -> "Figure":
    """Figure of a size [inch] that no window system and no global state knows of.

    Raises
    ------
    ImportError
        If matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise ImportError(NO_MATPLOTLIB) from None
    return Figure(figsize=(width, height), layout="constrained")


def styled():
    """Context in which figures of the report are drawn and written."""
    try:
        from matplotlib import rc_context
    except ImportError:
        raise ImportError(NO_MATPLOTLIB) from None
    return rc_context(_STYLE)


def to_svg(figure: "Figure", name: str, alt: str) -> str:
    """SVG element of a figure, to stand inside a page.

    Parameters
    ----------
    figure : matplotlib Figure
    name : str
        Put before every identifier inside, since identifiers of two figures on one page would clash.
    alt : str
        What the figure shows, for those who cannot see it.

    Returns
    -------
    svg : str
        Without prolog, metadata and names of schemas, which an HTML page does not need.
    """
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    svg = buffer.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r'\sxmlns(:\w+)?="[^"]*"', "", svg)
    svg = re.sub(r'\bid="([^"]+)"', rf'id="{name}-\1"', svg)
    svg = re.sub(r"url\(#([^)]+)\)", rf"url(#{name}-\1)", svg)
    svg = re.sub(r'xlink:href="#([^"]+)"', rf'href="#{name}-\1"', svg)
    svg = _compact(svg)
    for colour, variable in _VARIABLES.items():
        svg = svg.replace(colour, variable)
    # text without a colour of its own would stay black on a dark page
    svg = svg.replace("<text ", '<text fill="currentColor" ')
    return svg.replace("<svg ", f'<svg role="img" aria-label="{escape(alt)}" ', 1)


def _compact(svg: str) -> str:
    """The same picture in a third of the letters."""
    # the page has its own letters
    svg = re.sub(r"font-family: [^;\"]*;\s*", "", svg)
    # empty bins of a map
    svg = re.sub(r'<path d="[^"]*" clip-path="[^"]*" style="fill: none"/>\s*', "", svg)
    # markers of one cloud have one style
    svg = re.sub(r"<g([^>]*)>\s*((?:<use [^>]*/>\s*){2,})</g>", _one_style, svg)
    svg = re.sub(r">\s+<", "><", svg)
    return re.sub(r'(?<= )(d|x|y|transform)="([^"]+)"', _short_numbers, svg)


def _one_style(cloud: re.Match[str]) -> str:
    styles = set(re.findall(r'style="[^"]*"', cloud[2]))
    if len(styles) != 1:
        return cloud[0]
    style = styles.pop()
    return f"<g{cloud[1]} {style}>{cloud[2].replace(' ' + style, '')}</g>"


def _short_numbers(attribute: re.Match[str]) -> str:
    # a tenth of a point is finer than a screen; small shapes, as markers are, need more
    def short(found: re.Match[str]) -> str:
        value = float(found[0])
        words = f"{value:.1f}" if abs(value) >= 10.0 else f"{value:.2f}"
        return words.rstrip("0").rstrip(".")

    words = re.sub(r"-?\d+\.\d+", short, attribute[2])
    if attribute[1] == "d":
        words = re.sub(r"\s*([A-Za-z])\s*", r"\1", words)
        words = re.sub(r"(L[^A-Za-z]+)\1+", r"\1", words)
    return f'{attribute[1]}="{words}"'


def thin(rows: int, points: int = 900) -> NDArray[np.intp]:
    """Rows for a cloud of points, spread evenly, so that no part of the recording is favoured."""
    return np.unique(np.linspace(0, rows - 1, min(rows, points)).round().astype(np.intp))
