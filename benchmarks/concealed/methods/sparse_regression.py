# SPDX-License-Identifier: BSD-3-Clause
"""Sparse regression of the calibrated simulation's residual on a dictionary of named regressors.

Orthogonal matching pursuit, after what the calibration could answer was projected away (regressing a final
residual on features measures only what the calibration had not absorbed). The number of terms is chosen by
contiguous held-out blocks and the one-standard-error rule, names by stability selection over random halves of
the blocks (Meinshausen and Buehlmann 2010). Chance is judged by residuals shifted in time against everything,
which keeps their correlation.
"""

import numpy as np

from benchmarks.concealed.methods.found import effect_of, found_of
from benchmarks.concealed.methods.nominal import nominal_of, one_thread
from benchmarks.concealed.methods.sparse_dictionary import dictionary

_BLOCKS, _MOST, _HALVES, _SHIFTS = 10, 4, 60, 199
# shares of the recording at which an effect may begin
_ONSETS = np.arange(1, 10) / 10.0
# columns as alike as this take each other's place
_ALIKE = 0.9
# of the halves so many must agree on a class
_STABLE = 0.7
# a name is told as a member of a class from this share of the class on
_MEMBER = 0.08
# of a regressor less than this left by the projection is rounding
_LEFT = 1e-3


def diagnose(recording, *, folder=None, alpha=0.01, random_state=0):
    """Names whose regressors a sparse regression selects.

    Parameters
    ----------
    recording : Recording
    folder : path, default=None
        Not used.
    alpha : float, default=0.01
    random_state : int, default=0
        Of halves and shifts.

    Returns
    -------
    found : dict
        Of each effect the names by their share in the selections.
    """
    rng = np.random.default_rng(random_state)
    with one_thread():
        nominal = nominal_of(recording)
        system = System(nominal)
        chosen = system.pursue(np.arange(_BLOCKS), system.terms())
        counting = _that_count(system, chosen, nominal)
        # the hypothesis is that nothing is larger than what counts in practice
        p_value = system.p_value(rng) if counting else 1.0
        kept, onset = [], None
        if p_value <= alpha:
            kept = _stable(system, chosen, counting, rng)
        if kept:
            begins = [system.begins[c] for c, _, _ in kept]
            onset = None if None in begins else min(begins) * float(recording.time[-1] - recording.time[0])
    effects = [effect_of(members, share) for _, members, share in kept]
    verdict = "no_mismatch" if p_value > alpha else "named" if effects else "cannot_tell"
    return found_of(verdict, p_value, effects, recording, alpha=alpha, onset=onset)


class System:
    """Residual and regressors in standard deviations of the residual, calibration projected away.

    Parameters
    ----------
    nominal : Nominal

    Attributes
    ----------
    names : list of tuple of str
        Of each column.
    begins : list of float or None
        Share of the recording at which a column begins.
    """

    def __init__(self, nominal):
        columns = dictionary(nominal)
        self.channels = nominal.problem.channels
        self.names = [c.names for c in columns for _ in range(1 + len(_ONSETS) * c.begins)]
        self.begins = [at for c in columns for at in ((None, *_ONSETS) if c.begins else (None,))]
        n = len(nominal.problem.recording)
        self._parts, self._y, own = {}, {}, np.zeros(len(self.names))
        after = {at: (np.arange(n) >= at * n).astype(float) for at in _ONSETS}
        for channels, left, slopes in _projections(nominal):
            raw = [self._raw(columns, c, after, n) for c in channels]
            index = np.unique(np.concatenate([i for i, _ in raw]))
            stacked = np.zeros((len(channels) * n, len(index)))
            for k, (i, values) in enumerate(raw):
                scale = nominal.problem.spans[channels[k]] / nominal.problem.noise[channels[k]].scale
                stacked[k * n : (k + 1) * n, np.searchsorted(index, i)] = scale * values
            # gaps count for nothing
            stacked[left == 0.0] = 0.0
            own[index] += np.sum(stacked**2, axis=0)
            projected, y = _without(slopes, stacked, left)
            for k, c in enumerate(channels):
                rows = slice(k * n, (k + 1) * n)
                self._parts[c], self._y[c] = (index, projected[rows]), y[rows]
        self._gram(len(self.names), n)
        self._own = np.maximum(own, 1e-300)
        self.norms = np.einsum("bii->i", self._grams)
        self.usable = self.norms > _LEFT * self._own

    @staticmethod
    def _raw(columns, channel, after, n):
        index, values, at = [], [], 0
        for c in columns:
            part = c.parts.get(channel)
            for begin in (None, *_ONSETS) if c.begins else (None,):
                if part is not None:
                    index.append(at)
                    values.append(part if begin is None else part * after[begin])
                at += 1
        return np.array(index, dtype=int), np.array(values).reshape(-1, n).T

    def _gram(self, many, n):
        edges = np.linspace(0, n, _BLOCKS + 1).astype(int)
        self._grams, self._rights = np.zeros((_BLOCKS, many, many)), np.zeros((_BLOCKS, many))
        self._squares = np.zeros(_BLOCKS)
        for c, (index, X) in self._parts.items():
            for b in range(_BLOCKS):
                rows = slice(edges[b], edges[b + 1])
                self._grams[b][np.ix_(index, index)] += X[rows].T @ X[rows]
                self._rights[b][index] += X[rows].T @ self._y[c][rows]
                self._squares[b] += float(self._y[c][rows] @ self._y[c][rows])

    def pursue(self, blocks, most):
        """Columns taken up one after the other on some blocks."""
        gram, right = self._grams[blocks].sum(axis=0), self._rights[blocks].sum(axis=0)
        norms = np.diag(gram)
        usable, chosen = self.usable & (norms > 0.2 * self.norms * len(blocks) / _BLOCKS), []
        for _ in range(most):
            left, rest = right, norms
            if chosen:
                inner = gram[np.ix_(chosen, chosen)] + 1e-9 * np.diag(norms[chosen])
                solved = np.linalg.solve(inner, np.column_stack([right[chosen], gram[chosen]]))
                left = right - gram[:, chosen] @ solved[:, 0]
                rest = norms - np.einsum("ij,ji->i", gram[:, chosen], solved[:, 1:])
            with np.errstate(divide="ignore", invalid="ignore"):
                gains = np.where(usable & (rest > 0.02 * norms), left**2 / rest, -1.0)
            best = int(np.argmax(gains))
            if gains[best] <= 0.0:
                break
            chosen.append(best)
        return chosen

    def weights(self, chosen, blocks):
        """Least-squares weights of columns on some blocks."""
        gram = self._grams[blocks][:, chosen][:, :, chosen].sum(axis=0)
        return np.linalg.solve(
            gram + 1e-9 * np.diag(np.diag(gram)), self._rights[blocks][:, chosen].sum(axis=0)
        )

    def terms(self):
        """How many terms held-out blocks ask for, by the rule of one standard error."""
        lost = np.zeros((_BLOCKS, _MOST + 1))
        for b in range(_BLOCKS):
            others = np.delete(np.arange(_BLOCKS), b)
            path = self.pursue(others, _MOST)
            lost[b] = self._squares[b]
            for k in range(1, len(path) + 1):
                chosen = path[:k]
                w = self.weights(chosen, others)
                gram = self._grams[b][np.ix_(chosen, chosen)]
                lost[b, k:] = self._squares[b] - 2.0 * w @ self._rights[b][chosen] + w @ gram @ w
        total = lost.sum(axis=0)
        best = int(np.argmin(total))
        for k in range(best):
            # of the difference itself, block by block: the blocks' own sizes have no part in it
            more = lost[:, k] - lost[:, best]
            if more.sum() <= np.sqrt(_BLOCKS) * np.std(more, ddof=1):
                return k
        return best

    def p_value(self, rng):
        """Share of residuals, shifted in time, that a single column fits as well."""
        n = len(next(iter(self._y.values())))
        shifts = np.concatenate([[0], rng.integers(n // 20, n - n // 20, _SHIFTS)])
        fits = np.zeros((len(self.names), len(shifts)))
        for c, (index, X) in self._parts.items():
            fits[index] += X.T @ np.column_stack([np.roll(self._y[c], s) for s in shifts])
        if not self.usable.any():
            return 1.0
        best = np.max(fits[self.usable] ** 2 / self.norms[self.usable, None], axis=0)
        return float((1.0 + np.sum(best[1:] >= best[0])) / (1.0 + _SHIFTS))

    def alike(self, column):
        """Size of the cosine of every column with one."""
        gram = self._grams[:, column].sum(axis=0)
        return np.abs(gram) / np.sqrt(np.maximum(self.norms * self.norms[column], 1e-300))

    def sizes(self, column, weight, nominal):
        """Change by one column, rms where it acts, by channel as share of span."""
        told = {}
        for c, (index, X) in self._parts.items():
            at = np.flatnonzero(index == column)
            if len(at):
                unit = nominal.problem.noise[c].scale / nominal.problem.spans[c]
                gap = np.abs(weight * X[:, at[0]]) * unit
                acting = gap > 0.25 * np.quantile(gap, 0.99)
                told[c] = float(np.sqrt(np.mean(gap[acting] ** 2))) if acting.any() else 0.0
        return told


def _that_count(system, chosen, nominal):
    """Of columns chosen those whose change is of a size that counts."""
    if not chosen:
        return []
    weights = system.weights(chosen, np.arange(_BLOCKS))
    sizes = [system.sizes(c, w, nominal) for c, w in zip(chosen, weights, strict=True)]
    return [c for c, size in zip(chosen, sizes, strict=True) if nominal.problem.counts(size)]


def _stable(system, chosen, counting, rng):
    """Of the columns that count those that halves of the recording choose too: (column, members, share)."""
    halves = [rng.choice(_BLOCKS, _BLOCKS // 2, replace=False) for _ in range(_HALVES)]
    picked = [system.pursue(half, len(chosen)) for half in halves]
    kept, told = [], set()
    for column in counting:
        members, share = _votes(system, column, picked)
        members = {name: vote for name, vote in members.items() if name not in told}
        if sum(members.values()) >= _STABLE:
            told |= set(members)
            kept.append((column, members, share))
    return kept


def _votes(system, column, picked):
    """Names that selections hold in the place of a column, by their share, and how many hold any."""
    alike = system.alike(column)
    places = [
        [c for c in path if alike[c] >= _ALIKE or system.names[c] == system.names[column]] for path in picked
    ]
    share, votes = float(np.mean([bool(place) for place in places])), {}
    for place in filter(None, places):
        names = system.names[place[0]]
        for name in names:
            votes[name] = votes.get(name, 0.0) + 1.0 / (len(names) * len(picked))
    return {name: vote for name, vote in votes.items() if vote >= _MEMBER}, share


def _projections(nominal):
    """Channels that share parameters, their whitened residuals, and slopes with the priors' below."""
    problem, model = nominal.problem, nominal.model
    for misfit in problem.misfits(model, problem.channels):
        z = misfit.vector.pack(model.values)
        errors = misfit.errors(z)
        slopes = misfit.slopes(z, errors)
        margin = 1e-3 * misfit.vector.scale
        # a parameter at its bound cannot answer
        free = (z > misfit.vector.low + margin) & (z < misfit.vector.high - margin)
        rows = len(misfit.channels) * len(problem.recording)
        yield misfit.channels, errors[:rows], slopes[:, free]


def _without(slopes, columns, left):
    """Columns and residual without what the calibration would answer, its priors counted."""
    above, normal = slopes[: len(left)], slopes.T @ slopes
    inverse = np.linalg.pinv(normal, rcond=1e-10, hermitian=True)
    return (
        columns - above @ (inverse @ (above.T @ columns)),
        left - above @ (inverse @ (above.T @ left)),
    )
