# SPDX-License-Identifier: BSD-3-Clause
"""A historian's export made a clean recording: from text to rows on one time base."""

from sklvalve.recording.historian.importer import Imported, ImportedRuns, import_export, import_runs
from sklvalve.recording.historian.settings import ImportSettings

__all__ = ["ImportSettings", "Imported", "ImportedRuns", "import_export", "import_runs"]
