"""Settings for all tests."""

import os
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from armour.scenario.scenario import save_scenario
from tests.helpers.cases import scenario

# CI uses the same examples in every run, so that only a change of the code can make it fail.
settings.register_profile("ci", derandomize=True, deadline=None)
# A slow machine makes no test fail.
settings.register_profile("own", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "own")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the Wilkins case as wilkins.toml."""
    save_scenario(scenario(), tmp_path / "wilkins.toml")
    return tmp_path


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: Any, log: Any) -> Any:
    """Give each file to one process, so that what its tests share is computed once."""
    from xdist.scheduler import LoadFileScheduling

    return LoadFileScheduling(config, log)
