# SPDX-License-Identifier: BSD-3-Clause
"""The search: when an effect begins, whether it begins at all, and which rival takes its place."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.hypothesis import Term, complexity_penalty
from sklvalve.mismatch.search import explain, onset, own_noise, relevance, settling, taking_up
from sklvalve.mismatch.search.rivals import Rival
from sklvalve.recording import Recording, Valve

CLOGGING, LEAK, DEAD = (
    next(e for e in CATALOGUE if e.key == key) for key in ("clogging", "seat_leakage", "dead_time")
)


class _Bench:
    """Fits whose likelihoods are known: of onsets, and under the noise that each model leaves."""

    channels = ("flow",)

    def __init__(self, likelihoods, spreads, log_spread=0.0):
        self.likelihoods, self.spreads = likelihoods, spreads
        self.recording = _Rows(1000)
        self.plain = SimpleNamespace(clock=np.arange(1000.0))
        self.noise = {"flow": SimpleNamespace(log_spread=log_spread)}

    def fit(self, members, *, start=None, **options):
        members = tuple(members)
        which = members[-1].onset if members else "without"
        return SimpleNamespace(terms=members, values={}, log_likelihood=self.likelihoods[which])

    def simulate(self, members, values):
        return None

    def judged(self, model):
        """Far less likely by the noise that another model left."""
        own = self.noise["flow"].log_spread == self.spreads[model.terms[-1].onset]
        return SimpleNamespace(**vars(model) | {"log_likelihood": model.log_likelihood if own else -1e9})

    def with_noise_of(self, model):
        return _Bench(self.likelihoods, self.spreads, self.spreads[model.terms[-1].onset])


class _Rows:
    sample_time = 1.0

    def __init__(self, n):
        self.n = n

    def __len__(self):
        return self.n


def test_onset_moves_only_where_the_fit_becomes_likelier(monkeypatch):
    bench = _Bench({500.0: -100.0, 620.0: -80.0, 300.0: -90.0}, {})
    suggested = iter([620.0, 300.0, 500.0])
    monkeypatch.setattr(onset, "best_onset", lambda *args: next(suggested))
    found = onset.fit_with_onset(bench, SimpleNamespace(terms=()), LEAK)
    assert found.terms[-1].onset == 620.0
    assert found.log_likelihood == -80.0


# what acts throughout leaves less; more, in many events; more, in one event; more, and that is most of it
@pytest.mark.parametrize(
    ("spread", "without", "events", "kept"),
    [(900.0, -900.0, 9.0, None), (1100.0, -900.0, 9.0, 400.0), (1100.0, -900.0, 1.0, None),
     (1100.0, -90.0, 1.0, 400.0)],
)  # fmt: skip
def test_an_onset_is_judged_by_the_noise_that_it_leaves(monkeypatch, spread, without, events, kept):
    # by the same noise the onset is the likelier one
    likelihoods = {400.0: -50.0, None: -60.0, "without": without}
    bench = _Bench(likelihoods, {400.0: 1000.0, None: spread})
    monkeypatch.setattr(settling, "gain_in_spreads", lambda *args: events)
    # as if every row told when it began
    monkeypatch.setattr(
        own_noise, "penalty_with_times", lambda bench, _, term: complexity_penalty(bench, term)
    )
    model = bench.fit((Term(LEAK, 400.0),))
    before = bench.with_noise_of(model)
    after, found = settling._throughout_if_likelier(before, model)
    assert found.terms[-1].onset == kept
    assert (after is before) == (kept is not None)


def test_a_rival_takes_the_place_only_where_it_is_preferred_and_could_stand_alone(monkeypatch):
    monkeypatch.setattr(explain, "may_explain", lambda bench, model, without: model.able)
    bench = SimpleNamespace(fit=lambda members, start: None)
    place = Term(CLOGGING)

    def better(*rivals):
        """Of (probability, whether it could stand alone), the most probable first; the last has the place."""
        fits = [SimpleNamespace(terms=(Term(LEAK),), able=able) for _, able in rivals]
        who = [Term(LEAK) for _ in rivals[:-1]] + [place]
        told = [Rival(m, f, p, 0.0) for m, f, (p, _) in zip(who, fits, rivals, strict=True)]
        found = explain._better_in_place(bench, [SimpleNamespace(term=place, rivals=told)])
        return None if found is None else fits.index(found)

    assert better((0.55, True), (0.45, True)) is None
    assert better((0.9, True), (0.1, True)) is None
    assert better((0.99, True), (0.01, True)) == 0
    assert better((0.99, False), (0.01, True)) is None
    assert better((0.6, False), (0.39, True), (0.01, True)) == 1


def test_what_is_taken_up_next_is_held_against_the_same_noise(monkeypatch):
    """A rival that took the place of an effect is fitted anew by the noise with which the search goes on."""
    place, judged = Term(LEAK), []

    class Bench:
        def __init__(self, noise="first"):
            self.noise = noise

        def fit(self, members, *, start=None):
            return SimpleNamespace(terms=tuple(members), by=self.noise)

        def with_noise_of(self, model, *, cautious=False):
            return Bench("cautious" if cautious else "its own")

    def taken_up(search, problem, model):
        judged.append((problem.noise, model.by))
        return problem, problem.fit((place,))

    def what_stands(problem, model, threshold):
        problem = problem.with_noise_of(model)
        return problem, problem.fit((place,))

    bench = Bench()
    better = iter([SimpleNamespace(terms=(place,)), None])
    monkeypatch.setattr(explain.Search, "taken_up", taken_up)
    monkeypatch.setattr(explain, "_what_stands", what_stands)
    monkeypatch.setattr(explain, "_better_in_place", lambda *_: next(better))
    monkeypatch.setattr(explain, "settled_fit", lambda b, model: (b, model))
    monkeypatch.setattr(explain, "find_rivals", lambda *_, **__: [])
    explain.explain(bench, bench.fit(()), (), threshold=1.0)
    assert judged == [("first", "first"), ("cautious", "cautious")]


@pytest.mark.parametrize("own_noise_asks", [True, False])
@pytest.mark.parametrize(
    ("so_far", "much", "taken"),
    [
        (LEAK, {"flow": True}, {CLOGGING}),
        (LEAK, {"flow": False}, None),
        (LEAK, {"flow": None}, None),
        (LEAK, None, None),
        (DEAD, {"opening": True}, None),
        (DEAD, {"opening": False}, None),
    ],
    ids=["much", "little", "not known", "no history", "much elsewhere", "little elsewhere"],
)
def test_beside_a_history_what_is_left_asks_for_one_effect_more(
    monkeypatch, own_noise_asks, so_far, much, taken
):
    """Noise learnt anew is asked where that is not much, or not known, and in signals of their own."""
    touched = {LEAK: "flow", CLOGGING: "flow", DEAD: "opening"}
    problem = SimpleNamespace(touched_by=lambda terms: {touched[m.effect] for m in terms})
    monkeypatch.setattr(taking_up, "penalised_by_its_noise", lambda problem, model: 0.0)
    monkeypatch.setattr(taking_up, "explains_as_much", lambda *_: not own_noise_asks)
    model = SimpleNamespace(terms=(Term(so_far),))

    def leaves_much(bench, which, channels):
        assert (bench, which) == (problem, model)
        return much[next(iter(channels))]

    search = taking_up.Search((), 1.0, 4, None, None if much is None else leaves_much)
    counting = [(None, SimpleNamespace(terms=(Term(so_far), Term(CLOGGING))))]
    found = {more.terms[-1].effect for _, more in search._adding(problem, model, counting)}
    assert found == (({CLOGGING} if own_noise_asks else set()) if taken is None else taken)


def test_two_effects_that_take_each_others_place_end_the_search(monkeypatch):
    asked = []

    class Bench:
        def fit(self, members, *, start=None):
            return SimpleNamespace(terms=tuple(members))

        def with_noise_of(self, model, *, cautious=False):
            return self

    def next_effect(search, problem, model, *, first):
        assert len(asked) < 9, "the search goes on for ever"
        asked.append(LEAK if [m.effect for m in model.terms] == [CLOGGING] else CLOGGING)
        return problem, model, SimpleNamespace(terms=(*model.terms, Term(asked[-1])))

    monkeypatch.setattr(taking_up.Search, "_next_effect", next_effect)
    monkeypatch.setattr(
        taking_up, "drop_what_no_longer_counts", lambda _, m, threshold: SimpleNamespace(terms=m.terms[-1:])
    )
    _, model = taking_up.Search((), 1.0, 4, None, None).taken_up(Bench(), SimpleNamespace(terms=()))
    assert asked == [CLOGGING, LEAK, CLOGGING]
    assert [m.effect for m in model.terms] == [CLOGGING]


def test_what_the_data_hide_is_no_candidate_and_stands_in_the_place_of_what_is_found(monkeypatch):
    asked = {}
    bench = SimpleNamespace(fit=lambda members, **_: SimpleNamespace(terms=members, log_likelihood=0.0))
    monkeypatch.setattr(explain.Search, "taken_up", lambda s, p, m: asked.update(search=s.effects) or (p, m))
    monkeypatch.setattr(explain, "_what_stands", lambda problem, model, _: (problem, model))

    def rivals(problem, model, effects, *_, **__):
        asked["rivals"] = tuple(effects)
        return []

    monkeypatch.setattr(explain, "find_rivals", rivals)
    explain.explain(bench, bench.fit(()), (CLOGGING,), threshold=1.0, hidden=(LEAK,))
    assert asked == {"search": (CLOGGING,), "rivals": (CLOGGING, LEAK)}


def test_what_begins_is_seen_acting_throughout_too():
    made = make_valve_recording(
        "seat_leakage", 0.1, onset=400.0, n_samples=1200, n_later=0, loop="wide", random_state=2
    )
    recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    seen = MissingPhysicsFinder(effects=["seat_leakage"], n_jobs=1).fit(recording).evidence_.effect_sizes
    for look in ("within", "throughout"):
        assert seen[look]["seat_leakage"] > 2.0


@pytest.mark.slow
def test_play_is_found_alone_also_in_the_first_rows_of_a_recording():
    made = make_valve_recording("backlash", 0.04, n_samples=2400, n_later=0, loop="wide", random_state=2)
    recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    diagnosis = MissingPhysicsFinder().fit(recording, until=1800).diagnosis_
    assert diagnosis.effects == (("backlash",),)
    content = diagnosis.content
    assert content["location"]["onset"] is None
    assert content["effects"][0]["parameters"]["width"]["value"] == pytest.approx(0.04, rel=0.1)
    # after strokes the stem swings between the samples: without that the error was five times as large
    assert content["fit"]["flow"]["rmse"]["corrected"] < 0.3 * content["fit"]["flow"]["rmse"]["nominal"]


@pytest.mark.parametrize(
    ("onset", "beyond", "size", "absurd", "able"),
    [
        (None, True, 0.006, False, True),
        (None, False, 0.006, False, False),
        (400.0, False, 0.006, False, True),
        (400.0, True, 0.006, True, False),
        # of half a percent that counts it makes more than half, or less
        (None, True, 0.003, False, True),
        (400.0, True, 0.002, False, False),
    ],
)
def test_a_rival_of_what_began_may_be_shorter_and_smaller_than_what_alone_is_told(
    monkeypatch, onset, beyond, size, absurd, able
):
    monkeypatch.setattr(relevance, "beyond_tolerance", lambda *_: beyond)
    monkeypatch.setattr(relevance, "_absurd", lambda *_: absurd)
    model = SimpleNamespace(terms=(Term(LEAK, onset),))
    bench = SimpleNamespace(
        change=lambda *_: {"flow": size},
        counts=lambda sizes: any(s >= 0.005 for s in sizes.values()),
        baseline=lambda _model, _terms, fitted: fitted,
    )
    assert relevance.may_be_instead(bench, model, None) is able
