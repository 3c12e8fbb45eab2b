# SPDX-License-Identifier: BSD-3-Clause
"""A random forest on features of the residual, trained on recordings of the package's own simulation.

    python -m benchmarks.concealed.methods.random_forest FOLDER [--each 20] [--healthy 300] [--seed 0]

makes the training set and the forest once and keeps both in FOLDER. Everything that could be tuned is tuned
on trees that had not seen a recording (out of bag): the level of the test for any mismatch, and the
probability from which on a name is told.
"""

import argparse
from dataclasses import replace
from pathlib import Path
from zlib import crc32

import joblib
import numpy as np
from sklearn.ensemble import RandomForestClassifier

from benchmarks.concealed.methods.forest_features import features
from benchmarks.concealed.methods.forest_records import candidates_for_training, draw_recording
from benchmarks.concealed.methods.found import effect_of, found_of
from benchmarks.concealed.methods.nominal import nominal_of, one_thread
from sklvalve.recording import InputError

NOTHING = "nothing"
FILE = "random_forest.joblib"
# of the recordings that the forest was not trained on so many may be given a wrong name
_WRONG = 0.03
# so many of the forest's classes are told at most
_CLASS = 2
# names whose signals are the same, or nearly, whatever the recording: one class of the forest
_SAME = (
    ("seat_leakage", "bypass_open"),
    ("piping_reducers", "line_loss"),
    ("flow_meter_gain", "capacity_error", "density_change"),
    ("inlet_pressure_bias", "outlet_pressure_bias"),
    ("sedimentation", "flow_meter_drift"),
    ("friction", "presliding"),
    ("transducer_fault", "positioner_feedback_fault"),
    ("viscous_flow", "viscosity_change"),
)
_LABELS = {name: "/".join(names) for names in _SAME for name in names}
# so many recordings lack the position, and so many the pressures
_WITHOUT = 0.12
_DROPPED = {"opening": ("opening",), "pressures": ("p1", "p2")}
_LOADED: dict = {}


def train(folder, *, each=20, healthy=300, random_state=0, trees=600, names=None, report=None):
    """Make the training set and the forest.

    Parameters
    ----------
    folder : path
        Where both are kept; a training set that lies there already is used.
    each, healthy : int
        Recordings of every effect, and with nothing in them.
    random_state : int, default=0
    trees : int, default=600
    names : sequence of str, default=None
        Effects to be told apart; all of the catalogue unless given.
    report : callable, default=None
        Called with the number of recordings made and their name.

    Returns
    -------
    forest : dict
        The classifier, the names of its features, the healthy recordings' out-of-bag probabilities of
        nothing, and the least probability of a name.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    forms = candidates_for_training()
    wanted = {name: forms[name] for name in (forms if names is None else names)}
    told = crc32("+".join(wanted).encode())
    kept = folder / f"training_{each}_{healthy}_{random_state}_{told:08x}.npz"
    if not kept.exists():
        _make_training_set(kept, wanted, each, healthy, random_state, report)
    stored = np.load(kept)
    table, labels = stored["table"], np.array([_LABELS.get(n, n) for n in stored["labels"].tolist()])
    classifier = RandomForestClassifier(
        trees,
        min_samples_leaf=2,
        class_weight="balanced_subsample",
        oob_score=True,
        random_state=random_state,
    ).fit(table, labels)
    forest = {"classifier": classifier, "features": stored["names"].tolist()} | _tuned(classifier, labels)
    joblib.dump(forest, folder / FILE, compress=3)
    _LOADED.pop(folder / FILE, None)
    return forest


def _make_training_set(kept, wanted, each, healthy, random_state, report):
    rows, labels = [], []
    plan = [(NOTHING, (), healthy), *((n, forms, each) for n, forms in wanted.items())]
    for k, (name, forms, many) in enumerate(plan):
        # each name its own source: another number of recordings of one does not change the others
        rng, made = np.random.default_rng([random_state, k]), 0
        for _ in range(4 * many):
            found = _drawn_features(rng, forms)
            if found is not None:
                rows.append(found)
                labels.append(name)
                made += 1
            if made == many:
                break
        if report:
            report(len(rows), name)
    names = sorted(rows[0])
    table = np.array([[row[name] for name in names] for row in rows], dtype=np.float32)
    np.savez_compressed(kept, table=table, names=np.array(names), labels=np.array(labels))


def _drawn_features(rng, forms):
    recording = draw_recording(rng, forms)
    lacks = rng.uniform()
    if recording is None:
        return None
    needs = {role for effect in forms for role in effect.needs}
    for share, roles in zip((_WITHOUT, 2.0 * _WITHOUT), _DROPPED.values(), strict=True):
        if lacks < share:
            if not needs & set(roles):
                recording = _without(recording, roles)
            break
    try:
        return features(nominal_of(recording))
    except InputError:
        return None


def _without(recording, roles):
    return replace(recording, signals={r: v for r, v in recording.signals.items() if r not in roles})


def _tuned(classifier, labels):
    """Levels from out-of-bag votes: how healthy ones look, and from where on names are hardly ever wrong."""
    votes, classes = classifier.oob_decision_function_, classifier.classes_
    nothing = int(np.flatnonzero(classes == NOTHING)[0])
    healthy = np.sort(votes[labels == NOTHING, nothing])
    order = [_told(dict(zip(classes, v, strict=True)), 0.0) for v in votes]
    sums = np.array([sum(members.values()) for members in order])
    wrong = np.array([name not in members for name, members in zip(labels, order, strict=True)])
    missed = np.array([_p_value(healthy, v[nothing]) > 0.01 for v in votes])
    least = 1.0
    for level in np.arange(0.95, 0.1, -0.01):
        if np.mean(wrong & ~missed & (sums >= level)) > _WRONG:
            break
        least = float(level)
    return {"healthy": healthy, "least": least}


def _p_value(healthy, nothing):
    return (1.0 + np.searchsorted(healthy, nothing, side="right")) / (1.0 + len(healthy))


def _told(votes, least):
    """The most probable classes of the forest, as few as reach the least probability."""
    names = sorted((n for n in votes if n != NOTHING), key=lambda n: -votes[n])
    total = max(1.0 - votes[NOTHING], 1e-9)
    members: dict = {}
    for name in names[:_CLASS]:
        members[str(name)] = float(votes[name]) / total
        if sum(members.values()) >= max(least, 0.5):
            break
    return members


def _by_name(members):
    """Names of classes of the forest; names of one class share its probability."""
    return {name: p / len(label.split("/")) for label, p in members.items() for name in label.split("/")}


def diagnose(recording, *, folder=None, alpha=0.01):
    """The class that the forest votes for.

    Parameters
    ----------
    recording : Recording
    folder : path
        That of `train`.
    alpha : float, default=0.01

    Returns
    -------
    found : dict
        At most one effect, with the names that it may have.

    Raises
    ------
    FileNotFoundError
        If there is no trained forest in the folder.
    """
    forest = _forest(folder)
    with one_thread():
        found = features(nominal_of(recording))
    row = np.array([[found[name] for name in forest["features"]]], dtype=np.float32)
    classifier = forest["classifier"]
    votes = dict(zip(classifier.classes_, classifier.predict_proba(row)[0], strict=True))
    p_value = _p_value(forest["healthy"], votes[NOTHING])
    members = _told(votes, forest["least"])
    verdict, effects = "no_mismatch", []
    if p_value <= alpha:
        verdict = "named" if sum(members.values()) >= forest["least"] else "cannot_tell"
        effects = [effect_of(_by_name(members))]
    return found_of(verdict, p_value, effects, recording, alpha=alpha)


def _forest(folder):
    path = Path(folder or ".") / FILE
    if path not in _LOADED:
        if not path.exists():
            raise FileNotFoundError(
                f"expected a trained forest at {path}; make it with "
                "python -m benchmarks.concealed.methods.random_forest FOLDER, and give that folder"
            )
        _LOADED[path] = joblib.load(path)
    return _LOADED[path]


def learn(folder, **sizes):
    """Train a forest into a folder, unless it holds one."""
    if not (folder / FILE).exists():
        folder.mkdir(parents=True, exist_ok=True)
        train(folder, **sizes)


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Train the random forest of the benchmark.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--each", type=int, default=20, help="recordings of every effect")
    parser.add_argument("--healthy", type=int, default=300, help="recordings with nothing in them")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    more = {"each": options.each, "healthy": options.healthy, "random_state": options.seed}
    forest = train(options.folder, **more, report=lambda many, name: print(f"{many:5d} {name}", flush=True))
    classifier = forest["classifier"]
    print(f"classes {len(classifier.classes_)}, right out of bag {classifier.oob_score_:.3f}")
    print(f"a name is told from probability {forest['least']:.2f} on")


if __name__ == "__main__":
    main()
