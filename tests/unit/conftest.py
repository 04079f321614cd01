from pathlib import Path

import pytest

from armour.scenario.loading import save_scenario
from tests.cases import scenario


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the Wilkins case as wilkins.toml."""
    save_scenario(scenario(), tmp_path / "wilkins.toml")
    return tmp_path
