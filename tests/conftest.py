"""Settings for all tests."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

from armour.scenario.loading import save_scenario
from tests.helpers.cases import scenario

# CI uses the same examples in every run, so that only a change of the code can make it fail.
settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the Wilkins case as wilkins.toml."""
    save_scenario(scenario(), tmp_path / "wilkins.toml")
    return tmp_path
