from pathlib import Path

import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from typer.testing import Result

from tests.helpers.commands import invoke


def words_in(figure: Figure, _suffix: str, _origin: str) -> bytes:
    """What is written in a figure, in place of its file."""
    lines = "\n".join(" ".join(text.get_text().split("\n")) for text in figure.findobj(Text))
    return lines.encode()


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


@pytest.fixture
def drawn() -> None:
    """Ask for files of pictures."""


@pytest.fixture
def not_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw no pictures of which a session shows only the name; test_answers.py draws one of each answer."""
    monkeypatch.setattr("armour.cli.runner.picture", lambda *_: lambda _path: b"")


@pytest.fixture(autouse=True)
def described(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files of pictures hold their words where a test does not ask for `drawn`, and maps few nodes.

    tests/reporting writes them whole.
    """
    if "drawn" not in request.fixturenames:
        monkeypatch.setattr("armour.reporting.design_page.PAGE_NODES", (0,))
        monkeypatch.setattr("armour.reporting.pictures.drawing.saved", words_in)
        monkeypatch.setattr("armour.reporting.formats.inline_svg", lambda _, __, name: f'<svg id="{name}"></svg>')
        request.getfixturevalue("not_laid_out")


@pytest.fixture
def cli() -> Cli:
    return Cli()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
