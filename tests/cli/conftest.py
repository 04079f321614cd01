from pathlib import Path

import pytest
from typer.testing import Result

from armour.engine.cache import kernel
from armour.reporting.charts import printable_chart
from tests.helpers.commands import invoke


class Cli:
    """Runs commands in this process and keeps stdout and stderr apart."""

    def __call__(self, *args: object, stdin: str | bytes | None = None) -> Result:
        return invoke([str(arg) for arg in args], stdin)

    def fails(self, code: int, *args: object) -> list[str]:
        """Run a command that must end with the exit code, without a traceback; the lines on stderr."""
        result = self(*args)
        assert result.exit_code == code, result.output
        assert result.exception is None or isinstance(result.exception, SystemExit)
        assert "Traceback" not in result.output
        assert not result.stdout
        return result.stderr.splitlines()


@pytest.fixture(autouse=True, scope="session")
def silent(compiled: None) -> None:  # noqa: ARG001 (in this order)
    """Compile the engine before the first command, which would say so."""
    kernel("impacts")


@pytest.fixture
def drawn() -> None:
    """Ask for files of charts that are drawn."""


@pytest.fixture(autouse=True)
def described(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files of charts hold their descriptions where a test does not ask for `drawn`: tests/reporting draws them all."""
    if "drawn" not in request.fixturenames:
        monkeypatch.setattr("armour.reporting.draw.rendered", lambda chart, _: repr(printable_chart(chart)).encode())
        monkeypatch.setattr("armour.reporting.html.inline_svg", lambda _, name: f'<svg id="{name}"></svg>')


@pytest.fixture
def cli() -> Cli:
    return Cli()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
