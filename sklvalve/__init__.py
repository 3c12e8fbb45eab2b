"""Find, name, model and prove the physics that a control-valve simulation leaves out."""

# SPDX-License-Identifier: BSD-3-Clause

from importlib import import_module as _import_module

#: Version of the package.
__version__ = "0.1.0"

# Loaded at first use, so that `import sklvalve` stays well under a second and needs the core only.
_WHERE = {
    "LSSVMRegressor": "sklvalve.lssvm",
    "LSSVMRegressorCV": "sklvalve.lssvm",
    "ValveMechanismTransformer": "sklvalve.mechanism",
    "SeriesHybridRegressor": "sklvalve.hybrid",
    "ParallelHybridRegressor": "sklvalve.hybrid",
    "read_recording": "sklvalve.recording",
    "read_valve": "sklvalve.recording",
    "Recording": "sklvalve.recording",
    "Valve": "sklvalve.recording",
    "ValveSimulation": "sklvalve.simulation",
    "ValveHistory": "sklvalve.history",
    "MissingPhysicsFinder": "sklvalve.mismatch",
    "Diagnosis": "sklvalve.mismatch",
}

__all__ = ["__version__", *_WHERE]


def __getattr__(name):
    if name in _WHERE:
        return getattr(_import_module(_WHERE[name]), name)
    raise AttributeError(f"module 'sklvalve' has no attribute {name!r}")


def __dir__():
    return sorted(__all__)
