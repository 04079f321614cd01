"""Settings for all tests."""

import atexit
import gc
import os
from pathlib import Path
from typing import Any

import pytest

# Small products of matrices take four times the processor time on several threads, which wait for each other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Most of what is made stays to the end: tests take a twentieth less time where it is seldom looked at for garbage.
gc.set_threshold(50_000, 20, 20)
atexit.register(gc.freeze)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the Wilkins case as wilkins.toml."""
    # Imported here: the process that hands out the tests runs none.
    from armour.scenario.scenario import save_scenario
    from tests.helpers.cases import scenario

    save_scenario(scenario(), tmp_path / "wilkins.toml")
    return tmp_path


@pytest.fixture
def not_laid_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Do not place the panels of pictures of which a test reads the content: tests/reporting looks at their places."""
    monkeypatch.setattr("armour.reporting.pictures.drawing.NotebookFigure.draw_without_rendering", lambda _: None)


# What to do after a change of the core's code, without which no probability is known and many tests fail.
RENEW = "changed code of armour/core: see whether numbers moved (CONTRIBUTING.md), then run python -m tools.evidence"


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Say below tests that fail what they need if the core's code is not that which is recorded."""
    if "failed" in terminalreporter.stats:
        from armour.evidence.core_digest import core_digest
        from armour.evidence.fit import shipped_data

        if core_digest() != shipped_data()["core"]["sha256"]:
            terminalreporter.section(RENEW, red=True)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: Any, log: Any) -> Any:
    """Give each file to one process, so that what its tests share is computed once."""
    from xdist.scheduler import LoadFileScheduling

    return LoadFileScheduling(config, log)
