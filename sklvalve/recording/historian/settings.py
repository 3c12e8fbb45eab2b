# SPDX-License-Identifier: BSD-3-Clause
"""How an export is to be read, where it does not tell itself."""

from dataclasses import dataclass

from sklvalve.recording.errors import InputError


@dataclass(frozen=True)
class ImportSettings:
    """How an export is to be read, where it does not tell itself.

    Parameters
    ----------
    zone : str or None
        Time zone of local times, by name or offset from UTC.
    period : float or None
        Period of the recording [s]; None chooses it from the stamps.
    gap : float
        Longest stretch without a report that is bridged, in a tag's usual steps.
    day_first : bool or None
        Whether 03/04/2024 is the third of April; None finds out.
    decimal : {".", ","} or None
        Decimal mark; None finds it.
    encoding : str or None
        Encoding of the files; None finds it.
    keep_uncertain : bool
        Whether values of uncertain quality count.
    hold, linear : tuple of str
        Tags that hold their last value, or run straight, between reports, whatever their names say.
    time_column : str or None
        Name of the column of the times; None finds it.
    skip_rows : int
        Lines at the beginning of each file that are left out.
    header : int or None
        Line of each file, counted from 1, in which the names of the columns stand; 0 where there are none;
        None finds it.
    begin, end : str or None
        First and last time to be kept, as the recording writes its own; local ones may lack the offset. An
        `end` that is a day includes that day.
    """

    zone: str | None = None
    period: float | None = None
    gap: float = 5.0
    day_first: bool | None = None
    decimal: str | None = None
    encoding: str | None = None
    keep_uncertain: bool = False
    hold: tuple[str, ...] = ()
    linear: tuple[str, ...] = ()
    time_column: str | None = None
    skip_rows: int = 0
    header: int | None = None
    begin: str | None = None
    end: str | None = None

    @property
    def cuts(self) -> bool:
        """Whether some times only are kept."""
        return self.begin is not None or self.end is not None

    def __post_init__(self) -> None:
        if self.skip_rows < 0:
            raise InputError(f"skip_rows must be 0 or more; got {self.skip_rows}")
        if self.header is not None and (self.header < 0 or 0 < self.header <= self.skip_rows):
            raise InputError(
                f"--header {self.header}: the names must stand below the {self.skip_rows} lines that are "
                "left out; lines are counted from the first of the file"
            )
