# SPDX-License-Identifier: BSD-3-Clause
"""Long recordings: searched on stretches spread over them, and what is found is fitted to every row."""

from dataclasses import replace

import numpy as np

from sklvalve.mismatch.detect import mismatch_p_value
from sklvalve.mismatch.effects import EVENTS
from sklvalve.mismatch.events import simulated
from sklvalve.mismatch.gathering import without_settling
from sklvalve.mismatch.onset import best_onset
from sklvalve.mismatch.onset_sample import to_the_sample
from sklvalve.mismatch.prove import correction_holds_out, folded
from sklvalve.mismatch.pulses import find_pulses
from sklvalve.mismatch.stem_rest import stem_rest

#: Rows of one stretch: long beside the slow wander of a meter, short beside a recording of a day.
STRETCH = 640


def stretches_of(recording, most):
    """Evenly spread stretches of a recording, one behind the other, each with the times of its own.

    Parameters
    ----------
    recording : Recording
    most : int or None
        Rows to keep, about.

    Returns
    -------
    stretches : Recording
        The recording itself where it has hardly more rows than `most`. Opening and flow are gaps in the
        first rows of each stretch, in which a simulation still has to forget where it comes from.
    """
    n = len(recording)
    if most is None or n <= 1.25 * most:
        return recording
    length = min(STRETCH, most)
    many = max(most // length, 2)
    starts = np.linspace(0, n - length, many).round().astype(int)
    place = (starts[:, None] + np.arange(length)).ravel()
    signals = {role: values[place] for role, values in recording.signals.items()}
    chosen = replace(recording, time=recording.time[place], stamps=recording.stamps[place], signals=signals)
    return without_settling(chosen, np.arange(many) * length)


def over_the_whole(workbench, judged, alpha):
    """A judgement made on stretches, with its simulations fitted to every row.

    Names, classes, and the test for any mismatch stay those of the stretches; parameters, their intervals,
    onsets and what is learnt of an unknown effect's worth are of the whole.

    Parameters
    ----------
    workbench : Workbench
        Of the whole recording.
    judged : Judgement
    alpha : float
        Level of the test.

    Returns
    -------
    judged : Judgement
    """
    nominal, model = judged.nominal, judged.model
    nothing = model is nominal
    model = _fitted(workbench, simulated(model))
    nominal = workbench.least_squares(model if nothing else workbench.fit((), start=nominal))
    findings = [_finding(workbench, f, _with_events(workbench, model, judged.model)) for f in judged.findings]
    model = nominal if nothing else _with_events(workbench, workbench.least_squares(model), judged.model)
    # what comes closest and is not named is fitted no more than the rivals of what is
    closest = [replace(f, rivals=[_rival(workbench, r) for r in f.rivals]) for f in judged.closest]
    judged = replace(judged, nominal=nominal, model=model, findings=findings, closest=closest)
    if judged.suspected is not None:
        near = judged.suspected
        judged = replace(judged, suspected=workbench.simulate(near.members, near.values))
    judged = _seen_in_the_whole(workbench, judged, alpha)
    if judged.unknown is None:
        return replace(judged, tried=None)
    tried = folded(workbench, model, judged.unknown)
    kept, told = correction_holds_out(workbench, tried, judged.unknown.channel)
    return replace(judged, tried=tried, kept=kept, errors=told)


def _seen_in_the_whole(workbench, judged, alpha):
    """A judgement whose rows that speak for themselves are those of the whole; none if that shows none."""
    strays, pulses = judged.strays, judged.pulses
    if strays is None and pulses is None:
        return judged
    if strays is not None:
        strays = stem_rest(workbench, judged.nominal)
        strays = strays if strays.evident else None
    if pulses is not None:
        pulses = find_pulses(workbench, judged.nominal, alpha)
    judged = replace(judged, strays=strays, pulses=pulses)
    if strays is None and pulses is None:
        # seen in a few stretches and not in all rows: what else there was decides, as it did before
        return replace(judged, verdict="no_mismatch", p_value=mismatch_p_value(judged.evidence))
    return judged


def _with_events(workbench, model, searched):
    """A hypothesis with the events that the search told, which change no simulation."""
    told = tuple(m for m in searched.members if m.effect in EVENTS)
    if not told:
        return model
    own = tuple(f"{m.effect.key}." for m in told)
    members = (*told, *model.members)
    return replace(
        model,
        members=members,
        chain=workbench.chain(members),
        values=model.values | {k: v for k, v in searched.values.items() if k.startswith(own)},
        spreads=model.spreads | {k: v for k, v in searched.spreads.items() if k.startswith(own)},
    )


def _fitted(workbench, model):
    """A hypothesis fitted to every row, by the noise that it leaves there."""
    # rows between a stretch and the onset that it suggested must not pass for noise
    fitted = _dated(workbench, workbench.simulate(model.members, model.values))
    for _ in range(2):
        workbench.learn_noise(fitted)
        fitted = workbench.fit(fitted.members, start=fitted)
    for member in fitted.members:
        if member.onset is not None and not member.effect.grows:
            rest = tuple(m for m in fitted.members if m is not member)
            fitted = to_the_sample(workbench, workbench.fit((*rest, member), start=fitted))
    return fitted


def _dated(workbench, model):
    """A simulated hypothesis with the onsets that all rows tell; stretches leave hours between them."""
    for member in model.members:
        if member.onset is None or member.effect.grows or member.switches:
            continue
        rest = tuple(m for m in model.members if m is not member)
        without = workbench.simulate(rest, model.values)
        throughout = workbench.simulate((*rest, replace(member, onset=None)), model.values)
        moved = replace(member, onset=best_onset(workbench, without, throughout))
        model = workbench.simulate((*rest, moved), model.values)
    return model


def _finding(workbench, finding, model):
    """A finding with the parameters of the whole for the effect in place; its rivals stay, as simulated."""
    own = {m.effect.key: m for m in model.members}[finding.member.effect.key]
    searched = next(r.model for r in finding.rivals if r.member.effect.key == own.effect.key)
    # all rows are many times those searched: of likelihoods only differences go with the others
    more = model.log_likelihood - searched.log_likelihood
    rivals = [
        replace(r, member=own, model=model) if r.model is searched else _rival(workbench, r, more)
        for r in finding.rivals
    ]
    return replace(finding, member=own, rivals=rivals)


def with_every_row(workbench, finding):
    """A finding of a part of the rows with its explanations simulated in every row, as they are."""
    rivals = [_rival(workbench, r) for r in finding.rivals]
    return replace(finding, rivals=rivals)


def _rival(workbench, rival, more=0.0):
    """A rival with every row simulated, its log likelihood larger by so much."""
    model = rival.model
    made = workbench.simulate(model.members, model.values)
    made = replace(made, log_likelihood=model.log_likelihood + more, spreads=model.spreads)
    return replace(rival, model=made)
