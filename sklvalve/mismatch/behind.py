# SPDX-License-Identifier: BSD-3-Clause
"""What lies behind a property: the search begins anew from a simulation that holds it.

A slow motor, or a dead time, is the largest thing that a simulation without it leaves out, and hides the
rest: fitted alone it bends to make up for play, and what is named beside it must be as rare as alpha twice
over. But a property is part of the sound valve. So it joins the calibration, as if it had been declared, and
what is behind it is searched and judged as a first finding.
"""

from dataclasses import replace

from sklvalve.mismatch.detect import p_value_of_one
from sklvalve.mismatch.explain import own_worth
from sklvalve.mismatch.hypothesis import Member, is_in
from sklvalve.mismatch.matters import may_explain
from sklvalve.mismatch.prove import folded, holds_out
from sklvalve.mismatch.rivals import Finding, find_rivals
from sklvalve.mismatch.verdict import class_of

# so many properties may lie one behind the other
_MOST = 2


def judged_behind(workbench, effects, judge_on, alpha):
    """Judgement of a recording, with what lies behind the actuator's properties where that is named.

    Parameters
    ----------
    workbench : Workbench
    effects : sequence of Effect
        Candidates.
    judge_on : callable
        ``judge_on(workbench, effects)`` calibrates, searches and judges; it gives the explanation, the
        circumstances and the judgement.
    alpha : float
        Level of the test.

    Returns
    -------
    judged : Judgement
    """
    explanation, circumstances, judged = judge_on(workbench, effects)
    bench, behind = workbench, None
    for _ in range(_MOST):
        held = _property_in_front(bench, explanation, circumstances, alpha)
        if held is None and bench is workbench:
            held = _likelier_alone(bench, explanation, effects, circumstances, alpha)
        if held is None:
            break
        bench = bench.holding((held,), _alone(bench, held, explanation.nominal))
        left = [e for e in effects if not is_in(e, bench.held)]
        explanation, circumstances, found = judge_on(bench, left)
        if found.verdict == "named":
            behind = bench, found, bench.noise
    return judged if behind is None else _joined(workbench, judged, effects, *behind)


def _property_in_front(workbench, explanation, circumstances, alpha):
    """The strongest thing found, where a sheet might have declared it and chance makes none as strong."""
    if not explanation.findings:
        return None
    finding = explanation.findings[0]
    member = next(iter(class_of(finding).values()))[1]
    declared = [bool(m.effect.declared_as) for _, m, _ in class_of(finding).values()]
    late = member.onset is not None
    if not any(declared) or late or member.effect.kind_of(workbench.plain, late) == "fault":
        return None
    return member if p_value_of_one(finding, workbench, circumstances) <= alpha else None


def _likelier_alone(workbench, explanation, effects, circumstances, alpha):
    """A property that by itself explains more than the strongest finding does; else None.

    The search takes up first what gains most under the noise that the nominal simulation leaves, which hides
    how much more the property explains.
    """
    if not explanation.findings:
        return None
    front, nominal, noise = explanation.findings[0].member, explanation.nominal, workbench.noise
    touched = set(workbench.channels_touched(front.effect))
    best, likeliest = None, own_worth(workbench, _alone(workbench, front, nominal, keep=True))
    for effect in effects:
        if not effect.declared_as or not touched & set(workbench.channels_touched(effect)):
            continue
        model = _alone(workbench, Member(effect), nominal, keep=True)
        without = workbench.fit((), start=nominal)
        gain = model.log_likelihood - without.log_likelihood
        found = Finding(model.members[0], [], gain, workbench.change(model, without))
        rare = p_value_of_one(found, workbench, circumstances) <= alpha
        if rare and may_explain(workbench, model, without) and own_worth(workbench, model) > likeliest:
            best, likeliest = model.members[0], own_worth(workbench, model)
    workbench.use_noise(noise)
    return best


def _alone(workbench, member, nominal, *, keep=False):
    """A property fitted without what else was found, that may have bent it; `keep` its own noise."""
    noise, model = workbench.noise, workbench.fit((member,), start=nominal)
    for _ in range(2):
        workbench.learn_noise(model)
        model = workbench.fit((member,), start=model)
    if not keep:
        workbench.use_noise(noise)
    return model


def _joined(workbench, judged, effects, bench, found, noise):
    """What was found behind the properties that `bench` holds, and those beside it."""
    own = tuple(m for m in bench.held if m not in workbench.held)
    before = workbench.noise
    workbench.use_noise(noise)
    with_own = {}

    def whole(model):
        if model not in with_own:
            with_own[model] = replace(model, members=(*own, *model.members))
        return with_own[model]

    model = whole(found.model)
    if not holds_out(workbench, judged.nominal, model):
        workbench.use_noise(before)
        return judged
    behind = [replace(f, rivals=[replace(r, model=whole(r.model)) for r in f.rivals]) for f in found.findings]
    properties = find_rivals(workbench, model, effects, None, of=own)
    return replace(
        found,
        p_value=min(p for p in (judged.p_value, found.p_value) if p is not None),
        findings=sorted([*behind, *properties], key=lambda f: f.gain, reverse=True),
        nominal=judged.nominal,
        model=model,
        evidence=judged.evidence,
        comparison=found.comparison.behind(judged.comparison),
        tried=None if found.unknown is None else folded(workbench, model, found.unknown),
    )
