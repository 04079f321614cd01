"""Report on a scenario as Markdown, without charts."""

import re

from armour.reporting.contents import Contents
from armour.reporting.markdown import markdown_table, markdown_text
from armour.reporting.wording import (
    ORIGIN,
    cards_of,
    energy_section,
    question_of,
    sections_of,
    title_of,
    version_table,
)


def scenario_markdown(contents: Contents, command: str) -> str:
    """Return a report on a scenario as Markdown.

    Parameters
    ----------
    contents : Contents
    command : str
        Command that makes the report.
    """
    parts = [f"# {markdown_text(title_of(contents))}", markdown_text(question_of(contents))]
    cards = []
    for card in cards_of(contents):
        detail = f"; {markdown_text(card.detail)}" if card.detail else ""
        cards.append(f"* {card.subject}: **{markdown_text(card.statement)}**{detail}")
    parts += ["\n".join(cards), *(f"Warning: {markdown_text(warning)}" for warning in contents.warnings)]
    for section in (energy_section(contents), *sections_of(contents)):
        parts += [f"## {markdown_text(section.heading)}", *(markdown_text(words) for words in section.paragraphs)]
        parts += (markdown_table(table) for table in section.tables)
    parts += ["## Scenario", _fenced(contents.scenario.to_toml(), "toml"), "## Origin", ORIGIN]
    return "\n\n".join([*parts, _fenced(command, "console"), markdown_table(version_table())]) + "\n"


def _fenced(text: str, language: str) -> str:
    """Return text within a fence longer than any in it."""
    fence = "`" * max(3, 1 + max((len(run) for run in re.findall("`+", text)), default=0))
    return f"{fence}{language}\n{text.rstrip()}\n{fence}"
