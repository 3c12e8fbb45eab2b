# SPDX-License-Identifier: BSD-3-Clause
"""What else could stand in the place of an effect that was found, and how far from it that is."""

from dataclasses import dataclass, replace

import numpy as np

from sklvalve.mismatch.hypothesis import Member, Model, begun, is_in, worth
from sklvalve.mismatch.inference.posterior import distance, posterior
from sklvalve.mismatch.matters import may_be_instead
from sklvalve.mismatch.onset_sample import to_the_sample
from sklvalve.mismatch.screening import screened
from sklvalve.simulation.given import ACTUATOR_STAGES
from sklvalve.simulation.side_by_side import side_by_side

# of the rivals screened, so many are fitted with the whole calibration free, and those that come this near
_FITTED = 4
_WITHIN_REACH = 100.0


@dataclass(frozen=True, eq=False)
class Rival:
    """An explanation in the place of a finding.

    Attributes
    ----------
    member : Member
    model : Model
        The hypothesis with it in place.
    probability : float
    distance : float
        Profile-likelihood distance D from the best.
    """

    member: Member
    model: Model
    probability: float
    distance: float


@dataclass(frozen=True, eq=False)
class Finding:
    """One thing found: an effect, and those the recording cannot tell from it.

    Attributes
    ----------
    member : Member
        The most likely explanation.
    rivals : list of Rival
        Explanations in its place, its own among them, the most probable first.
    gain : float
        Log likelihood that the explanation adds to the rest of the hypothesis.
    sizes : dict
        Channel -> change that it makes, share of span [1].
    """

    member: Member
    rivals: list
    gain: float
    sizes: dict


def find_rivals(workbench, model, effects, report, seen=None, of=None):
    """For each effect found, what else could stand in its place.

    Parameters
    ----------
    workbench : Workbench
    model : Model
    effects : sequence of Effect
    report : callable or None
    seen : dict, default=None
        Effect key -> the best hypothesis with it that the search met: where else to begin.
    of : sequence of Member, default=None
        Those of the hypothesis that are asked; all unless given.

    Returns
    -------
    findings : list of Finding
        The strongest first.
    """
    findings = []
    for i, member in enumerate(model.members if of is None else of):
        rest = tuple(m for m in model.members if m is not member)
        without = workbench.fit(rest, start=model)
        others = [e for e in effects if e.key != member.effect.key and not is_in(e, rest)]
        others = [e for e in others if _touch_the_same(workbench, e, member.effect)]
        places = [(member, model)]
        instead = _others_in_place(workbench, model, rest, without, others, member, seen or {})
        places += [(who, fitted) for who, fitted in instead if may_be_instead(workbench, fitted, without)]
        gain = model.log_likelihood - without.log_likelihood
        rivals = weighed(workbench, places, without)
        findings.append(Finding(member, rivals, gain, workbench.change(model, without)))
        if report:
            report(0.8 + 0.2 * (i + 1) / len(model.members))
    return sorted(findings, key=lambda f: f.gain, reverse=True)


def without_rival(workbench, finding, model, rejected):
    """A finding without one of its rivals, the others weighed anew.

    Parameters
    ----------
    workbench : Workbench
    finding : Finding
    model : Model
        The hypothesis that stands.
    rejected : Model
        That of the rival.
    """
    left = [(r.member, r.model) for r in finding.rivals if r.model is not rejected]
    if len(left) == len(finding.rivals):
        return finding
    rest = tuple(m for m in model.members if m is not finding.member)
    return replace(finding, rivals=weighed(workbench, left, workbench.fit(rest, start=model)))


def _others_in_place(workbench, model, rest, without, others, member, seen):
    """Other effects in the place of one, each from the best of two calibrations, as (Member, Model)."""
    # that of the explanation in place, and that without it, which may have bent to make up for what it lacks
    bare = workbench.judged(workbench.simulate(rest, model.values))
    found = {}
    for base in (bare, without):
        # no race: a class is to hold all that cannot be told apart, not the best four alone
        rough = screened(workbench, base, others, onset=member.times, always=others)
        worth_it = [
            k < _FITTED
            or m.log_likelihood > model.log_likelihood - _WITHIN_REACH
            or _alike(m.members[-1].effect, member.effect)
            for k, m in enumerate(rough)
        ]
        near = [m for m, fit in zip(rough, worth_it, strict=True) if fit]
        far = [m for m, fit in zip(rough, worth_it, strict=True) if not fit]
        _keep_the_best(found, (*side_by_side(lambda m: _fitted(workbench, m), near), *far))
    met = [e for e in others if e.key in seen and _may_lie_elsewhere(e, member.effect)]
    there = [_where_it_was_met(workbench, model, rest, begun(e, member.times), seen) for e in met]
    there += _elsewhere(workbench, model, rest, member, others)
    _keep_the_best(found, side_by_side(lambda m: _fitted(workbench, m), there))
    return [(fitted.members[-1], fitted) for fitted in found.values()]


def _alike(effect, other):
    return bool(effect.alike) and effect.alike == other.alike


def _may_lie_elsewhere(effect, other):
    """Whether one effect in place of another may ask for a calibration far from the other's."""
    return _alike(effect, other) or {effect.stage, other.stage} <= set(ACTUATOR_STAGES)


def _fitted(workbench, begin):
    return to_the_sample(workbench, workbench.fit(begin.members, start=begin))


def _keep_the_best(found, models):
    for m in models:
        before = found.get(m.members[-1].effect.key)
        if before is None or m.log_likelihood > before.log_likelihood:
            found[m.members[-1].effect.key] = m


def _where_it_was_met(workbench, model, rest, member, seen):
    """A rival to be fitted from where the search met it."""
    own = (f"{member.effect.key}.", "actuator_")
    met = {name: value for name, value in seen[member.effect.key].values.items() if name.startswith(own)}
    return workbench.simulate((*rest, member), model.values | met)


def _elsewhere(workbench, model, rest, member, others):
    """Rivals in the actuator to be fitted from the calibrations that they ask for themselves."""
    if member.effect.stage not in ACTUATOR_STAGES:
        return []
    begun_anew = []
    for effect in (e for e in others if e.begins_with):
        largest = {f"{effect.key}.{q.name}": q.starts[-1] for q in effect.quantities(model.chain)}
        values = model.values | dict(effect.begins_with) | largest
        begun_anew.append(workbench.simulate((*rest, begun(effect, member.times)), values))
    return begun_anew


def weighed(workbench, places, without):
    """Explanations in one place, with distances from the best and probabilities, the most probable first.

    Parameters
    ----------
    workbench : Workbench
    places : list of (Member, Model)
    without : Model
        The hypothesis without any of them.
    """
    likelihoods = [fitted.log_likelihood for _, fitted in places]
    best = max(likelihoods)
    gain = best - without.log_likelihood
    probabilities = posterior(np.array([worth(workbench, fitted) for _, fitted in places]), gain)
    rivals = [
        Rival(who, fitted, float(probability), distance(best, likelihood, gain))
        for (who, fitted), probability, likelihood in zip(places, probabilities, likelihoods, strict=True)
    ]
    return sorted(rivals, key=lambda r: r.probability, reverse=True)


def _touch_the_same(workbench, effect, other):
    return bool(set(workbench.channels_touched(effect)) & set(workbench.channels_touched(other)))
