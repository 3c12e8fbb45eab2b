# SPDX-License-Identifier: BSD-3-Clause
"""A refit that is refused or interrupted leaves an estimator as it was: the same state, the same numbers."""

import importlib
import pkgutil
import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from sklearn.base import BaseEstimator
from sklearn.linear_model import LinearRegression

import sklvalve
from sklvalve.datasets import make_valve_recording
from sklvalve.history import Allowance, ValveHistory
from sklvalve.hybrid import ParallelHybridRegressor, SeriesHybridRegressor
from sklvalve.lssvm import LSSVMRegressor, LSSVMRegressorCV
from sklvalve.lssvm.choice import SOLVERS
from sklvalve.mechanism import ValveMechanismTransformer
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.recording import Recording, Valve
from sklvalve.simulation import ValveSimulation

FOLDER = Path(sklvalve.__file__).parent
# between the end of a block and the release of its lock a trace can raise, and a signal cannot
LOCKS = FOLDER / "lssvm" / "threads.py"
# places at which each refit is interrupted, spread evenly over the lines that it runs
PLACES = 40


def _rows(n, columns, seed, target=lambda X: np.sin(X.sum(axis=1))):
    rng = np.random.default_rng(seed)
    X = rng.normal(loc=3.0 * seed, size=(n, columns))
    return X, target(X) + 0.05 * rng.normal(size=n)


def _valve(n, seed):
    rng = np.random.default_rng(seed)
    X = rng.uniform([0.2, 5e5, 2e5], [1.0, 6e5, 4e5], (n, 3))
    return X, 40.0 * X[:, 0] ** 2 * np.sqrt((X[:, 1] - X[:, 2]) / 1e5) / 3600.0


X, Y = _rows(90, 3, 0)
OTHER = _rows(70, 4, 1)
QUERIES = _rows(25, 3, 2)[0]
VALVE, OTHER_VALVE = _valve(80, 0), _valve(60, 1)
WITH_GAP = np.where(np.eye(len(X), 3) > 0.0, np.nan, X)


@dataclass(frozen=True)
class Case:
    """A fitted estimator, what is remembered of it, refits that are refused, and one that would do."""

    fitted: Callable
    remembered: Callable
    refused: tuple
    refit: Callable


def _of_tables(make, data=(X, Y), other=OTHER, fit="fit", **more):
    """Of an estimator that is fitted to a matrix and a target."""
    A, y = data
    rows = A[:25] * 1.01

    def refit(*arguments):
        return lambda model: getattr(model, fit)(*arguments)

    with_gap = np.where(np.eye(*A.shape) > 0.0, np.nan, A)
    wrong = [
        (A[:, 0], y), (A, y[:-1]), (with_gap, y), (A, np.where(np.arange(len(y)) == 7, np.inf, y)),
        (A[:0], y[:0]), (A, y, -np.ones(len(y))), (A[:, :0], y), (None, y), (A, None),
        (np.full(other[0].shape, "a"), other[1]),
    ]  # fmt: skip
    wrong += more.get("wrong", [])
    return Case(
        lambda: make().fit(A, y),
        more.get("remembered", lambda model: model.predict(rows)),
        tuple(refit(*arguments) for arguments in wrong),
        refit(*other),
    )


def _late_refusal(solver):
    """Rows that only the solver can refuse: their kernel values overflow."""
    return (1e200 * OTHER[0], OTHER[1]) if solver != "nystrom" else (1e300 * OTHER[0], OTHER[1])


def _in_blocks(blocks):
    return lambda model: model.fit_blocks(blocks)


def _broken_blocks():
    yield OTHER[0][:30], OTHER[1][:30]
    yield OTHER[0][30:], np.full(40, np.nan)


def _two_blocks(data=(X, Y)):
    A, y = data
    return [(A[:40], y[:40]), (A[40:], y[40:])]


def _lssvm_cases():
    for solver in SOLVERS:
        yield (
            solver,
            _of_tables(
                lambda solver=solver: LSSVMRegressor(solver=solver, n_landmarks=30, random_state=0, n_jobs=1),
                wrong=[_late_refusal(solver)],
            ),
        )
    for kernel in ("linear", "poly", "laplacian", lambda a, b: float(np.exp(-np.abs(a - b).sum()))):
        yield getattr(kernel, "__name__", kernel), _of_tables(lambda kernel=kernel: LSSVMRegressor(kernel))
    yield (
        "robust and uncertain",
        Case(
            lambda: LSSVMRegressor(robust_passes=2, uncertainty=True, random_state=0).fit(X, Y),
            lambda model: np.stack(
                [*model.predict(QUERIES, return_std=True), *model.predict_interval(QUERIES)]
            ),
            (lambda model: model.fit(X, Y[:-1]), lambda model: model.fit(WITH_GAP, Y)),
            lambda model: model.fit(*OTHER),
        ),
    )
    yield (
        "precomputed",
        _of_tables(
            lambda: LSSVMRegressor("precomputed"),
            data=(X @ X.T, Y),
            other=(OTHER[0] @ OTHER[0].T, OTHER[1]),
            wrong=[(np.ones((90, 80)), Y)],
            remembered=lambda model: model.predict(QUERIES @ X.T),
        ),
    )
    blocks = Case(
        lambda: LSSVMRegressor(n_landmarks=30, random_state=0).fit_blocks(_two_blocks()),
        lambda model: model.predict(QUERIES),
        (_in_blocks([]), _in_blocks(_broken_blocks), _in_blocks(iter([OTHER])), _in_blocks([OTHER, (X, Y)])),
        _in_blocks(_two_blocks(OTHER)),
    )
    yield "fit_blocks", blocks
    yield (
        "rows added",
        Case(
            lambda: LSSVMRegressor(n_landmarks=30, random_state=0).partial_fit(X, Y),
            blocks.remembered,
            (
                lambda model: model.partial_fit(*OTHER),
                lambda model: model.partial_fit(WITH_GAP, Y),
                lambda model: model.partial_fit(X, np.column_stack([Y, Y])),
                lambda model: model.partial_fit(1e300 * X, Y),
            ),
            lambda model: model.partial_fit(X[:20] + 0.5, Y[:20]),
        ),
    )
    yield (
        "rows added to a fit",
        Case(
            lambda: LSSVMRegressor(n_landmarks=30, random_state=0).fit(X, Y),
            blocks.remembered,
            (lambda model: model.partial_fit(X, Y[:-1]), lambda model: model.partial_fit(1e300 * X, Y)),
            lambda model: model.partial_fit(*OTHER),
        ),
    )
    yield (
        "a known solution",
        Case(
            lambda: LSSVMRegressor().fit(X, Y),
            blocks.remembered,
            (
                lambda model: model.with_solution(OTHER[0], OTHER[1][:-1], 0.0),
                lambda model: model.with_solution(OTHER[0], OTHER[1], "none"),
            ),
            lambda model: model.with_solution(*OTHER, 1.0),
        ),
    )


def _hybrid_cases():
    series = {"data": VALVE, "other": OTHER_VALVE, "wrong": [(VALVE[0][:, :2], VALVE[1])]}
    yield SeriesHybridRegressor, "default", _of_tables(SeriesHybridRegressor, **series)
    log = lambda: SeriesHybridRegressor(link="log", regressor_columns=[0])  # noqa: E731
    yield SeriesHybridRegressor, "log", _of_tables(log, **series | {"wrong": [(VALVE[0], -VALVE[1])]})
    own = {"wrong": [(X, np.full(len(Y), 1e308))]}
    yield (
        ParallelHybridRegressor,
        "regressor",
        _of_tables(lambda: ParallelHybridRegressor(LinearRegression()), **own),
    )
    yield ParallelHybridRegressor, "mechanism", _of_tables(ParallelHybridRegressor, **series)


def _transformer_case():
    A = VALVE[0]
    return Case(
        lambda: ValveMechanismTransformer(kv_rated=40.0).fit(A),
        lambda model: np.column_stack([model.transform(A[:9]), model.predict(A[:9])]),
        (
            lambda model: model.fit(A[:, :2]),
            lambda model: model.fit(A[:0]),
            lambda model: model.fit(np.c_[A, np.full(len(A), np.inf)]),
            lambda model: model.set_params(features=["no such"]).fit(np.c_[A, A]),
            lambda model: model.set_params(features=["reynolds"]).fit(np.c_[A, A]),
        ),
        lambda model: model.set_params(features=["dp"]).fit(np.c_[A, A]),
    )


def _recording(effect=None, rows=600, seed=0):
    made = make_valve_recording(effect, loop="wide", n_samples=rows, n_later=0, random_state=seed)
    return Recording.from_frame(made.frame, Valve.from_dict(made.valve))


def _without(recording, *roles):
    return replace(recording, signals={r: v for r, v in recording.signals.items() if r not in roles})


def _simulation_case():
    recording, other = _recording(), _recording(rows=500, seed=1)
    return Case(
        lambda: ValveSimulation().fit(recording),
        lambda model: np.concatenate([*model.simulate(recording).values()]),
        (
            lambda model: model.fit(np.ones((9, 3))),
            lambda model: model.fit(_without(other, "flow", "opening")),
            lambda model: model.fit(other.slice(0, 1)),
            lambda model: model.set_params(effects=("no effect",)).fit(other),
        ),
        lambda model: model.fit(_without(other, "opening")),
    )


def _history_case():
    recording, other = _recording(), _recording(rows=900, seed=1)
    apart = ValveHistory().fit(other)
    return Case(
        lambda: ValveHistory().fit(recording),
        lambda model: np.concatenate([model.prior_.mean, model.prior_.covariance.ravel()]),
        (
            lambda model: model.fit([]),
            lambda model: model.fit(other.slice(0, 100)),
            lambda model: model.set_params(allowance=Allowance(capacity=-1.0)).fit(other),
            lambda model: model.set_params(effects=("no effect",)).fit(other),
            lambda model: model.update(recording),
            lambda model: model.update([other, _without(other, "opening")]),
            lambda model: model.merge(model),
            lambda model: model.merge(apart.merge(ValveHistory().fit(recording))),
        ),
        None,
    )


def _finder_case():
    recording, other = _recording(rows=900), _recording("clogging", rows=900, seed=3)

    def stopped(stage):
        def callback(now, done):
            del done
            if now == stage:
                raise KeyboardInterrupt

        return lambda model: model.set_params(callback=callback).fit(other)

    def to_a_loop(model):
        model.fit({"time": other.time, "command": other["command"], "flow": np.full(len(other), np.nan)})

    stages = ("reading", "calibrating", "looking for the unknown", "forecasting rows ahead",
              "proving on held-out rows", "done")  # fmt: skip
    return Case(
        lambda: MissingPhysicsFinder(max_effects=0, n_jobs=1).fit(recording),
        lambda model: np.r_[
            model.corrected_simulation_.predict(recording),
            model.nominal_simulation_.predict(recording),
            len(str(model.diagnosis_.to_dict())),
        ],
        (
            lambda model: model.fit(np.ones((9, 3))),
            lambda model: model.fit(other.slice(0, 20)),
            lambda model: model.fit(_without(other, "flow", "opening")),
            lambda model: model.fit(other, until=5),
            to_a_loop,
            *map(stopped, stages),
        ),
        None,
    )


def _cases():
    for name, case in _lssvm_cases():
        yield LSSVMRegressor, name, case
    yield (
        LSSVMRegressorCV,
        "one left out",
        _of_tables(
            lambda: LSSVMRegressorCV(uncertainty=True, random_state=0), wrong=[(OTHER[0][:1], OTHER[1][:1])]
        ),
    )
    yield (
        LSSVMRegressorCV,
        "blocks",
        _of_tables(lambda: LSSVMRegressorCV("laplacian", cv=3, gammas=[0.1, 0.4], random_state=0)),
    )
    yield from _hybrid_cases()
    yield ValveMechanismTransformer, "liquid", _transformer_case()
    yield ValveSimulation, "recording", _simulation_case()
    yield ValveHistory, "recording", _history_case()
    yield MissingPhysicsFinder, "recording", _finder_case()


CASES = [pytest.param(case, id=f"{kind.__name__}, {name}") for kind, name, case in _cases()]


def _equal(before, now):
    return set(before) == set(now) and all(now[name] is value for name, value in before.items())


def _state(model):
    """Everything but the parameters, which belong to the user."""
    return {name: value for name, value in vars(model).items() if name not in model.get_params(deep=False)}


class _Interruption:
    """Raises KeyboardInterrupt at the k-th line of the package that runs; counts them where k is None."""

    def __init__(self, place=None):
        self.place, self.lines = place, 0

    def __enter__(self):
        sys.settrace(self._call)
        return self

    def __exit__(self, *raised):
        sys.settrace(None)

    def _call(self, frame, event, argument):
        del event, argument
        file = frame.f_code.co_filename
        return self._line if file.startswith(str(FOLDER)) and file != str(LOCKS) else None

    def _line(self, frame, event, argument):
        del frame, argument
        if event == "line":
            if self.lines == self.place:
                raise KeyboardInterrupt
            self.lines += 1
        return self._line


def test_every_estimator_of_the_package_is_here():
    for module in pkgutil.walk_packages(sklvalve.__path__, "sklvalve."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    kinds = {k.__name__ for k in _descendants(BaseEstimator) if k.__module__.startswith("sklvalve.")}
    assert kinds == {kind.__name__ for kind, _, _ in _cases()}


def _descendants(kind):
    for each in kind.__subclasses__():
        yield each
        yield from _descendants(each)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("case", CASES)
def test_a_refused_refit_changes_nothing(case):
    model = case.fitted()
    state, remembered = _state(model), case.remembered(model)
    parameters = model.get_params(deep=False)
    for number, refused in enumerate(case.refused):
        with pytest.raises((ValueError, TypeError, AttributeError, KeyboardInterrupt)):
            refused(model)
        model.set_params(**parameters)
        assert _equal(state, _state(model)), f"refused refit {number}"
        np.testing.assert_array_equal(case.remembered(model), remembered, err_msg=f"refused refit {number}")


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("case", [case for case in CASES if case.values[0].refit is not None])
def test_an_interrupted_refit_changes_nothing_until_it_is_whole(case):
    whole = case.fitted()
    # what is loaded or compiled at the first time does not count
    case.refit(whole)
    with _Interruption() as counted:
        case.refit(whole)
    model = case.fitted()
    state, remembered = _state(model), case.remembered(model)
    parameters = model.get_params(deep=False)
    last = counted.lines - 1
    places = np.unique(np.r_[np.linspace(0, last, PLACES), last - np.arange(8)].astype(int))
    for place in places[places >= 0]:
        with pytest.raises(KeyboardInterrupt), _Interruption(place):
            case.refit(model)
        model.set_params(**parameters)
        if place == last and not _equal(state, _state(model)):
            # behind the assignment of the whole fit there is nothing left but to return
            assert set(_state(model)) == set(_state(whole))
            continue
        assert _equal(state, _state(model)), f"line {place} of {last}"
        np.testing.assert_array_equal(case.remembered(model), remembered, err_msg=f"line {place} of {last}")


def test_a_first_fit_that_is_refused_leaves_an_estimator_unfitted():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for model in (
            LSSVMRegressor(),
            LSSVMRegressorCV(),
            SeriesHybridRegressor(),
            ParallelHybridRegressor(),
        ):
            with pytest.raises(ValueError):
                model.fit(WITH_GAP, Y)
            assert not _state(model)
