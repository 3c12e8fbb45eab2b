# SPDX-License-Identifier: BSD-3-Clause
"""A diagnosis for the person who decides: one sentence, text, Markdown, one HTML file, figures."""

from sklvalve.report.html import write_report
from sklvalve.report.sentence import summary_sentence
from sklvalve.report.text import to_markdown, to_text

__all__ = ["summary_sentence", "to_markdown", "to_text", "write_report"]
