# SPDX-License-Identifier: BSD-3-Clause
"""What one published method says of a loop."""

from dataclasses import dataclass

from sklvalve.mismatch.loop.constants import ROWS_OF_A_SHAPE
from sklvalve.mismatch.loop.oscillation import Oscillation

STICTION, SOUND, UNDECIDED, NOT_APPLICABLE = "stiction", "no stiction", "undecided", "not applicable"


@dataclass(frozen=True)
class MethodResult:
    """Statistic and verdict of one method.

    Parameters
    ----------
    method : str
        Name in the field.
    source : str
        Authors, year and doi.
    statistic : float or None
        None where it could not be computed; where it could, it stands here even if the method does not apply.
    limit : float
        Published limit above which the method says stiction.
    says : {"stiction", "no stiction", "undecided", "not applicable"}
    detail : str
        One sentence: what the verdict rests on.
    band : float or None
        Apparent stick band [unit of the command as given], by the methods that estimate one.
    """

    method: str
    source: str
    statistic: float | None
    limit: float
    says: str
    detail: str
    band: float | None = None


@dataclass(frozen=True)
class Method:
    """A published method: its name, source and limit, and the rows in a period that it needs."""

    name: str
    source: str
    limit: float
    fewest_rows: float = ROWS_OF_A_SHAPE

    def obstacle(self, oscillation: Oscillation) -> str | None:
        """The sentence that says why the method does not apply to an oscillation; None where it does."""
        if oscillation.rows is None:
            return "No line stands in the spectrum, and the method needs an oscillation."
        if oscillation.rows < self.fewest_rows:
            return (
                f"A period has {oscillation.rows:.1f} rows, and the method needs {self.fewest_rows:.0f} or "
                "more to see its shape."
            )
        if not oscillation.regular:
            return "The loop does not oscillate regularly, and the method needs a regular oscillation."
        return None

    def not_applicable(self, reason: str | None) -> MethodResult:
        """The result where there is no statistic."""
        return self.result(None, NOT_APPLICABLE, "", reason)

    def result(
        self,
        statistic: float | None,
        says: str,
        detail: str,
        obstacle: str | None = None,
        band: float | None = None,
    ) -> MethodResult:
        """A result; where there is an obstacle the statistic alone is kept."""
        if obstacle:
            says, detail, band = NOT_APPLICABLE, obstacle, None
        return MethodResult(self.name, self.source, statistic, self.limit, says, detail, band)


def by_limits(statistic: float, low: float, high: float) -> str:
    """Stiction above the upper limit, none below the lower, undecided between."""
    if statistic > high:
        return STICTION
    return SOUND if statistic < low else UNDECIDED
