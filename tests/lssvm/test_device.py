# SPDX-License-Identifier: BSD-3-Clause
"""Runs the tests of arrays of other libraries where scipy was told of them before it was imported."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sklvalve.lssvm import device


@pytest.mark.slow
def test_fits_and_predictions_on_arrays_of_other_libraries():
    pytest.importorskip("array_api_strict", reason="needs the extra `test`")
    here = Path(__file__).parent
    tests = [str(here / name) for name in ("on_device.py", "test_common.py")]
    words = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        *tests,
        "-k",
        "on_device or array_api",
    ]
    done = subprocess.run(
        words,
        env=os.environ | {"SCIPY_ARRAY_API": "1"},
        cwd=here.parents[1],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
    assert " passed" in done.stdout


def test_numpy_arrays_stay_where_they_are():
    assert not device.is_elsewhere([[1.0]])
