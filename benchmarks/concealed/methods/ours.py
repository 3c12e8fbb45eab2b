# SPDX-License-Identifier: BSD-3-Clause
"""This package's finder."""

from dataclasses import asdict

from benchmarks.concealed.methods.rows import told_rows
from sklvalve import MissingPhysicsFinder

_TOLD = ("verdict", "mismatch", "location", "effects", "unknown", "data", "rules", "reasons")
# rows of the table of explanations that are kept, of each place
_RANKS = 4


def diagnose(recording, *, folder=None, **settings):
    """Diagnosis by `MissingPhysicsFinder`.

    Parameters
    ----------
    recording : Recording
    folder : path, default=None
        Not used.
    **settings
        Of the finder.

    Returns
    -------
    found : dict
        As diagnosis.json; ``simulate`` and ``simulate_nominal`` where there is a simulation, ``flagged``,
        the rows in which what was found acts, and ``boxes``, those of its regions and intervals.
    """
    finder = MissingPhysicsFinder(n_jobs=1, **settings).fit(recording)
    content, traces = finder.diagnosis_.to_dict(), finder.diagnosis_.traces
    found = {key: content[key] for key in _TOLD if key in content}
    if "since_history" in content:
        # what is no change since, and told beside the verdict: names by class, as in what was found
        since = content["since_history"]
        rivals = (since["by_itself"] or {}).get("rivals", {})
        found["held"] = [
            {"names": [each["name"], *rivals.get(each["name"], [])], "change": each["change"]}
            for each in since["held"]
        ]
    # with these a change of the rules, or of the null law, can be tried on the scores, without a search
    found["comparison"] = [row for row in content.get("comparison", ()) if row["rank"] <= _RANKS]
    if finder.evidence_ is not None:
        found["evidence"] = _looks(finder.evidence_)
    nominal = getattr(finder, "nominal_simulation_", None)
    ratio = opening = None
    if nominal is not None:
        found |= {
            "simulate": finder.corrected_simulation_.simulate,
            "simulate_nominal": nominal.simulate,
            "flagged": traces["flagged"],
        }
        ratio = traces.get("pressure_ratio")
        opening = nominal.simulate(recording).get("opening") if "opening" not in recording else None
    if found["verdict"] != "no_mismatch":
        seconds = recording.time - recording.time[0]
        found["boxes"] = told_rows(content, recording, seconds, opening=opening, pressure_ratio=ratio)
    return found


def _looks(evidence):
    """What each look at a recording saw, how much of the healthy see as much, and what chance depends on."""
    return {"looks": evidence.looks, "chances": evidence.chances, "covariates": asdict(evidence.covariates)}
