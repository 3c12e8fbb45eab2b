# SPDX-License-Identifier: BSD-3-Clause
"""What one published method says of a loop."""

from dataclasses import asdict, dataclass

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
        None where it could not be computed; given, if it could, even where the method does not apply.
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

    def to_dict(self):
        """Plain dict."""
        return asdict(self)


def by_limits(statistic, low, high):
    """Stiction above the upper limit, none below the lower, undecided between."""
    if statistic > high:
        return STICTION
    return SOUND if statistic < low else UNDECIDED


def why_not_applicable(oscillation, fewest_rows=0.0):
    """The sentence that says why a method for regular oscillations does not apply, or None where it does."""
    if oscillation.rows is None:
        return "No line stands in the spectrum, and the method needs an oscillation."
    if oscillation.rows < fewest_rows:
        return (
            f"A period has {oscillation.rows:.1f} rows, and the method needs {fewest_rows:.0f} or more to "
            "see its shape."
        )
    if not oscillation.regular:
        return "The loop does not oscillate regularly, and the method needs a regular oscillation."
    return None
