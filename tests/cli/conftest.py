# SPDX-License-Identifier: BSD-3-Clause
import pytest

import sklvalve.mismatch
from tests.cli import stand_in


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Folder with a recording and a valve, the current one; a stand-in diagnoses."""
    pytest.importorskip("pandas", reason='needs pip install "sklvalve[all]"')
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SKLVALVE_DEBUG", "1")  # a fault of the package fails a test as what it is
    (tmp_path / "recording.csv").write_text(stand_in.csv_text(stand_in.columns(160)))
    (tmp_path / "valve.toml").write_text(stand_in.VALVE)
    monkeypatch.setattr(sklvalve.mismatch, "MissingPhysicsFinder", stand_in.Finder, raising=False)
    monkeypatch.setattr(sklvalve.mismatch, "save_model", stand_in.save_model, raising=False)
    monkeypatch.setattr(sklvalve.mismatch, "load_model", stand_in.load_model, raising=False)
    monkeypatch.setattr(stand_in.Finder, "asked", {})
    return tmp_path
