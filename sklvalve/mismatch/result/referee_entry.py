# SPDX-License-Identifier: BSD-3-Clause
"""The ``referee`` part of diagnosis.json."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sklvalve.mismatch.constants import MARGIN
from sklvalve.recording import Recording

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.referee import Referee


def referee_entry(referee: Referee, recording: Recording) -> dict[str, Any]:
    """Errors on rows ahead in time, in the recording's own units, and what they allow to be said.

    Parameters
    ----------
    referee : Referee
    recording : Recording

    Returns
    -------
    entry : dict
        ``margin``, ``share_explained``, and ``channels``: name -> unit, rows, rmse, ratio, clearly_better,
        exogenous, closed_loop.
    """
    channels = {}
    for each in referee.compared:
        unit = abs(recording.per_si(each.channel))
        channels[each.channel] = {
            "unit": recording.unit(each.channel),
            "rows": each.rows,
            "rmse": {kind: float(error * unit) for kind, error in each.rmse.items()},
            "ratio": float(each.ratio),
            "clearly_better": bool(each.clearly_better),
            "exogenous": bool(each.exogenous),
            "closed_loop": bool(each.closed),
        }
    return {"margin": MARGIN, "share_explained": referee.share, "channels": channels}
