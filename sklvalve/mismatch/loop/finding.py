# SPDX-License-Identifier: BSD-3-Clause
"""What was found in a loop."""

from dataclasses import asdict, dataclass, field
from typing import Any

from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class LoopFinding:
    """What a loop's command and value say of its valve.

    Parameters
    ----------
    verdict : {"named", "no_mismatch", "cannot_tell"}
        ``named``: the stem sticks or has play; ``no_mismatch``: sticking of a relevant size is excluded;
        ``cannot_tell``: neither.
    p_value : float
        How often a healthy loop gives as much evidence, an outside oscillation included.
    alpha : float
        Level of the test.
    evidence : float
        Difference of log likelihood between the best sticking stem of the grid and the command itself: the
        least over several forms of process and noise (docs/loops.md) [nats].
    band : float
        Band of the likeliest stem, as a share of the command's movement; below 0.17 on the grid it is no
        finding.
    effects : tuple of dict
        As `effects` in diagnosis.json: members, a `grade` in place of probabilities, parameters with
        intervals, a sentence, what would separate the members.
    fit : dict
        Held-out errors of the value (SI): `held_out_rows`, `rmse` of `nominal` and `corrected`, and
        `noise_floor`, the error of the forecast one row ahead.
    predictions : dict of ndarray
        `time`, `stem`, `nominal`, `corrected`; values as recorded (SI), free runs from the command but for a
        constant level in each quarter of the recording.
    reasons : tuple of str
        Plain sentences: what the verdict rests on, and how the rows were used.
    sampling : dict
        `recorded`, `used` [s], `averaged_rows`, `stretches` and the `stretch` that the figures are of [s].
    oscillation : dict
        Period [s] and regularity of the loop's swing; empty where it was not looked for.
    methods : tuple of dict
        What published methods say: `method`, `statistic`, `limit`, `says`, `source`.
    details : tuple of str
        What the verdict rests on in figures, in sentences for a specialist.
    """

    verdict: str
    p_value: float
    alpha: float
    evidence: float
    band: float
    effects: tuple[dict[str, Any], ...] = ()
    fit: dict[str, Any] = field(default_factory=dict)
    predictions: dict[str, NDArray] = field(default_factory=dict)
    reasons: tuple[str, ...] = ()
    sampling: dict[str, Any] = field(default_factory=dict)
    oscillation: dict[str, Any] = field(default_factory=dict)
    methods: tuple[dict[str, Any], ...] = ()
    details: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Plain dict without the predictions, as it may stand in diagnosis.json."""
        content = asdict(self)
        content.pop("predictions")
        return content
