# SPDX-License-Identifier: BSD-3-Clause
"""A diagnosis as one HTML file that needs nothing else: no network, no fonts, no script but its own."""

import os
from base64 import b64encode
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from sklvalve._replacing import replacing
from sklvalve._telling import since_history
from sklvalve.report import compared, figures, proof, rows
from sklvalve.report.displays.base import Diagnosed
from sklvalve.report.headline import glance, headline
from sklvalve.report.intervals import interval_figures
from sklvalve.report.signals import as_shown
from sklvalve.report.since_history import section, settable
from sklvalve.report.then_and_now import then_and_now_figures
from sklvalve.report.trends import trends
from sklvalve.report.unexplained import unexplained_figure
from sklvalve.report.unnoticed import HEAD as unnoticed_head
from sklvalve.report.unnoticed import UNNOTICED, unnoticed
from sklvalve.report.words import either, lacks_sheet, verdict_words, with_units


def write_report(
    path: str | os.PathLike[str],
    diagnosis: Diagnosed,
    *,
    title: str | None = None,
    source: str | None = None,
) -> None:
    """Write a diagnosis as one HTML file for the person who decides.

    The finding in a sentence, how sure it is, what to do next; the recording with the flagged times; the
    valve's signature and the residuals before and after; the explanations with their parameters and
    intervals; errors on held-out rows; what could not be tested. Pictures stand inside the file as SVG; it
    follows the reader's light or dark setting and can be read on a telephone and on paper. A script inside
    the file reads values from the trends and zooms into them; where scripts are switched off, the trends
    stand still. The page allows itself no connection to anything outside.

    Parameters
    ----------
    path : str or path-like
        The file, replaced as a whole once the page is complete.
    diagnosis : Diagnosis
        The result of `MissingPhysicsFinder`; its ``to_dict()`` and ``traces`` are used. Without traces the
        page has no pictures of signals.
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
    with replacing(Path(path)) as draft:
        draft.write_text(page, encoding="utf-8")


def render(diagnosis: Diagnosed, *, title: str | None = None, source: str | None = None) -> str:
    """Text of the page that `write_report` writes."""
    try:
        from jinja2 import Environment, StrictUndefined
    except ImportError:
        raise ImportError('the report needs jinja2: pip install "sklvalve[report]"') from None
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["with_units"] = with_units
    d = proof.with_proof(diagnosis.to_dict(), diagnosis.traces)
    # the parts share names, and leave none behind
    script = f'"use strict";\n(() => {{\n{_part("reading.js")}{_part("trends.js")}}})();\n'
    return environment.from_string(_part("report.html.j2")).render(
        title=title or "Control valve",
        source=source,
        style=_part("report.css"),
        script=script,
        script_hash=f"sha256-{b64encode(sha256(script.encode()).digest()).decode()}",
        **_words(d),
        **_pictures(d, diagnosis.traces),
    )


def _words(d: dict) -> dict[str, Any]:
    return {
        "headline": headline(d),
        "glance": glance(d),
        "verdict": d["verdict"],
        "verdict_words": verdict_words(d),
        "since": section(d),
        "settable": settable(),
        "explanations": rows.explanations(d),
        "unexplained": rows.unexplained(d),
        "places": rows.places(d),
        "models": list(rows.models(d).values()),
        "errors": rows.errors(d),
        "proof": proof.heading(d),
        "notes": rows.proof_notes(d),
        "comparisons": compared.comparisons(d),
        "comparison_head": compared.HEAD,
        "rules": compared.rules(d),
        "rules_head": compared.RULES_HEAD,
        "details": rows.details(d),
        "simulated": simulated(d),
        "untestable": [
            (f"Without {needs}", either(names, "and")) for needs, names in rows.untestable_by_need(d)
        ],
        "unnoticed": unnoticed(d),
        "unnoticed_words": UNNOTICED,
        "unnoticed_head": unnoticed_head,
        "data": rows.data_findings(d),
        "provenance": rows.provenance(d),
    }


def _pictures(d: dict, traces: dict) -> dict[str, Any]:
    drawn: dict[str, Any] = {
        "recording": None,
        "recording_caption": "",
        "residual": None,
        "when": "",
        "signatures": [],
        "maps": [],
        "unexplained_picture": None,
        "since_pictures": [],
        "improvements": figures.improvement_figures(d),
        "intervals": interval_figures(d),
        "trends": None,
    }
    if not traces:
        return drawn
    traces = as_shown(traces, d.get("location") or {})
    caption = _caption(d, traces)
    if _everywhere(traces):
        # a picture that is shaded all over, or outlined all round, shows nothing
        traces = traces | {"flagged": np.zeros(len(traces["flagged"]), dtype=bool)}
    return drawn | {
        "recording": figures.recording_figure(traces),
        "recording_caption": caption,
        "residual": figures.residual_figure(traces),
        "when": figures.when(traces),
        "signatures": figures.signature_figures(traces),
        "maps": figures.map_figures(traces),
        "unexplained_picture": unexplained_figure(d, traces),
        "since_pictures": then_and_now_figures(d, traces) if since_history(d) else [],
        "trends": trends(traces),
    }


def _caption(d: dict, traces: dict) -> str:
    """What is marked in the recording."""
    words = "The signals as recorded."
    if _everywhere(traces):
        words = "What was found acts in all rows, so none are shaded."
    elif np.asarray(traces["flagged"]).any():
        words = (
            "Shaded: rows where what was found has a quarter or more of its largest effect. In other rows of "
            "the times above it is present, but small."
        )
    if traces.get("until"):
        used = "are for the final check only" if d.get("proof") == proof.LATER_ROWS else "were not used"
        words += f" Dashed: the rows to the right of it {used}."
    return words


def simulated(d: dict) -> str:
    """What the simulation before the correction is, for the captions of residuals."""
    if d.get("subject") == "loop":
        return "a stem that follows its command, with the loop's response fitted to this recording"
    if lacks_sheet(d):
        return "calibrated on this recording"
    if since_history(d):
        return "calibrated on this recording within what the history lets expect"
    return "by the data sheet, calibrated on this recording within its tolerances"


def _everywhere(traces: dict) -> bool:
    """Whether what was found acts in all rows, but for a few."""
    return bool(np.mean(np.asarray(traces["flagged"], dtype=bool)) > 0.99)


def _part(name: str) -> str:
    return files("sklvalve.report").joinpath("templates", name).read_text(encoding="utf-8")
