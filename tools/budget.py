"""Count what must stay small, print each count with its limit, and fail where one is greater: `make check` runs it.

python -m tools.budget
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import typer

from armour.cli.app import app

ROOT = Path(__file__).parents[1]
# A list that tools/lists.py writes into a page, between its marks.
LIST = re.compile(r"^(<!-- site: (\w+)([^\n]*) -->\n)(?:(?!<!-- site: ).*\n)*?(<!-- end -->)$", re.MULTILINE)


class Count(NamedTuple):
    """How much there is of something, and how much there may be."""

    what: str
    number: float
    limit: float

    def __str__(self) -> str:
        return f"{self.what:<40} {self.number:>10,.5g} {self.limit:>10,.5g}"


def code_lines(text: str) -> int:
    """Return the number of lines of a program without docstrings, comments and blank lines."""
    words = [
        node
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
    ]
    within = {number for node in words for number in range(node.lineno, (node.end_lineno or node.lineno) + 1)}
    lines = ((number, line.strip()) for number, line in enumerate(text.splitlines(), start=1))
    return sum(bool(line) and not line.startswith("#") and number not in within for number, line in lines)


def imports(text: str) -> tuple[int, int]:
    """Return the numbers of imports at the top of a module, without the standard library, and in its functions."""
    nodes = list(ast.walk(ast.parse(text)))
    functions = [node for node in nodes if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
    within = {part for function in functions for part in ast.walk(function) if isinstance(part, _IMPORTS)}
    top = [node for node in nodes if isinstance(node, _IMPORTS) and node not in within]
    names = [node.module or "" if isinstance(node, ast.ImportFrom) else node.names[0].name for node in top]
    return sum(name.partition(".")[0] not in sys.stdlib_module_names for name in names), len(within)


_IMPORTS = ast.Import | ast.ImportFrom


def words(text: str) -> int:
    """Return the number of words of a page, without the lists that programs write into it."""
    return len(LIST.sub("", text).split())


def commands(group: Any = None, path: tuple[str, ...] = ()) -> Iterator[tuple[str, Any]]:
    """Yield the names and the commands of the program, by default of all of it."""
    found: Any = group or typer.main.get_command(app)
    for name, command in found.commands.items():
        if hasattr(command, "commands"):
            yield from commands(command, (*path, name))
        else:
            yield " ".join((*path, name)), command


def counts() -> list[Count]:
    """Return all that is counted."""
    texts = {
        folder: [path.read_text(encoding="utf-8") for path in sorted((ROOT / folder).rglob("*.py"))]
        for folder in ("src", "tests", "tools")
    }
    lines = {folder: sum(map(code_lines, programs)) for folder, programs in texts.items()}
    modules = [imports(text) for text in texts["src"] if code_lines(text)]
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    every = dict(commands())
    options = [param for command in every.values() for param in command.params if param.param_type_name == "option"]
    return [
        Count("lines of code in src", lines["src"], 16_500),
        Count("lines of code in tools", lines["tools"], 3_000),
        Count("lines of code in tests for one in src", lines["tests"] / lines["src"], 1.05),
        Count("imports at the top, not of Python, mean", sum(top for top, _ in modules) / len(modules), 9),
        Count("imports within functions", sum(within for _, within in modules), 80),
        Count("commands", len(every), 17),
        Count("options of all commands", len(options), 150),
        Count("words of README and docs", sum(words(page.read_text(encoding="utf-8")) for page in pages), 42_000),
    ]


def main() -> int:
    """Print the counts; the exit code is 1 if one is greater than its limit."""
    found = counts()
    for count in found:
        print(count)
    excess = [count for count in found if count.number > count.limit]
    for count in excess:
        print(f"too many {count.what}: {count.number:,.5g}, at most {count.limit:,g}", file=sys.stderr)
    return int(bool(excess))


if __name__ == "__main__":
    sys.exit(main())
