# SPDX-License-Identifier: BSD-3-Clause
"""A record and its history as recordings, without a file."""

import pandas as pd

from benchmarks.concealed.again import drawn_again
from benchmarks.concealed.draw import made_of
from benchmarks.concealed.histories.hour import with_history
from sklvalve.recording import Recording, Valve


def recordings_of(case, seed, published=None):
    """Record, sheet, history and truth of a case.

    Parameters
    ----------
    case : benchmarks.concealed.cases.Case
    seed : int
        Of the plan.
    published : dict, default=None
        Truth of the record, with its sizes; they are looked for anew without it, which takes minutes.

    Returns
    -------
    record : Recording
    valve : Valve
    history : Recording
    truth : dict

    Raises
    ------
    ValueError
        If the case is possible in none of the plants that are tried.
    """
    made = made_of(case, seed) if published is None else drawn_again(case, seed, published)
    if made is None:
        raise ValueError(f"{case.name} is not possible; take another case")
    return as_recordings(with_history(case, made))


def as_recordings(made):
    """The same of a record that is drawn, with its history."""
    valve, rows = Valve.from_dict(made.valve), made.truth["rows"]
    record = {name: values[:rows] for name, values in made.table.items()}
    read = [Recording.from_frame(pd.DataFrame(table), valve) for table in (record, made.history)]
    return read[0], valve, read[1], made.truth
