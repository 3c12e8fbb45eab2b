# SPDX-License-Identifier: BSD-3-Clause
"""Equations as MathML, made when the site is built: shown without a script and without a network."""

import re

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

logger = logging.getLogger(__name__)

_NAMED = r"\\(?:ln|log|sin|arcsin|operatorname\{\w+\})"
# what the converter reads otherwise than LaTeX does: (pattern, what to write instead)
_TIDY = (
    # twelve over what follows
    (re.compile(r"(\\[dt]?frac)\s*(\d)\s*(\d)"), r"\1{\2}{\3}"),
    # an index below the accented letter
    (re.compile(r"(\\(?:d?dot|hat|tilde|bar)\s*(?:\{[^{}]*\}|\\?[A-Za-z]+))(?=_)"), r"{{}\1}"),
    # no space about the name of a function
    (re.compile(rf"(?<=[\w}}])\s+(?={_NAMED})"), r"\\, "),
    (re.compile(rf"({_NAMED}(?:_\{{\w+\}})?)\s+(?=\\?[A-Za-z])"), r"\1\\, "),
)


def setup(app):
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def to_mathml(latex, *, as_block):
    """MathML of an equation; a MathError tells what of it cannot be shown."""
    for pattern, instead in _TIDY:
        latex = pattern.sub(instead, latex)
    return tex2mathml(latex, as_block=as_block)


def _inline(translator, node):
    translator.body.append(_shown(node, as_block=False))
    raise nodes.SkipNode


def _block(translator, node):
    translator.body.append(translator.starttag(node, "div", CLASS="math"))
    translator.body.append(_shown(node, as_block=True))
    translator.body.append("</div>\n")
    raise nodes.SkipNode


def _shown(node, as_block):
    try:
        return to_mathml(node.astext(), as_block=as_block)
    except MathError as error:
        logger.warning("equation cannot be shown: %s: %s", error, node.astext(), location=node)
        return ""
