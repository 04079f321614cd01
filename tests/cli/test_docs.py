"""The commands and the Python examples of the documentation do what it says, and its links lead somewhere.

A page shows ``images/PAGE-NAME``, with its own name for PAGE, where one of its examples draws ``NAME``.
``python -m tests.cli.test_docs`` draws these pictures anew.
"""

import io
import os
import re
import shlex
import shutil
import tempfile
from contextlib import redirect_stdout
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from typer.testing import CliRunner

from armour.cli.app import app
from tests.helpers.cases import SCENARIOS

pytestmark = pytest.mark.slow

REPOSITORY = SCENARIOS.parent
PAGES = [*sorted(REPOSITORY.glob("*.md")), *sorted((REPOSITORY / "docs").rglob("*.md"))]
IDS = [page.relative_to(REPOSITORY).as_posix() for page in PAGES]


def sessions(page: Path) -> list[list[tuple[str, list[str]]]]:
    """The console blocks of a page: commands, each with the lines that it must print."""
    blocks = []
    for block in re.findall(r"^```console\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL):
        commands: list[tuple[str, list[str]]] = []
        for line in block.splitlines():
            if line.startswith("$ "):
                commands.append((line[2:], []))
            else:
                commands[-1][1].append(line)
        blocks.append(commands)
    return blocks


def titled(page: Path) -> dict[str, str]:
    """The files that a page shows: blocks with a title."""
    return dict(re.findall(r'^```\w+ title="([^"]+)"\n(.*?)^```', page.read_text(), re.MULTILINE | re.DOTALL))


# Hosts that links of the pages may have.
HOSTS = {"doi.org", "creativecommons.org"}
SESSIONS = [
    pytest.param(page, commands, id=f"{name}: {commands[0][0]}")
    for page, name in zip(PAGES, IDS, strict=True)
    for commands in sessions(page)
    if commands[0][0].startswith("armour ")
]


def python(page: Path) -> list[str]:
    """The Python examples of a page."""
    return re.findall(r"^```python\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)


EXAMPLES = [
    pytest.param(code, id=f"{name}: {number}")
    for page, name in zip(PAGES, IDS, strict=True)
    for number, code in enumerate(python(page), 1)
]


def arguments(command: str) -> list[str]:
    return shlex.split(re.split("  #| > ", command)[0])[1:]


def drawn(page: Path) -> dict[str, Path]:
    """The pictures that examples of a page draw and that it shows: where they lie, by the names in the examples."""
    shown = re.findall(rf"\]\(([./\w-]*images/{page.stem.lower()}-([\w.-]+))\)", page.read_text())
    return {name: (page.parent / path).resolve() for path, name in shown}


@pytest.fixture
def empty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to run the examples in, as a newcomer does who has installed the program."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def plain(line: str) -> str:
    return " ".join(line.split())


@pytest.mark.parametrize(("page", "commands"), SESSIONS)
def test_a_session_prints_what_it_shows(cli, empty: Path, page: Path, commands: list[tuple[str, list[str]]]):
    for name, text in titled(page).items():
        (empty / name).write_text(text)
    for command, lines in commands:
        result = cli(*arguments(command))
        may_end = {"check": (0, 3), "validate": (0, 3), "v50": (0, 3), "optimise": (0, 1)}
        assert result.exit_code in may_end.get(command.split()[1], (0,)), result.output
        printed = iter([plain(line) for line in (*result.stdout.splitlines(), *result.stderr.splitlines())])
        for line in lines:
            if line.strip() not in ("...", "") and not set(line) <= {"─"}:
                assert plain(line) in printed, f"{command} does not print in this order: {line}"


@pytest.mark.parametrize("code", EXAMPLES)
@pytest.mark.usefixtures("empty")
def test_a_python_example_prints_what_its_comments_show(code: str):
    printed = io.StringIO()
    with redirect_stdout(printed):
        exec(code, {"__name__": "__main__"})
    shown = re.findall(r"^ *print\(.*\)  # (.*)$", code, re.MULTILINE)
    assert shown, "an example shows what it prints, in a comment after each print"
    assert printed.getvalue().replace(",", "").split() == " ".join(shown).replace(",", "").split()


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_pictures_are_those_of_the_examples(page: Path):
    examples = [command for block in sessions(page) for command, _ in block] + python(page)
    for name in drawn(page):
        assert any(re.search(rf"\b{re.escape(name)}\b", example) for example in examples), name


def test_the_readme_has_a_python_example():
    assert "```python" in (REPOSITORY / "README.md").read_text()


def links(page: Path) -> list[str]:
    """What the links of a page lead to; code has none."""
    prose = re.sub(r"^```.*?^```|^    .*?$|`[^`\n]*`", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    return re.findall(r"\]\(([^)]+)\)", prose)


def anchors(page: Path) -> set[str]:
    """Anchors of the headings of a page."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading).strip().lower().replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_links_lead_somewhere(page: Path):
    for link in links(page):
        target, _, anchor = link.partition("#")
        if "://" not in link:
            path = page.parent / target if target else page
            assert path.exists(), link
            assert not anchor or anchor in anchors(path), link


def test_the_hosts_of_external_links():
    """They are only looked at: the tests use no network."""
    external = [link for page in PAGES for link in links(page) if "://" in link]
    assert {urlsplit(link).scheme for link in external} <= {"https"}
    assert {urlsplit(link).hostname for link in external} <= HOSTS


def test_every_command_has_its_page():
    commands = {command.name for command in app.registered_commands} | {group.name for group in app.registered_groups}
    # A page for each command of this group.
    commands = (commands - {"plan"}) | {"plan-shots"}
    guides = {"change-an-equation", "choose-a-flow-stress", "ci", "confidence"}
    # Its commands have pages of their own.
    commands = commands - {"plan"} | {"plan-tests"}
    # The page on CI is also on compiling ahead.
    commands -= {"compile"}
    assert {page.stem for page in (REPOSITORY / "docs" / "howto").glob("*.md")} == commands | guides


def test_every_guide_is_linked_from_the_readme():
    found = links(REPOSITORY / "README.md")
    for page in (REPOSITORY / "docs" / "howto").glob("*.md"):
        assert page.relative_to(REPOSITORY).as_posix() in found


def draw(page: Path) -> None:
    """Run the examples of a page, in a folder of their own, and keep the pictures that it shows."""
    if not (pictures := drawn(page)):
        return
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name, text in titled(page).items():
            Path(name).write_text(text)
        for block in sessions(page):
            for command, _ in block:
                if command.startswith("armour "):
                    CliRunner().invoke(app, [*arguments(command)])
        with redirect_stdout(io.StringIO()):
            for code in python(page):
                exec(code, {"__name__": "__main__"})
        for name, place in pictures.items():
            shutil.copy(name, place)


if __name__ == "__main__":
    for page in PAGES:
        draw(page)
