# SPDX-License-Identifier: BSD-3-Clause
"""A diagnosis for the person who decides: text, Markdown, one HTML file, displays for notebooks."""

from sklvalve.report.displays import (
    ExplanationDisplay,
    FitImprovementDisplay,
    RecordingDisplay,
    ResidualMapDisplay,
    SignatureDisplay,
)
from sklvalve.report.html import write_report
from sklvalve.report.sentence import summary_sentence
from sklvalve.report.text import to_markdown, to_text

__all__ = [
    "ExplanationDisplay",
    "FitImprovementDisplay",
    "RecordingDisplay",
    "ResidualMapDisplay",
    "SignatureDisplay",
    "summary_sentence",
    "to_markdown",
    "to_text",
    "write_report",
]
