"""Settings for all tests."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

from armour.scenario.loading import save_scenario
from tests.cases import scenario

# In CI the same examples every time: a run that fails must be one that the change made fail.
settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the Wilkins case as wilkins.toml."""
    save_scenario(scenario(), tmp_path / "wilkins.toml")
    return tmp_path
