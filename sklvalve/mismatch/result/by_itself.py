# SPDX-License-Identifier: BSD-3-Clause
"""What a history keeps of the diagnosis of its own recordings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sklvalve.history.by_itself import LONGEST, ByItself

if TYPE_CHECKING:
    from sklvalve.mismatch.result.diagnosis import Diagnosis


def by_itself(diagnosis: Diagnosis, held: bool) -> ByItself:
    """Verdict, finding, reasons and names of a diagnosis.

    Parameters
    ----------
    diagnosis : Diagnosis
        Of the recordings of the history.
    held : bool
        Whether the history holds all that it names.
    """
    content = diagnosis.content
    nameless = diagnosis.verdict in ("none_of_these", "cannot_tell")
    texts = (diagnosis.finding, " ".join(content.get("reasons") or []) if nameless else "")
    # a line each, whatever a caller's own effect is called
    finding, reason = (" ".join(words.split())[:LONGEST] for words in texts)
    checked = all(entry["probability"] is not None for entry in content["effects"])
    classes = [[each["name"] for each in entry["members"]] for entry in content["effects"]]
    return ByItself(diagnosis.verdict, finding, reason, held, checked, {c[0]: c[1:] for c in classes})
