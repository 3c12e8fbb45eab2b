# SPDX-License-Identifier: BSD-3-Clause
"""Is there any mismatch at all: one p-value for the whole search."""

import numpy as np
from scipy.stats import chi2


def mismatch_p_value(findings, tried, unknown, workbench, n_candidates):
    """Probability that a healthy recording looks as far from its simulation as this one, or further.

    The hypothesis tested is that no effect is larger than what counts in practice: the likelihood ratio of
    each effect is taken from there on, in standard deviations of its size, and the least of the p-values is
    raised to the number of candidates and onsets tried (Sidak).

    Parameters
    ----------
    findings : list of Finding
    tried : dict
        Effect key -> (gain of its best single fit, sizes), where nothing was found.
    unknown : Unknown or None
    workbench : Workbench
    n_candidates : int
        Number of effects tried.

    Returns
    -------
    p_value : float
        Never below 1e-12: no noise model is that good.
    """
    least = workbench.least
    seen = [(f.gain, f.sizes, len(f.member.effect.parameters)) for f in findings]
    if not seen:
        seen = [(gain, sizes, 2) for gain, sizes in tried.values()]
    p_values = [1.0]
    # an onset may stand anywhere, though neighbours look alike: about as many as log2 of the rows
    tries = n_candidates * np.log2(max(len(workbench.recording), 4))
    for gain, sizes, parameters in seen:
        beyond = max(max(1.0 - least(c) / size, 0.0) if size > 0.0 else 0.0 for c, size in sizes.items())
        alone = chi2.sf(2.0 * max(gain, 0.0) * beyond**2, parameters + 1)
        p_values.append(-np.expm1(tries * np.log1p(-min(alone, 1.0 - 1e-16))))
    if unknown is not None:
        p_values.append(unknown.p_value)
    return float(max(min(p_values), 1e-12))
