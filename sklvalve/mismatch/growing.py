# SPDX-License-Identifier: BSD-3-Clause
"""From when on an effect grows: with another onset it is another signal, so each is fitted."""

import numpy as np

from sklvalve.mismatch.hypothesis import FIRST_ONSET, LAST_ONSET, Member

# shares of the record: an onset is looked for in steps of a fifth first, then finer
_COARSE, _FINE = 0.2, 0.01


def fit_growing(workbench, model, effect, *, onset, **options):
    """Fit of an effect that grows from a moment within the recording.

    The likelihood over the onset has one broad top, for a ramp that begins too early or too late answers with
    its slope: so the onset walks uphill, by steps that halve.

    Parameters
    ----------
    workbench : Workbench
    model : Model
        The hypothesis so far.
    effect : Effect
    onset : float
        Where to begin the search [s, absolute].
    **options
        Of `Workbench.fit`.

    Returns
    -------
    fitted : Model
    """
    clock = workbench.plain.clock
    first, last = (float(clock[int(share * (len(clock) - 1))]) for share in (FIRST_ONSET, LAST_ONSET))
    fits = {}

    def fitted_at(moment):
        moment = float(np.clip(moment, first, last))
        if moment not in fits:
            start = max(fits.values(), key=lambda m: m.log_likelihood, default=model)
            fits[moment] = workbench.fit((*model.members, Member(effect, moment)), start=start, **options)
        return moment

    best, reach = fitted_at(onset), _COARSE * (last - first)
    while reach > _FINE * (last - first):
        there = max(
            (best, fitted_at(best - reach), fitted_at(best + reach)), key=lambda w: fits[w].log_likelihood
        )
        if there == best:
            reach *= 0.5
        best = there
    return fits[best]
