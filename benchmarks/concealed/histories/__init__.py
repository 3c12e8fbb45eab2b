# SPDX-License-Identifier: BSD-3-Clause
"""An hour of the same plant, from before a record: its history, as a user would have one at hand.

Hardware, data sheet, meters with their zeros, scan, converters, historian and controller are those of the
record; what the valve is asked to do, the pressures and the noise are drawn anew. What the record conceals is
not in it, but for a history in ten, which is not clean. Nothing of how the record is drawn depends on it.

    python -m benchmarks.concealed.histories FOLDER

adds histories to the records of a folder, which keep every digit.
"""

from benchmarks.concealed.histories.hour import ROWS, history_of, with_history
from benchmarks.concealed.histories.kinds import Kind, kind_of_history

__all__ = ["ROWS", "Kind", "history_of", "kind_of_history", "with_history"]
