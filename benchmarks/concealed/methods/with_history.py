# SPDX-License-Identifier: BSD-3-Clause
"""This package's finder, given an hour of the same plant from before the recording."""

from benchmarks.concealed.methods import ours


def diagnose(recording, *, folder=None, history, **settings):
    """Diagnosis by `MissingPhysicsFinder` with a history; as `ours.diagnose`.

    Parameters
    ----------
    recording : Recording
    folder : path, default=None
        Not used.
    history : list of Recording
    **settings
        Of the finder.
    """
    return ours.diagnose(recording, folder=folder, history=history, **settings)
