# SPDX-License-Identifier: BSD-3-Clause
"""Importing the package alone is light and needs the core only."""

import subprocess
import sys

import pytest

EXTRAS = (
    "pandas",
    "pyarrow",
    "polars",
    "matplotlib",
    "jinja2",
    "onnx",
    "dask",
    "rich",
    "skops",
    "dask",
    "CoolProp",
    "fluids",
)


def _loaded_by(statement: str, hidden: tuple[str, ...] = ()) -> set[str]:
    """Top-level modules that a fresh interpreter holds after a statement, some made impossible to import."""
    code = "\n".join(
        [
            "import sys",
            *(f"sys.modules[{name!r}] = None" for name in hidden),
            statement,
            "print('\\n'.join({name.split('.')[0] for name, m in sys.modules.items() if m is not None}))",
        ]
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return set(run.stdout.split())


def test_package_alone_loads_nothing_heavy():
    loaded = _loaded_by("import sklvalve")
    assert not loaded & {*EXTRAS, "sklearn", "scipy", "numba", "numpy"}


@pytest.mark.parametrize(
    "layer", ["metrics", "recording", "mechanism", "lssvm", "hybrid", "simulation", "mismatch", "datasets"]
)
def test_layer_imports_without_extras(layer):
    loaded = _loaded_by(f"import sklvalve.{layer}", hidden=EXTRAS)
    assert not loaded & set(EXTRAS)


def test_every_public_name_is_there_without_extras():
    loaded = _loaded_by("import sklvalve; [getattr(sklvalve, name) for name in sklvalve.__all__]", EXTRAS)
    assert not loaded & set(EXTRAS)


def test_reading_without_pandas_says_which_extra_to_install():
    statement = (
        "from sklvalve.recording.reader import _pandas\n"
        "try:\n    _pandas()\nexcept ImportError as error:\n    assert 'sklvalve[io]' in str(error), error\n"
        "else:\n    raise AssertionError('no error')"
    )
    _loaded_by(statement, hidden=("pandas",))
