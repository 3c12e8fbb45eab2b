# SPDX-License-Identifier: BSD-3-Clause
"""Simulation against recording: detect, locate, name, model, prove."""

from sklvalve.mismatch.advice import plan_next_test
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.files.diagnosis_schema import diagnosis_schema
from sklvalve.mismatch.files.history_file import load_history, save_history
from sklvalve.mismatch.files.model_file import load_model, save_model
from sklvalve.mismatch.finder import MissingPhysicsFinder
from sklvalve.mismatch.next_test.plan import TestPlan
from sklvalve.mismatch.next_test.programs import TestLimits
from sklvalve.mismatch.result.diagnosis import Diagnosis

__all__ = [
    "CATALOGUE",
    "Diagnosis",
    "MissingPhysicsFinder",
    "TestLimits",
    "TestPlan",
    "diagnosis_schema",
    "load_history",
    "load_model",
    "plan_next_test",
    "save_history",
    "save_model",
]
