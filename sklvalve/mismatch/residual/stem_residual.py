# SPDX-License-Identifier: BSD-3-Clause
"""Whether the stem strays from its simulation further than any sound one, whatever its noise model took up.

A fit that is not thrown by outliers takes a stem that sticks for a while for outliers, and a noise learnt
from what it leaves finds nothing strange in them. So the rest of the opening is held against what a sound
valve may leave, window by window: its sensor's noise, what counts, and a share of what it moves.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.mismatch.signals.stick_slip import sensor_noise
from sklvalve.recording.runs import runs

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

#: Healthy recordings of a simulated plant with the position recorded in which no stem strays: the third of
#: their windows is at 0.85 of what a sound valve may leave, or less. The rule was made on half of them.
HEALTHY = 166
#: Chance of a stem that strays without a reason: one more recording might have been the first.
P_VALUE = 1.0 / (1.0 + HEALTHY)

# rows of a window
_WINDOW = 40
# beside noise and what counts a sound stem may be off by this share of how far it moves within the window
_OF_MOVE = 0.1
# it strays where it is off by so many times that, and evidently in so many windows
_TIMES, _EVIDENT = 1.5, 3


@dataclass(frozen=True)
class StemResidual:
    """Windows in which the stem strays.

    Attributes
    ----------
    rows : ndarray of shape (n,), bool
        Those of the windows.
    windows, of : int
        Number of windows in which it strays, and of all that were asked.
    size : float
        Rms of recorded minus simulated opening in them [1].
    """

    rows: np.ndarray
    windows: int
    of: int
    size: float

    @property
    def evident(self) -> bool:
        """Whether they are too many for chance."""
        return self.windows >= _EVIDENT

    @property
    def intervals(self) -> list[tuple[int, int]]:
        """First row and the one after the last of each run of such windows."""
        return runs(self.rows)

    @property
    def reason(self) -> str:
        """What it says, for people."""
        return (
            f"In {self.windows} of {self.of} stretches of {_WINDOW} rows the stem is further from its "
            f"simulation than a healthy stem gets ({100.0 * self.size:.2g} % of travel), and no effect that "
            "could be tried explains it."
        )


def stem_residual(problem: Problem, model: Model) -> StemResidual | None:
    r"""Windows of 40 rows in which the recorded stem strays from the simulated one.

    .. math:: e > 1.5 \sqrt{\sigma^2 + c^2 + (0.1\, s)^2}

    with e the rms of their difference, :math:`\sigma` the noise of the sensor, c what counts and s the
    standard deviation of the simulated opening in the window. The first window of a recording is left out:
    where its stem came from is not known.

    Parameters
    ----------
    problem : Problem
    model : Model
        Fitted for the least error, so that a part of the recording that is sound is fitted well.

    Returns
    -------
    residual : StemResidual or None
        None where no position is recorded, or none is simulated.
    """
    if "opening" not in problem.channels:
        return None
    left, shown = problem.residuals(model)["opening"], model.predictions["opening"]
    sound = np.hypot(sensor_noise(problem.recording["opening"]), problem.least("opening"))
    rows, asked, strays, squares = np.zeros(len(left), dtype=bool), 0, 0, []
    for low, high in problem.recording.spans:
        for start in range(low + _WINDOW, high - _WINDOW + 1, _WINDOW):
            window = slice(start, start + _WINDOW)
            if np.isfinite(left[window]).sum() < _WINDOW // 2:
                continue
            asked += 1
            square = np.nanmean(left[window] ** 2)
            if square > _TIMES**2 * (sound**2 + _OF_MOVE**2 * np.nanvar(shown[window])):
                rows[window], strays = True, strays + 1
                squares.append(square)
    size = float(np.sqrt(np.mean(squares))) if squares else 0.0
    return StemResidual(rows, strays, asked, size)
