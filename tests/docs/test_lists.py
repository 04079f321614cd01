"""The lists of the pages are those of the program."""

import json
import re
from pathlib import Path

import pytest

from armour.cli.app import app
from armour.scenario.scenario import scenario_schema

pytestmark = pytest.mark.slow

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture
def lists():
    pytest.importorskip("mkdocs")
    from tools import lists

    return lists


def test_the_lists_of_all_pages_are_up_to_date(lists):
    for page in DOCS.rglob("*.md"):
        text = page.read_text(encoding="utf-8")
        assert lists.written(text) == text, f"{page}: run python -m tools.lists"


def test_the_command_line_has_every_command(lists):
    text = lists.commands()
    for command in app.registered_commands:
        assert f"## `armour {command.name}`\n" in text


def test_the_links_of_the_page_of_keys_lead_to_its_sections(lists):
    text = lists.scenario()
    anchors = {lists.slugify(heading.replace("`", ""), "-") for heading in re.findall(r"^## (.+)$", text, re.MULTILINE)}
    assert set(re.findall(r"\]\(#([^)]+)\)", text)) <= anchors
    assert len(anchors) == len(set(re.findall(r'"#/\$defs/(\w+)"', json.dumps(scenario_schema())))) + 1
