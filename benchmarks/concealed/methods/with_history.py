# SPDX-License-Identifier: BSD-3-Clause
"""This package's finder, given an hour of the same plant from before the recording."""

from benchmarks.concealed.methods import ours
from sklvalve import MissingPhysicsFinder


def learn(recordings):
    """What `diagnose` is given: learnt from recordings diagnosed by themselves, as `sklvalve learn` does.

    Parameters
    ----------
    recordings : list of Recording

    Returns
    -------
    history : ValveHistory
    """
    return MissingPhysicsFinder(n_jobs=1).history_of(recordings)


def diagnose(recording, *, folder=None, history, **settings):
    """Diagnosis by `MissingPhysicsFinder` with a history; as `ours.diagnose`.

    Parameters
    ----------
    recording : Recording
    folder : path, default=None
        Not used.
    history : ValveHistory
    **settings
        Of the finder.
    """
    return ours.diagnose(recording, folder=folder, history=history, **settings)
