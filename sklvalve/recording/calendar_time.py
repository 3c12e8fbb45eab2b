# SPDX-License-Identifier: BSD-3-Clause
"""Calendar time of a recording, where its times are stamps of one clock."""


def first_stamp(whole):
    """ISO 8601 stamp of the first sample.

    Parameters
    ----------
    whole : Recording

    Returns
    -------
    stamp : str or None
        None where times are seconds, or joined recordings have clocks of their own.
    """
    first = whole.stamps[0]
    one_clock = not any(piece.assumed for piece in whole.pieces)
    return str(first).strip() if isinstance(first, str) and one_clock else None


def begins_of(whole):
    """The same as diagnosis.json has it: ``begins``, or nothing.

    Parameters
    ----------
    whole : Recording

    Returns
    -------
    begins : dict
    """
    stamp = first_stamp(whole)
    return {} if stamp is None else {"begins": stamp}
