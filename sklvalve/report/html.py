# SPDX-License-Identifier: BSD-3-Clause
"""A diagnosis as one HTML file that needs nothing else: no network, no script, no fonts."""

import os
import re
import secrets
from importlib.resources import files
from pathlib import Path
from typing import Protocol

from sklvalve.report import figures, proof, rows
from sklvalve.report.sentence import summary_sentence
from sklvalve.report.unexplained import unexplained_figure
from sklvalve.report.words import verdict_words


class _Diagnosis(Protocol):
    @property
    def traces(self) -> dict: ...

    def to_dict(self) -> dict: ...


def write_report(
    path: str | os.PathLike[str],
    diagnosis: _Diagnosis,
    *,
    title: str | None = None,
    source: str | None = None,
) -> None:
    """Write a diagnosis as one HTML file for the person who decides.

    The summary sentence, the recording with the flagged times, residuals before and after, the explanations
    with their parameters and intervals, what could not be tested, and the next test. Pictures stand inside
    the file as SVG; it follows the reader's light or dark setting and can be read on a telephone.

    Parameters
    ----------
    path : str or path-like
        The file, replaced as a whole once the page is complete.
    diagnosis : Diagnosis
        The result of `MissingPhysicsFinder`; its ``to_dict()`` and ``traces`` are used.
    title : str or None, default=None
        What to call the valve, such as its tag.
    source : str or None, default=None
        Where the recording came from, for the page's foot.

    Raises
    ------
    ImportError
        If jinja2 or matplotlib is not installed.
    OSError
        If the file cannot be written; nothing is left of it then.

    Examples
    --------
    >>> from sklvalve.report import write_report
    >>> write_report("report.html", finder.diagnosis_, title="FV-101")  # doctest: +SKIP
    """
    page = render(diagnosis, title=title, source=source)
    file = Path(path)
    draft = file.with_name(f".{file.name}.{secrets.token_hex(4)}")
    try:
        draft.write_text(page, encoding="utf-8")
        os.replace(draft, file)
    finally:
        draft.unlink(missing_ok=True)


def render(diagnosis: _Diagnosis, *, title: str | None = None, source: str | None = None) -> str:
    """Text of the page that `write_report` writes."""
    try:
        from jinja2 import Environment, StrictUndefined
        from markupsafe import Markup
    except ImportError:
        raise ImportError('the report needs jinja2: pip install "sklvalve[report]"') from None
    d = proof.with_proof(diagnosis.to_dict(), diagnosis.traces)
    traces = figures.where_present(diagnosis.traces, d.get("location") or {})
    drawn = {
        "recording": figures.recording_figure(traces),
        "residual": figures.residual_figure(traces),
        "travel": figures.travel_figure(traces),
        "capacity": figures.capacity_figure(traces),
        "unexplained": unexplained_figure(d, traces),
    }
    template = files("sklvalve.report").joinpath("templates", "report.html.j2").read_text(encoding="utf-8")
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["with_units"] = _with_units
    return environment.from_string(template).render(
        title=title or "Control valve",
        source=source,
        summary=summary_sentence(d),
        verdict=d["verdict"],
        verdict_words=verdict_words(d),
        explanations=rows.explanations(d),
        unexplained=rows.unexplained(d),
        places=rows.places(d),
        models=list(rows.MODELS.values()),
        errors=rows.errors(d),
        proof=proof.heading(d),
        notes=rows.proof_notes(d),
        untestable=rows.untestable(d),
        next_test=d.get("next_test") or "",
        data=rows.data_findings(d),
        provenance=rows.provenance(d),
        figures={name: svg and Markup(svg) for name, svg in drawn.items()},
        maps=[(heading, Markup(svg)) for heading, svg in figures.map_figures(traces)],
        until=bool(traces.get("until")),
        held_out=d.get("proof") == proof.LATER_ROWS,
    )


def _with_units(words: str) -> str:
    """Words whose numbers stay on one line with their units."""
    return re.sub(r"(?<=\d) (?=(?:%|s|h|m3/h|kPa)(?!\w))", "\N{NO-BREAK SPACE}", words)
