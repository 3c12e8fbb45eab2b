# SPDX-License-Identifier: BSD-3-Clause
"""Simulation against recording: detect, locate, name, model, prove."""

from sklvalve.mismatch.diagnosis import Diagnosis
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.finder import MissingPhysicsFinder
from sklvalve.mismatch.model_file import load_model, save_model

__all__ = ["CATALOGUE", "Diagnosis", "MissingPhysicsFinder", "load_model", "save_model"]
