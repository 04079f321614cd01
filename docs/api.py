"""Write docs/api.md, the page of the public names, from their docstrings: ``python docs/api.py docs/api.md``."""

import ast
import inspect
import re
import sys
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from textwrap import dedent
from typing import Any

import armour

# Headings by package of the names; what a module of no package defines is listed last.
GROUPS = {
    "scenario": "Scenarios and the library",
    "analysis": "One armour",
    "design": "The best armour",
    "statistics": "Tests and uncertainty",
    "planning": "What to test next",
    "sweeps": "Many armours",
    "validation": "Suites and comparisons",
    "reporting": "Figures and reports",
    "errors": "Errors",
}
INTRODUCTION = """\
# Python API

Every name below is imported from `armour`, as in `from armour import load_scenario, simulate`. A name that ends with a
unit is in this unit. Wrong input raises an `InputError` with every mistake, a question without an answer a
`NoAnswerError`. A notebook shows a result as the tables that its command prints; `to_dict` returns plain data and
`to_dataframe`, where a result has rows, a data frame of pandas or polars. In signatures, `OnProgress` and `OnCheck`
stand for what the parameter's description says. `make docs` writes this page from the docstrings.
"""
# Sections of numpydoc whose items have a type and a description.
LISTS = ("Parameters", "Attributes", "Returns", "Raises")


def page() -> str:
    """Return the page."""
    groups: dict[str, list[str]] = {package: [] for package in GROUPS}
    for name in dir(armour):
        groups[getattr(armour, name).__module__.split(".")[1]].append(name)
    parts = [INTRODUCTION]
    for package, names in groups.items():
        parts.append(f"## {GROUPS[package]}\n")
        # Functions first.
        for name in sorted(names, key=lambda name: (inspect.isclass(getattr(armour, name)), name)):
            parts += _entry(name, getattr(armour, name))
    return "\n".join(parts)


def _entry(name: str, thing: Any) -> Iterator[str]:
    """Yield the parts of a name: heading, signature, docstring, and its methods where it is a class."""
    yield f"### {name}\n"
    if not inspect.isclass(thing):
        yield _code("py", _signature(thing))
    yield from _docstring(inspect.getdoc(thing) or "")
    if inspect.isclass(thing) and (methods := list(_methods(thing))):
        yield "**Methods and properties**\n"
        yield "\n".join(methods) + "\n"


def _methods(cls: type) -> Iterator[str]:
    """Yield the lines on the public methods and properties that a class has from this project."""
    own = [base for base in cls.__mro__ if base.__module__.startswith("armour.")]
    for name in sorted({name for base in own for name in vars(base) if not name.startswith("_")}):
        method = inspect.getattr_static(cls, name)
        if inspect.isfunction(method) and method.__module__.startswith("armour."):
            head = re.sub(r"\(self(, )?", "(", " ".join(_signature(method).split()))
        elif isinstance(method, property | cached_property):
            head = name
        else:
            continue
        yield f"* `{head}`: {_marked(' '.join((inspect.getdoc(method) or '').split()))}"


def _signature(function: Any) -> str:
    """Return the head of a function as it stands in the source, without the colon."""
    lines = dedent(inspect.getsource(function)).splitlines()
    [node] = ast.parse("\n".join(lines)).body
    assert isinstance(node, ast.FunctionDef)
    head = "\n".join(lines[node.lineno - 1 : node.body[0].lineno - 1]).rstrip(":").removeprefix("def ")
    return re.sub(r'(: |-> )"([^"]+)"', r"\1\2", head)


def _docstring(text: str) -> Iterator[str]:
    """Yield the sections of a docstring in numpydoc as Markdown."""
    first, *rest = re.split(r"^(\w[\w ]*)\n-+$", text, flags=re.MULTILINE)
    yield f"{_marked(first.strip())}\n"
    for heading, body in zip(rest[::2], rest[1::2], strict=True):
        yield f"**{heading}**\n"
        yield _items(body) if heading in LISTS else _code("pycon", body.strip())


def _items(body: str) -> str:
    """Return the items of a section as a list."""
    lines = []
    for item in re.split(r"^(?=\S)", dedent(body).strip(), flags=re.MULTILINE):
        head, _, description = item.strip().partition("\n")
        name, _, kind = head.partition(" : ")
        words = " ".join(dedent(description).split())
        lines.append("* " + ", ".join(filter(None, (f"`{name}`", kind))) + (f": {_marked(words)}" if words else ""))
    return "\n".join(line for line in lines if line != "* ``") + "\n"


def _code(language: str, text: str) -> str:
    return f"```{language}\n{text}\n```\n"


def _marked(text: str) -> str:
    """Return a text with code marked as in Markdown."""
    return text.replace("``", "`")


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page(), encoding="utf-8")
