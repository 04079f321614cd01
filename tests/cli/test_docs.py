"""The commands and the Python examples of the documentation do what it says, and its links lead somewhere.

A session shows what a terminal of 80 columns does; a line of three dots stands for lines that it leaves out.  A page
shows ``images/PAGE-NAME``, with its own name for PAGE, where one of its examples draws ``NAME``.
``python -m tests.cli.test_docs PAGES`` records the sessions and the pictures of these pages, or of all, anew.
"""

import io
import os
import re
import shlex
import shutil
import sys
import tempfile
from collections.abc import Sequence
from contextlib import redirect_stdout
from difflib import SequenceMatcher
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from armour.cli.app import app
from tests.cli.test_golden import TERMINAL
from tests.helpers.cases import SCENARIOS
from tests.helpers.commands import invoke

pytestmark = pytest.mark.slow

REPOSITORY = SCENARIOS.parent
PAGES = [*sorted(REPOSITORY.glob("*.md")), *sorted((REPOSITORY / "docs").rglob("*.md"))]
IDS = [page.relative_to(REPOSITORY).as_posix() for page in PAGES]
SESSION = re.compile(r"^```console\n(.*?)^```", re.MULTILINE | re.DOTALL)
# A command, over several lines if they end with a backslash, and the lines that it prints.
COMMAND = re.compile(r"^\$ ((?:.*\\\n)*.*)\n((?:(?!\$ ).*\n)*)", re.MULTILINE)
LEFT_OUT = "..."
# Columns of code that the site shows at once on a wide screen.
WIDTH = 88


def sessions(page: Path) -> list[list[tuple[str, list[str]]]]:
    """The console blocks of a page: commands, each with the lines that it must print."""
    return [
        [(joined(command), shown.splitlines()) for command, shown in COMMAND.findall(block)]
        for block in SESSION.findall(page.read_text())
    ]


def joined(command: str) -> str:
    return re.sub(r"\\\n *", "", command)


def titled(page: Path) -> dict[str, str]:
    """The files that a page shows: blocks with a title."""
    return dict(re.findall(r'^```\w+ title="([^"]+)"\n(.*?)^```', page.read_text(), re.MULTILINE | re.DOTALL))


# Hosts that links of the pages may have.
HOSTS = {"doi.org", "creativecommons.org"}
# The commands of a page in their order, as later ones may read what earlier ones write.
SESSIONS = {
    name: commands
    for page, name in zip(PAGES, IDS, strict=True)
    if (commands := [each for block in sessions(page) for each in block if each[0].startswith("armour ")])
}


def python(page: Path) -> list[str]:
    """The Python examples of a page."""
    return re.findall(r"^```python\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)


EXAMPLES = [
    pytest.param(code, id=f"{name}: {number}")
    for page, name in zip(PAGES, IDS, strict=True)
    for number, code in enumerate(python(page), 1)
]


def run(command: str) -> Any:
    """Run a command of a page, and write what it prints to the file to which the command redirects it."""
    words, _, file = command.partition("  #")[0].partition(" > ")
    result = invoke(shlex.split(words)[1:], env=TERMINAL)
    if file:
        Path(file).write_text(result.stdout)
    return result


def drawn(page: Path) -> dict[str, Path]:
    """The pictures that examples of a page draw and that it shows: where they lie, by the names in the examples."""
    shown = re.findall(rf"\]\(([./\w-]*images/{page.stem.lower()}-([\w.-]+))\)", page.read_text())
    return {name: (page.parent / path).resolve() for path, name in shown}


@pytest.fixture
def empty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to run the examples in, as a newcomer does who has installed the program."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", SESSIONS)
@pytest.mark.usefixtures("empty", "not_drawn")
def test_the_sessions_of_a_page_print_what_they_show(name: str):
    write_files(REPOSITORY / name)
    for command, lines in SESSIONS[name]:
        result = run(command)
        may_end = {"check": (0, 3), "validate": (0, 3), "v50": (0, 3), "optimise": (0, 1)}
        assert result.exit_code in may_end.get(command.split()[1], (0,)), result.output
        if lines:
            pattern = "".join(r"(?:.*\n)*" if line == LEFT_OUT else f"{re.escape(line)}\n" for line in lines)
            texts = (result.stdout, result.stdout + result.stderr)
            assert any(re.fullmatch(pattern, text) for text in texts), f"{command} prints\n{texts[1]}"


def test_no_page_writes_a_file_of_another():
    """A reader may follow all pages in one folder: no command replaces a file."""
    written: dict[str, set[str]] = {}
    for page, name in zip(PAGES, IDS, strict=True):
        commands = " ".join(command for command, _ in SESSIONS.get(name, []))
        saved = re.findall(r"(?:--save|--plot|--csv|--map|--write-scenario|-o|>) ([\w.-]+)", commands)
        for file in [*titled(page), *saved]:
            written.setdefault(file, set()).add(name)
    assert {file: pages for file, pages in written.items() if len(pages) > 1} == {}


@pytest.mark.parametrize("page", PAGES, ids=IDS)
def test_no_example_is_wider_than_the_page(page: Path):
    blocks = re.findall(r"^```(?:console|python|toml)[^\n]*\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines()]
    # A command that is there to be copied, and an option that is one word, stay whole.
    assert [line for line in lines if len(line) > WIDTH and not line.startswith(("next: ", "    --set '"))] == []


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
    commands = commands - {"plan"} | {"plan-shots"}
    guides = {"change-an-equation", "choose-a-flow-stress", "ci", "confidence", "tables", "use-with-other-libraries"}
    assert {page.stem for page in (REPOSITORY / "docs" / "howto").glob("*.md")} == commands | guides


def test_every_guide_is_linked_from_the_readme():
    found = links(REPOSITORY / "README.md")
    for page in (REPOSITORY / "docs" / "howto").glob("*.md"):
        assert page.relative_to(REPOSITORY).as_posix() in found


def write_files(page: Path) -> None:
    """Write the files that a page shows into the working folder."""
    for name, text in titled(page).items():
        Path(name).write_text(text)


def masked(lines: Sequence[str]) -> list[str]:
    """Lines by which a table is known again when its numbers and widths change."""
    return [re.sub(r"[+-]?\d[\d.]*", "0", " ".join(re.sub("─+", "─", line).split())) for line in lines]


def recorded(shown: Sequence[str], printed: Sequence[str]) -> list[str]:
    """What a command prints, without what a page leaves out of it."""
    if LEFT_OUT not in shown:
        return [*printed] if shown else []
    places: dict[int, int] = {}
    for match in SequenceMatcher(None, masked(shown), masked(printed), autojunk=False).get_matching_blocks():
        places |= {match.a + offset: match.b + offset for offset in range(match.size) if shown[match.a + offset]}
    lines: list[str] = []
    cuts = [-1, *(place for place, line in enumerate(shown) if line == LEFT_OUT), len(shown)]
    for start, end in pairwise(cuts):
        lines += [LEFT_OUT] if start >= 0 else []
        if end == start + 1:
            continue
        matched = [place for place in range(start + 1, end) if place in places]
        if not matched:
            raise ValueError(f"is not printed any more: {shown[start + 1]}")
        first = 0 if start < 0 else places[matched[0]] - (matched[0] - start - 1)
        last = len(printed) if end == len(shown) else places[matched[-1]] + end - matched[-1]
        lines += printed[first:last]
    return lines


def record(page: Path) -> None:
    """Run the examples of a page in a new folder, and write what they print and the pictures that it shows."""

    def session(block: re.Match[str]) -> str:
        return f"```console\n{COMMAND.sub(command, block[1])}```"

    def command(block: re.Match[str]) -> str:
        line, shown = joined(block[1]), block[2].splitlines()
        if not line.startswith("armour "):
            return block[0]
        result = run(line)
        printed, messages = result.stdout.splitlines(), result.stderr.splitlines()
        if {*masked(shown)} & {*masked(messages)}:
            printed += messages
        return "".join(f"{line}\n" for line in [f"$ {block[1]}", *recorded(shown, printed)])

    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        write_files(page)
        page.write_text(SESSION.sub(session, page.read_text()))
        if pictures := drawn(page):
            with redirect_stdout(io.StringIO()):
                for code in python(page):
                    exec(code, {"__name__": "__main__"})
            for name, place in pictures.items():
                shutil.copy(name, place)


if __name__ == "__main__":
    for page in [Path(name).resolve() for name in sys.argv[1:]] or PAGES:
        record(page)
