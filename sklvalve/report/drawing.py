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

# Drawn in these, then replaced by variables of the page, so that one picture serves light and dark pages.
INK = "#010203"
GRID = "#0a0b0c"
COLOURS = {
    "recorded": "#111213",
    "nominal": "#212223",
    "corrected": "#313233",
    "flagged": "#414243",
    "other": "#515253",
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
        raise ImportError('pictures need matplotlib: pip install "sklvalve[report]"') from None
    return Figure(figsize=(width, height), layout="constrained")


def styled():
    """Context in which figures of the report are drawn and written."""
    try:
        from matplotlib import rc_context
    except ImportError:
        raise ImportError('pictures need matplotlib: pip install "sklvalve[report]"') from None
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
    # a hundredth of a point is finer than any screen, and halves the page
    svg = re.sub(r'\b(?:d|x|y|transform)="[^"]+"', _shortened, svg)
    for colour, variable in _VARIABLES.items():
        svg = svg.replace(colour, variable)
    # text without a colour of its own would stay black on a dark page
    svg = svg.replace("<text ", '<text fill="currentColor" ')
    return svg.replace("<svg ", f'<svg role="img" aria-label="{escape(alt)}" ', 1)


def _shortened(attribute: re.Match[str]) -> str:
    return re.sub(r"(\d\.\d\d)\d+", r"\1", attribute[0])


def decimate(x: NDArray, y: NDArray, points: int = 1500) -> tuple[NDArray, NDArray]:
    """Thin a course to about `points` while every peak stays: lowest and highest value of each bucket.

    Parameters
    ----------
    x, y : ndarray of shape (n,)
        NaN in `y` is a gap and stays one where a whole bucket is NaN.
    points : int, default=1500

    Returns
    -------
    x, y : ndarray of shape (m,)
        m is at most `points`, or n where that is less.
    """
    n = len(x)
    if n <= points:
        return x, y
    size = -(-n // (points // 2))
    whole = n // size * size
    blocks = y[:whole].reshape(-1, size)
    start = np.arange(0, whole, size)
    low = start + np.argmin(np.where(np.isnan(blocks), np.inf, blocks), axis=1)
    high = start + np.argmax(np.where(np.isnan(blocks), -np.inf, blocks), axis=1)
    rows = np.sort(np.concatenate([low, high, [n - 1]]))
    return x[rows], y[rows]


def thin(rows: int, points: int = 900) -> NDArray[np.intp]:
    """Rows for a cloud of points, spread evenly, so that no part of the recording is favoured."""
    return np.unique(np.linspace(0, rows - 1, min(rows, points)).round().astype(np.intp))
