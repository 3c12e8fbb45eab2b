# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a diagnosis for notebooks, in the form of scikit-learn's displays."""

from sklvalve.report.displays.explanation import ExplanationDisplay
from sklvalve.report.displays.improvement import FitImprovementDisplay
from sklvalve.report.displays.recording import RecordingDisplay
from sklvalve.report.displays.residual_map import ResidualMapDisplay
from sklvalve.report.displays.signature import SignatureDisplay

__all__ = [
    "ExplanationDisplay",
    "FitImprovementDisplay",
    "RecordingDisplay",
    "ResidualMapDisplay",
    "SignatureDisplay",
]
