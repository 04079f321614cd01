"""docs/coverage.toml names functions that there are, each once; `make coverage` compares them with what runs."""

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

import armour

PACKAGE = Path(armour.__file__).parent
REASONS = Path(__file__).parents[2] / "docs" / "coverage.toml"


def functions_of(tree: ast.AST, path: str = "") -> Iterator[str]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield f"{path}{node.name}"
            yield from functions_of(node, f"{path}{node.name}.")
        else:
            yield from functions_of(node, path)


def test_every_function_with_a_reason_exists():
    reasons = tomllib.loads(REASONS.read_text(encoding="utf-8"))["reason"]
    named = [name for reason in reasons for name in reason["functions"]]
    assert len(named) == len(set(named))
    for name in named:
        module, _, function = name.partition(": ")
        tree = ast.parse((PACKAGE / module).read_text(encoding="utf-8"))
        assert function in {"module", *functions_of(tree)}, name
