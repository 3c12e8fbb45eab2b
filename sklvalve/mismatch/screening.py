# SPDX-License-Identifier: BSD-3-Clause
"""Which effects are worth a fit: each at several finite sizes, the calibration answering to first order.

A score test asks what an infinitely small effect would gain. A dead band has no slope at zero, and of a full
fit for every effect, size and onset most would be wasted. In between: the effect's own few parameters are
fitted by simulation, while the calibration, some twenty parameters, answers through the derivatives of the
calibrated simulation, taken once and kept within the bounds of the data sheet.
"""

import numpy as np

from sklvalve.mismatch.hypothesis import Member, Model, begun
from sklvalve.mismatch.linearised import Linearised
from sklvalve.simulation.fitting import Misfit
from sklvalve.simulation.side_by_side import side_by_side

# steps of an effect's own parameters; a fit of all that is promising follows
_STEPS = 3


def screened(workbench, model, effects, *, onset=False, report=None):
    """Hypotheses with one effect more, to first order in the calibration, the most likely first.

    Parameters
    ----------
    workbench : Workbench
    model : Model
        A fitted hypothesis.
    effects : sequence of Effect
    onset : float, tuple, None or False, default=False
        When the effects begin, stop, begin again [s, absolute], None from before the recording; by default
        each effect is tried throughout and, where it may begin within the recording, from its likeliest onset
        on.
    report : callable, default=None
        Called with the share done.

    Returns
    -------
    tried : list of Model
        One or two for each effect, their log likelihoods to first order.
    """
    touched = {e.key: workbench.channels_touched(e) for e in effects}
    effects = [e for e in effects if touched[e.key]]
    lines = {t: Linearised(workbench, model, t) for t in dict.fromkeys(touched[e.key] for e in effects)}

    def of_one(effect):
        return _of_one_effect(workbench, model, lines[touched[effect.key]], effect, onset)

    tried = []
    for i, found in enumerate(side_by_side(of_one, effects)):
        tried += found
        if report:
            report((i + 1) / len(effects))
    return sorted(tried, key=lambda m: m.log_likelihood, reverse=True)


def _of_one_effect(workbench, model, line, effect, onset):
    given = onset is not False
    member = begun(effect, onset) if given else Member(effect)
    trial = Trial(workbench, model, line, member)
    starts = trial.starts()
    errors = [line.with_priors(e) for e in trial.errors_at(starts)]
    gains = [line.gain_at_any_size(e) for e in errors]
    tried = [trial.refined(starts[int(np.argmax(gains))])]
    if effect.may_begin and not given:
        best = [line.likeliest_onset(e) for e in errors]
        k = int(np.argmax([gain for gain, _ in best]))
        late = Trial(workbench, model, line, Member(effect, best[k][1])).refined(starts[k])
        tried.append(late)
    return tried


class Trial:
    """An effect added to a linearised hypothesis.

    Parameters
    ----------
    workbench : Workbench
    model : Model
    line : Linearised
    member : Member
    """

    def __init__(self, workbench, model, line, member):
        self.model, self.line, self.member = model, line, member
        self.chain = workbench.chain((*model.members, member))
        self.quantities = member.effect.quantities(self.chain)
        self.misfit = self._misfit(workbench, 0)
        self._workbench = workbench

    def _misfit(self, workbench, attempt):
        parameters = [q.parameter_of(self.member.effect.key, attempt) for q in self.quantities]
        return Misfit(
            self.chain,
            parameters,
            self.line.channels,
            workbench.noise,
            fixed=self.model.values,
            rows=workbench.rows,
        )

    def starts(self):
        """Where the effect's own fits begin."""
        many = max(len(q.starts) for q in self.quantities)
        return [self._misfit(self._workbench, k).vector.pack({}) for k in range(many)]

    def errors_at(self, several):
        """Whitened residuals with the effect's parameters at several points, one after the other."""
        if "opening" in self.line.channels:
            self.chain.free_runs_ahead([self.misfit.values(z) for z in several])
        return [self.misfit.whitened(self.misfit.predictions(z)) for z in several]

    def refined(self, z):
        """Fit of the effect's own parameters from a start on, as a hypothesis."""
        line, vector = self.line, self.misfit.vector
        inside = 1e-6 * (vector.high - vector.low)
        z = np.clip(z, vector.low + inside, vector.high - inside)
        errors = line.with_priors(self.errors_at([z])[0])
        cost, steps = line.answered(errors)
        for _ in range(_STEPS):
            moved, reach, near = self.misfit.neighbours(z)
            beside = [line.with_priors(near.whitened(near.predictions(m))) for m in moved]
            columns = np.stack([(e - errors) / r for e, r in zip(beside, reach, strict=True)], axis=1)
            _, joint = line.answered(errors, columns, vector.low - z, vector.high - z)
            gained = 0.0
            for share in (1.0, 0.3):
                other = np.clip(z + share * joint[-len(z) :], vector.low + inside, vector.high - inside)
                tried = line.with_priors(self.errors_at([other])[0])
                lower, answer = line.answered(tried)
                if lower < cost:
                    gained = cost - lower
                    z, errors, cost, steps = other, tried, lower, answer
                    break
            if gained < 0.5 + 1e-3 * cost:
                break
        values = self.model.values | line.values(steps) | vector.values(z)
        made = line.predictions(self.misfit.predictions(z), steps)
        return Model(
            (*self.model.members, self.member),
            self.chain,
            values,
            self.model.predictions | made,
            self.model.log_likelihood + line.cost - cost,
            {},
        )
