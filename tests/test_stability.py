"""What docs/stability.md promises is still there: tests/interface.json lists it, and may only grow.

``python -m tests.test_stability`` writes the list anew, for what was added.
"""

import dataclasses
import inspect
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import typer
from pydantic import BaseModel
from typer.testing import CliRunner

import armour
from armour.cli.app import app
from armour.scenario.scenario import scenario_schema

LIST = Path(__file__).with_name("interface.json")
# Commands whose JSON the list holds, with what they ask.
QUESTIONS = (
    *("simulate wilkins", "ballistic-limit wilkins", "check wilkins", "compare wilkins", "sensitivity wilkins"),
    *("uncertainty uncertain --samples 128", "optimise paper/fig11_7.62mm_ceramics", "v50 tests/shots"),
    *("calibrate unknown_ceramic tests/unknown_ceramic", "plan shots wilkins tests/shots", "validate paper"),
)


def python() -> dict[str, list[str]]:
    """Parameters of the public functions; attributes and methods of the public classes."""
    found = {}
    for name in dir(armour):
        thing = getattr(armour, name)
        members: list[str] = []
        if not isinstance(thing, type):
            members = list(inspect.signature(thing).parameters)
        elif dataclasses.is_dataclass(thing):
            members = [field.name for field in dataclasses.fields(thing)]
        elif issubclass(thing, BaseModel):
            members = list(thing.model_fields)
        own = [base for base in getattr(thing, "__mro__", ()) if base.__module__.startswith("armour.")]
        members += [member for base in own for member in vars(base)]
        found[name] = sorted({member for member in members if not member.startswith(("_", "model_"))})
    return found


def options(command: Any, path: str = "armour") -> Iterator[tuple[str, list[str]]]:
    """Options of the commands; the name of an argument is never typed."""
    words = [word for parameter in command.get_params(typer.Context(command)) for word in parameter.opts]
    yield path, sorted(word for word in words if word.startswith("-"))
    for name, deeper in getattr(command, "commands", {}).items():
        yield from options(deeper, f"{path} {name}")


def scenario() -> dict[str, list[str]]:
    """Keys of the sections of a scenario."""
    schema = scenario_schema()
    return {name: sorted(part["properties"]) for name, part in (("", schema), *sorted(schema["$defs"].items()))}


def answers() -> dict[str, list[str]]:
    """Keys of the JSON of some commands, also within its objects and lists."""
    found = {}
    for question in QUESTIONS:
        printed = CliRunner().invoke(app, [*question.split(), "--json"]).stdout
        found[question] = sorted(set(keys_of(json.loads(printed))))
    return found


def keys_of(data: object, path: str = "") -> Iterator[str]:
    """Dotted keys of plain data, without those that are names of threats or inputs."""
    if isinstance(data, Mapping):
        for key in filter(str.isidentifier, data):
            yield f"{path}{key}"
            yield from keys_of(data[key], f"{path}{key}.")
    elif isinstance(data, list):
        for value in data:
            yield from keys_of(value, path)


def interface() -> dict[str, dict[str, list[str]]]:
    commands = dict(options(typer.main.get_command(app)))
    return {"scenario": scenario(), "python": python(), "commands": commands, "json": answers()}


def test_nothing_that_was_promised_is_gone():
    found = interface()
    for part, entries in json.loads(LIST.read_text()).items():
        for name, members in entries.items():
            assert name in found[part], f"{part}: {name}"
            assert set(members.split()) <= set(found[part][name]), f"{part}: {name}"


if __name__ == "__main__":
    lines = {part: {name: " ".join(members) for name, members in found.items()} for part, found in interface().items()}
    LIST.write_text(json.dumps(lines, indent=1) + "\n", encoding="utf-8")
