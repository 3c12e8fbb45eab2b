# SPDX-License-Identifier: BSD-3-Clause
"""A historian's export made a clean recording: from text to rows on one time base."""

from sklvalve.recording.historian.importer import Imported, ImportSettings, import_export

__all__ = ["ImportSettings", "Imported", "import_export"]
