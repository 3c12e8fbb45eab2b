# SPDX-License-Identifier: BSD-3-Clause
"""Forward stepwise regression by BIC over the finder's own catalogue, residuals taken for white.

    BIC = sum over the channels of n log(RSS / n) + k log(n)

Each candidate is fitted to first order in the calibration, the best few with the whole calibration free; the
lowest BIC is taken up, until none lowers it. Like any method it may know what a data sheet leaves open: an
effect within the tolerance, or smaller than what counts, is not told. It has no noise model, no onsets, no
classes of what cannot be told apart, and holds no rows back.
"""

import numpy as np
from scipy.stats import chi2

from benchmarks.concealed.methods.found import effect_of, found_of
from benchmarks.concealed.methods.nominal import nominal_of, one_thread, simulation_of, white
from sklvalve.mismatch.data.preparation import candidates
from sklvalve.mismatch.inference.hypothesis import is_in
from sklvalve.mismatch.search.relevance import beyond_tolerance
from sklvalve.mismatch.search.screening import screened
from sklvalve.recording import screen_recording

# of the candidates of one step so many are fitted with the whole calibration free
_FITTED = 5
# a difference of BIC below this is not worth more than a bare mention (Kass and Raftery 1995)
_BARE_MENTION = 2.0


def diagnose(recording, *, folder=None, alpha=0.01, most=4, practical=True):
    """Effects taken up one by one as long as BIC falls.

    Parameters
    ----------
    recording : Recording
    folder : path, default=None
        Not used.
    alpha : float, default=0.01
        Told beside the p-value; the choice is BIC's.
    most : int, default=4
        Largest number of effects.
    practical : bool, default=True
        Whether an effect must lie beyond the data sheet's tolerance and be of a size that counts.

    Returns
    -------
    found : dict
        Of each effect the best name and those that tie with it, with their BIC weights; ``simulate``.
    """
    nominal = nominal_of(recording)
    problem, model, p_value, effects = nominal.problem, nominal.model, 1.0, []
    with one_thread():
        usable, _ = candidates(problem, "all", screen_recording(recording))
        for _ in range(most):
            tried = _step(problem, model, usable, practical)
            if not tried:
                break
            best = min(tried, key=lambda m: bic(problem, m))
            lower = bic(problem, model) - bic(problem, best)
            if not effects:
                p_value = _p_value(problem, best, lower, len(usable))
            if lower <= 0.0:
                break
            effects.append(effect_of(weights(problem, tried)))
            model = best
            problem = problem.with_noise(white(problem, model))
            model = problem.fit(model.terms, start=model)
    return found_of(
        "named" if effects else "no_mismatch",
        p_value,
        effects,
        recording,
        alpha=alpha,
        simulate=simulation_of(problem, model),
        simulate_nominal=simulation_of(problem, nominal.model),
    )


def _step(problem, model, effects, practical):
    """Hypotheses with one effect more that may be told, of each effect the best."""
    free = [e for e in effects if not is_in(e, model.terms)]
    tried = sorted(screened(problem, model, free, onset=None), key=lambda m: bic(problem, m))
    fitted = [problem.fit(m.terms, start=m) for m in tried[:_FITTED]]
    tried = fitted + tried[_FITTED:]
    if not practical:
        return tried
    return [
        m
        for m in tried
        if problem.counts(problem.change(m, model)) and beyond_tolerance(problem, m, m.terms[-1])
    ]


def bic(problem, model):
    """Bayesian information criterion; the calibration's own parameters, common to all, are left out."""
    total, rows = 0.0, 0
    for left in problem.residuals(model).values():
        left = left[np.isfinite(left)]
        total += len(left) * np.log(max(np.mean(left**2), 1e-300))
        rows += len(left)
    return total + _parameters(model.terms) * np.log(rows)


def _parameters(members):
    return sum(len(m.effect.parameters) for m in members)


def weights(problem, tried):
    """BIC weights, ``exp(-BIC / 2)`` shared among all that were tried, of the best name and its ties."""
    values = np.array([bic(problem, m) for m in tried])
    values -= values.min()
    shares = np.exp(-0.5 * values)
    by_name: dict = {}
    told = set()
    for m, share, more in zip(tried, shares / shares.sum(), values, strict=True):
        name = m.terms[-1].effect.name
        by_name[name] = by_name.get(name, 0.0) + float(share)
        if more < _BARE_MENTION:
            told.add(name)
    return {name: share for name, share in by_name.items() if name in told}


def _p_value(problem, best, lower, candidates):
    """Likelihood ratio of the first effect, by chi-square and raised to the number of candidates (Sidak)."""
    rows = sum(int(np.isfinite(left).sum()) for left in problem.residuals(best).values())
    own = len(best.terms[-1].effect.parameters)
    alone = chi2.sf(max(lower + own * np.log(rows), 0.0), own)
    return float(max(-np.expm1(candidates * np.log1p(-min(alone, 1.0 - 1e-16))), 1e-12))
