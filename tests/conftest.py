# SPDX-License-Identifier: BSD-3-Clause
"""What all tests share."""

import os
from pathlib import Path

import pytest

if "PYTEST_XDIST_WORKER" in os.environ:
    # a worker for each processor: threads of each would only wait for one another
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


@pytest.fixture(scope="session")
def data_folder() -> Path:
    """Folder of the recordings that some tests need; skips them, saying why, where it is not given."""
    named = os.environ.get("SKLVALVE_DATA")
    if not named:
        pytest.skip("needs recordings: set SKLVALVE_DATA to the folder that holds them")
    folder = Path(named)
    if not folder.is_dir():
        pytest.skip(f"needs recordings: SKLVALVE_DATA is {named!r}, which is no folder")
    return folder
