# SPDX-License-Identifier: BSD-3-Clause
"""Where to begin the fit of an effect whose likelihood has many side valleys.

A stem that sticks slips when a threshold is passed. A little more or less of a parameter moves a slip by a
sample or leaves it out, and every later one with it: the error of a free run has a side valley for each way
of hitting some slips by chance. So a search comes before the fit, in three parts: on the episodes where the
simulation without the effect is furthest off; there at first with the stem drawn back to the recorded one
after each sample, so that each slip is judged by itself; then with less and less of that, down to a free run.
"""

import numpy as np
from scipy.optimize import differential_evolution, minimize
from scipy.stats import qmc

from sklvalve.mismatch.workbench import Member
from sklvalve.simulation.fitting import log_likelihood
from sklvalve.simulation.parameters import ParameterVector
from sklvalve.simulation.stages import delayed, followed_stem

_BEFORE = 60.0  # an episode begins at rest about this long [s] before what is compared
_COMPARED = 60.0  # length of what is compared [s]
_ROWS = 900  # episodes hold no more rows than this, about: what a simulation of them may cost
_LARGEST = 0.2  # what is further off than this weighs no more [1 = travel]
# share of the way that the stem is drawn back, generations, members of the population
_PARTS = ((1.0, 40, 32), (0.3, 12, 20), (0.1, 12, 20), (0.0, 16, 20))
_NARROW = 0.15  # scatter of the population around the best of the part before, in scales of the parameters
_SCAN = 48  # values of the effect's parameters tried with the actuator as it is
_REFINED = 2  # candidates refined on the whole record
_LAST_STEPS = 110  # simulations of the whole record for each of them


def rugged_start(workbench, model, effect, onset=None):
    """Values from which to fit an effect that declares itself rugged.

    Parameters
    ----------
    workbench : Workbench
    model : Model
        The hypothesis without the effect, fitted; with an opening among its predictions.
    effect : Effect
        Of the actuator's stage.
    onset : float, default=None
        Absolute time from which on it acts [s]; None from before the recording.

    Returns
    -------
    values : dict
        Parameter name -> value: those of `model`, with the effect's and the actuator's replaced. Of several
        candidates the one whose free run over the whole record is the likeliest. The same for the same
        input; the parameters of `model` with the effect's own start where there is no opening to search by.
    """
    search = _Search(workbench, model, effect, onset)
    if not search.episodes:
        return search.values(search.vector.pack(model.values))
    candidates = sorted((search.scanned(), *search.followed()), key=search.whole)
    finals = [search.refined(z) for z in candidates[:_REFINED]]
    return search.values(min(finals, key=search.whole))


def episodes_of(gap, opening, sample_time, first=0):
    """Windows in which a simulation is furthest off, each with a beginning at rest before it.

    Parameters
    ----------
    gap : ndarray of shape (n,)
        Distance of recorded and simulated opening [1].
    opening : ndarray of shape (n,)
        Recorded opening [1].
    sample_time : float
        [s].
    first : int, default=0
        First row that may be compared.

    Returns
    -------
    episodes : list of (int, int, int)
        Row at which the stem rests, first row compared, row after the last.
    """
    n, length = len(gap), max(int(_COMPARED / sample_time), 5)
    lead = max(int(_BEFORE / sample_time), 5)
    if n - first <= length:
        return []
    off = np.convolve(np.nan_to_num(gap), np.ones(length), "valid")
    off[:first] = 0.0
    found, used = [], 0
    while off.max() > 0.0:
        compared = int(np.argmax(off))
        candidates = np.arange(max(0, compared - lead - lead // 2), max(1, compared - lead // 2))
        begin = int(min(candidates, key=lambda k: _unrest(opening, k)))
        used += compared + length - begin
        if found and used > _ROWS:
            break
        found.append((begin, compared, compared + length))
        off[max(0, compared - length) : compared + length] = 0.0
    return found


def _unrest(opening, row):
    seen = opening[max(0, row - 5) : row + 1]
    seen = seen[np.isfinite(seen)]
    return float(np.ptp(seen)) if len(seen) and np.isfinite(opening[row]) else np.inf


class _Search:
    def __init__(self, workbench, model, effect, onset):
        self.members = (*model.members, Member(effect, onset))
        self.chain, self.rest = workbench.chain(self.members), dict(model.values)
        moved = [p for p in workbench.calibration(("opening",)) if p.name.startswith("actuator_")]
        # sliding friction of the effect takes the place of the sound stem's
        moved = [p for p in moved if p.name != "actuator_coulomb"]
        moved += [q.parameter_of(effect.key) for q in effect.quantities(self.chain)]
        self.vector, self.episodes = ParameterVector(moved), []
        self.noise = workbench.noise.get("opening")
        shown, usable = workbench.recording.get("opening"), "actuator_gain" in self.rest
        if shown is None or not usable or effect.stage != "actuator" or "opening" not in model.predictions:
            return
        self.shown = shown if workbench.rows is None else np.where(workbench.rows, shown, np.nan)
        gap = np.abs(self.shown - model.predictions["opening"])
        first = 0 if onset is None else int(np.searchsorted(self.chain.clock, onset))
        self.episodes = episodes_of(gap, self.shown, workbench.recording.sample_time, first)

    def values(self, z):
        """All values for a vector of those that are searched."""
        return self.rest | self.vector.values(z)

    def scanned(self):
        """The likeliest of a spread of the effect's parameters, the actuator as it was."""
        z, own = self.vector.pack(self.rest), [i for i, n in enumerate(self.vector.names) if "." in n]
        low, high = self.vector.low[own], self.vector.high[own]
        tried = np.tile(z, (_SCAN, 1))
        tried[:, own] = low + (high - low) * qmc.Halton(len(own), scramble=False).random(_SCAN + 1)[1:]
        return min((z, *tried), key=self.whole)

    def followed(self):
        """The best in the episodes after the first part, with slips judged singly, and after the last."""
        low, high, scale = self.vector.low, self.vector.high, self.vector.scale
        bounds, random = list(zip(low, high, strict=True)), np.random.default_rng(0)
        best, bests = self.vector.pack(self.rest), []
        for hold, generations, members in _PARTS:
            if hold == 1.0:
                population = random.uniform(low, high, (members, len(low)))
            else:
                scatter = random.normal(0.0, _NARROW, (members, len(low))) * np.minimum(scale, high - low)
                population = best + scatter
            population[0] = best
            found = differential_evolution(
                self.episodic,
                bounds,
                args=(hold,),
                init=np.clip(population, low, high),
                maxiter=generations,
                mutation=(0.4, 0.9),
                recombination=0.8,
                tol=1e-4,
                polish=False,
                rng=np.random.default_rng(1),
            )
            best = found.x
            bests.append(best)
        return bests[0], bests[-1]

    def refined(self, z):
        """A vector improved on the whole record, without derivatives."""
        size = np.minimum(0.1 * self.vector.scale, 0.1 * (self.vector.high - self.vector.low))
        simplex = np.vstack([z, z + np.diag(size)])
        found = minimize(
            self.whole,
            z,
            method="Nelder-Mead",
            bounds=list(zip(self.vector.low, self.vector.high, strict=True)),
            options={
                "maxfev": _LAST_STEPS,
                "initial_simplex": np.clip(simplex, self.vector.low, self.vector.high),
            },
        )
        return found.x

    def whole(self, z):
        """What a free run over the whole record costs, counted as the fit that follows counts it."""
        return -log_likelihood(self.shown - self.chain.opening(self.values(z)), self.noise)

    def episodic(self, z, hold):
        """Error in the episodes, the stem drawn back by a share `hold` after each sample [1 = travel]."""
        values = self.values(z)
        shown = self._episodes_followed(values, hold) + values.get("position_zero", 0.0)
        return self._error(shown)

    def _episodes_followed(self, values, hold):
        chain = self.chain
        n = len(chain.command)
        command = chain._through(
            "signal", delayed(chain.command, chain.time, values["actuator_delay"]), values
        )
        drive = {
            "supply": np.full(n, chain.supply),
            "coulomb": np.full(n, values["actuator_coulomb"]),
            "stick": np.zeros(n),
            "dead_band": np.zeros(n),
        }
        drive = chain._through("actuator", drive, values)
        shown = self.shown - values.get("position_zero", 0.0)
        if chain.air_closes:
            command, shown = 1.0 - command, 1.0 - shown
        stem = np.full(n, np.nan)
        for begin, compared, end in self.episodes:
            rows = slice(begin, end)
            run = followed_stem(
                command[rows],
                chain.step[rows],
                shown[begin],
                chain.spring,
                *(drive[key][rows] for key in ("supply", "coulomb", "stick", "dead_band")),
                *(values[f"actuator_{key}"] for key in ("filter", "gain", "reset", "rate")),
                values.get("actuator_feedback", 0.0),
                shown[rows],
                hold,
            )
            stem[compared:end] = run[compared - begin :]
        stem = 1.0 - stem if chain.air_closes else stem
        return chain._through("position_sensor", chain._through("stem", stem, values), values)

    def _error(self, simulated):
        gap = np.abs(self.shown - simulated)
        gap = gap[np.isfinite(gap)]
        return float(np.mean(np.minimum(gap, _LARGEST))) if len(gap) else np.inf
