"""docs/nomenclature.md gives every word, symbol and key once."""

import inspect
import re
from collections.abc import Iterable
from pathlib import Path

from armour.core import equations
from armour.core.state import Parameters, Stage, State
from armour.scenario.scenario import scenario_schema

PAGE = (Path(__file__).parents[2] / "docs" / "nomenclature.md").read_text(encoding="utf-8")
# Parameters of equations that are no symbols.
WORDS = {"drive", "law", "pressure"}


def first_column(heading: str) -> list[str]:
    section = PAGE.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    cells = re.findall(r"^\| (.+?) \|", section, re.MULTILINE)[1:]
    return [word for cell in cells for word in cell.split(", ")]


def arguments() -> Iterable[str]:
    for _, function in inspect.getmembers(equations, inspect.isfunction):
        if function.__module__ == equations.__name__:
            yield from inspect.signature(function).parameters


def test_every_symbol_of_the_core_is_listed_once():
    listed = first_column("Symbols")
    assert len(set(listed)) == len(listed)
    assert {*Parameters._fields, *State._fields, *Stage._fields, *arguments()} - WORDS <= set(listed)


def test_every_symbol_listed_is_used():
    text = (Path(__file__).parents[2] / "docs" / "model.md").read_text(encoding="utf-8")
    used = {*re.findall(r"[A-Za-z0-9_]+", re.sub(r"_\{?(\w+)\}?", r"\1", text))}
    assert set(first_column("Symbols")) <= {*used, *Parameters._fields, *State._fields, *Stage._fields, *arguments()}


def test_every_word_is_listed_once_in_order():
    listed = first_column("Words")
    assert len(set(listed)) == len(listed)
    rows = [word for word in listed if word != "posterior"]
    assert rows == sorted(rows, key=str.lower)


def test_every_key_of_a_scenario_has_a_meaning():
    schema = scenario_schema()
    for section in (schema, *schema["$defs"].values()):
        assert all(content["description"].endswith(".") for content in section["properties"].values())
