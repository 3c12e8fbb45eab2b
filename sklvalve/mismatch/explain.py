# SPDX-License-Identifier: BSD-3-Clause
"""Which physics: effects taken up one by one, each fitted together with the calibration, and their rivals."""

from dataclasses import dataclass, field, replace

from sklvalve.mismatch.afresh import afresh, much_is_left
from sklvalve.mismatch.decide.constants import DISTINGUISHABLE
from sklvalve.mismatch.hypothesis import Member, Model, is_in, worth
from sklvalve.mismatch.matters import SPREADS, beyond_tolerance, matters, may_explain
from sklvalve.mismatch.on_and_off import in_spells
from sklvalve.mismatch.onset import fit_with_onset
from sklvalve.mismatch.onset_sample import to_the_sample
from sklvalve.mismatch.rivals import find_rivals, without_rival
from sklvalve.mismatch.scatter import SHARE_MISTAKEN, gain_in_spreads
from sklvalve.mismatch.screening import screened
from sklvalve.simulation.given import ACTUATOR_STAGES
from sklvalve.simulation.side_by_side import side_by_side

# of the effects screened, so many are fitted with the whole calibration free
_FITTED = 4
# and so many of those settled under their own noise
_TRIED = 3
# a rival so many times as probable takes the place of an effect
_CLEARLY = 30.0


@dataclass(eq=False)
class Explanation:
    """Result of the search.

    Attributes
    ----------
    nominal : Model
        The calibrated simulation without further effects, under the final noise.
    model : Model
        With the effects taken up.
    findings : list of Finding
    tried : dict
        Effect key -> (gain of its best single fit, sizes), at the first step.
    effects : tuple of Effect
        The candidates.
    """

    nominal: Model
    model: Model
    findings: list
    tried: dict = field(default_factory=dict)
    effects: tuple = ()


def explain(workbench, nominal, effects, *, threshold, most=4, report=None):
    """Search of the effects that the recording asks for.

    Parameters
    ----------
    workbench : Workbench
        With its noise learnt from `nominal`.
    nominal : Model
        The calibrated simulation.
    effects : sequence of Effect
        Candidates.
    threshold : float
        Log likelihood that an effect must add beyond its price.
    most : int, default=4
        Largest number of effects.
    report : callable, default=None
        Called with the share done.

    Returns
    -------
    explanation : Explanation
    """
    model, tried, seen = nominal, {}, {}
    model = _taken_up(workbench, model, effects, threshold, most, tried, seen, report)
    for last in (False, False, True):
        model = _what_stands(workbench, model, threshold)
        findings = find_rivals(workbench, model, effects, report, seen)
        better = _better_in_place(workbench, findings) or _simpler(workbench, findings, seen, threshold)
        if better is None or last:
            break
        noise = workbench.noise
        stood = _what_stands(workbench, _settle(workbench, better), threshold)
        if len(stood.members) < len(better.members):
            # by its own noise it explains too little to be anything at all
            workbench.use_noise(noise)
            findings = [without_rival(workbench, f, model, better) for f in findings]
            break
        workbench.learn_noise(stood, cautious=True)
        stood = workbench.fit(stood.members, start=stood)
        model = _taken_up(workbench, stood, effects, threshold, most, tried, seen, report)
    nominal = workbench.fit((), start=nominal)
    return Explanation(nominal, model, findings, tried, tuple(effects))


def _what_stands(workbench, model, threshold):
    """What remains of a hypothesis that is judged by the noise it leaves."""
    workbench.learn_noise(model)
    model = workbench.fit(model.members, start=model)
    return _drop_what_no_longer_counts(workbench, model, threshold, last_too=True)


def _taken_up(workbench, model, effects, threshold, most, tried, seen, report):
    """A hypothesis with one effect after the other taken up, as long as they matter.

    `tried` and `seen` are filled: what the first effects would gain, and the best fit met of every effect.
    """
    first = not tried and not model.members
    while len(model.members) < most:
        found = _step(workbench, model, effects, report, len(model.members) / (most + 1))
        for m in found[:_FITTED]:
            seen.setdefault(m.members[-1].effect.key, m)
        if first and not model.members:
            # what a data sheet leaves open is no mismatch, however clear it is
            beyond = [m for m in found if beyond_tolerance(workbench, m, m.members[-1])]
            for m in beyond:
                gain = m.log_likelihood - model.log_likelihood
                tried[m.members[-1].effect.key] = gain, workbench.change(m, model)
        promising = [m for m in found if matters(workbench, m, model, threshold)]
        settled = _first_that_counts(workbench, model, promising, threshold, tried)
        if settled is None and much_is_left(workbench, model):
            found = afresh(workbench, model, [e for e in effects if not is_in(e, model.members)])
            seen |= {m.members[-1].effect.key: m for m in found}
            settled = _first_that_counts(workbench, model, found, threshold, tried)
        if settled is None:
            break
        model = _drop_what_no_longer_counts(workbench, settled, threshold)
        workbench.learn_noise(model, cautious=True)
        model = workbench.fit(model.members, start=model)
    return model


def _first_that_counts(workbench, model, found, threshold, tried):
    """Of some hypotheses with one effect more the first that matters under its own noise too; else None."""
    for chosen in found[:_TRIED]:
        settled, without = _under_its_own_noise(workbench, chosen, model)
        if matters(workbench, settled, without, threshold):
            return settled
        # what a data sheet leaves open, or is absurd, speaks for no mismatch however much it gains
        if not model.members and may_explain(workbench, settled, without):
            gain = settled.log_likelihood - without.log_likelihood
            tried[chosen.members[-1].effect.key] = gain, workbench.change(settled, without)
        workbench.learn_noise(model, cautious=True)
    return None


def _under_its_own_noise(workbench, chosen, before):
    """A hypothesis by the noise that it leaves itself, and the same without its last effect."""
    settled = _settle(workbench, chosen)
    return settled, workbench.fit(settled.members[:-1], start=before)


def _better_in_place(workbench, findings):
    """A hypothesis with a rival in the place of an effect, where the recording prefers it; else None."""
    for finding in findings:
        own = next(r for r in finding.rivals if r.member is finding.member)
        for rival in finding.rivals:
            # of two that cannot be told apart either may stand in front: no reason to fit all again
            same = rival.member.effect.name == finding.member.effect.name
            if same or rival.probability <= _CLEARLY * own.probability:
                break
            without = workbench.fit(rival.model.members[:-1], start=rival.model)
            if may_explain(workbench, rival.model, without):
                return rival.model
    return None


def _simpler(workbench, findings, seen, threshold):
    """A hypothesis with a rival in place of one effect that leaves no need for another one; else None.

    What a poor choice among rivals gets wrong may pass for a second effect.
    """
    for finding in findings:
        inside = [r for r in finding.rivals if r.distance < DISTINGUISHABLE]
        for rival in inside if len(findings) > 1 else ():
            for other in rival.model.members:
                if other is rival.member:
                    continue
                rest = tuple(m for m in rival.model.members if m is not other)
                starts = [rival.model] + [seen[m.effect.key] for m in rest if m.effect.key in seen]
                fits = [workbench.fit(rest, start=start) for start in starts]
                without = max(fits, key=lambda m: m.log_likelihood)
                full = workbench.fit((*rest, other), start=rival.model)
                if not matters(workbench, full, without, threshold):
                    return without
    return None


def _step(workbench, model, effects, report, done):
    """Hypotheses with one effect more, best first: all screened, the most promising fitted."""
    usable = [e for e in effects if not is_in(e, model.members)]
    bent, also = [e for e in usable if e.stage in ACTUATOR_STAGES], []
    if bent and not any(m.effect.stage in ACTUATOR_STAGES for m in model.members):
        # calibrated to what lacks an effect, an actuator may lie where that effect no longer helps
        also = [(workbench.sound(model), bent)]
    shown = report and (lambda share: report(done + 0.1 * share))
    rough = _best_of_each(workbench, screened(workbench, model, usable, also=also, report=shown))
    onset = rough[0].members[-1].onset if rough else None
    refined = []
    for m in side_by_side(lambda m: _refine(workbench, model, m, onset), rough[:_FITTED]):
        refined.append(m)
        if report:
            report(done + 0.1 + 0.1 * len(refined) / _FITTED)
    return sorted(refined + rough[_FITTED:], key=lambda m: worth(workbench, m), reverse=True)


def _best_of_each(workbench, tried):
    """Of every effect its best hypothesis, the best first."""
    best = {}
    for m in sorted(tried, key=lambda m: worth(workbench, m), reverse=True):
        best.setdefault(m.members[-1].effect.key, m)
    return list(best.values())


def _refine(workbench, before, model, other_onset):
    """The last effect with the whole calibration free; one that begins, also from where the best one does."""
    last = model.members[-1]
    if last.onset is None:
        return in_spells(workbench, workbench.fit(model.members, start=model))
    rest = Model(before.members, before.chain, model.values, before.predictions, before.log_likelihood, {})
    onsets = {last.onset, last.onset if other_onset is None else other_onset}
    fits = [fit_with_onset(workbench, rest, last.effect, onset=o, max_steps=15) for o in sorted(onsets)]
    best = to_the_sample(workbench, max(fits, key=lambda m: m.log_likelihood))
    return in_spells(workbench, best)


def _settle(workbench, model):
    """Noise and hypothesis fitted in turn: what the new effect explains is no longer noise."""
    model = _in_turn(workbench, model)
    last = model.members[-1]
    if last.onset is not None:
        # begun where the hypothesis stands: without the effect the calibration may lie in another valley
        rest = replace(workbench.fit(model.members[:-1], start=model), values=model.values)
        begun = fit_with_onset(workbench, rest, last.effect, onset=last.onset, max_steps=15)
        model = max(model, begun, key=lambda m: m.log_likelihood)
        model = _throughout_if_likelier(workbench, model)
    return _in_spells_if_likelier(workbench, model)


def _in_spells_if_likelier(workbench, model):
    """The same effect in spells where that is likelier, each judged by its own noise."""
    spelled = in_spells(workbench, model)
    if spelled is model:
        return model
    noise, steady = workbench.noise, own_worth(workbench, model)
    spelled = _in_turn(workbench, spelled)
    if own_worth(workbench, spelled) > steady:
        return spelled
    workbench.use_noise(noise)
    return model


def _in_turn(workbench, model):
    for _ in range(2):
        workbench.learn_noise(model)
        model = workbench.fit(model.members, start=model)
    return model


def _throughout_if_likelier(workbench, model):
    """The same effect without its onset, where that is likelier when each is judged by its own noise.

    Under the noise of a simulation that lacks the effect, an onset may hide rows in which the effect is
    modelled poorly: what is left there is no stranger than the nominal's own errors. So an onset that gains
    little beside the effect itself must gain in more than one or two events.
    """
    noise, with_onset = workbench.noise, own_worth(workbench, model)
    *rest, last = model.members
    throughout = _in_turn(workbench, workbench.fit((*rest, Member(last.effect)), start=model))
    gained = with_onset - own_worth(workbench, throughout)
    if gained < 0.0:
        return throughout
    learnt = workbench.noise
    workbench.use_noise(noise)
    bare = workbench.fit(rest, start=model)
    little = gained < SHARE_MISTAKEN * (model.log_likelihood - bare.log_likelihood)
    if little and gain_in_spreads(workbench, model, throughout) < SPREADS:
        workbench.use_noise(learnt)
        return throughout
    return model


def own_worth(workbench, model):
    """As `worth`, but to be compared between noises too: wide noise costs what it makes likelier."""
    return worth(workbench, model) - sum(workbench.noise[c].log_spread for c in workbench.channels)


def _drop_what_no_longer_counts(workbench, model, threshold, *, last_too=False):
    for member in model.members if last_too else model.members[:-1]:
        without = workbench.fit(tuple(m for m in model.members if m is not member), start=model)
        again = workbench.fit((*without.members, member), start=model)
        if not (matters(workbench, again, without, threshold) and beyond_tolerance(workbench, model, member)):
            model = without
    return model
