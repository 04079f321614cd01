"""What the budget counts."""

import pytest

from tools import budget

PROGRAM = '''"""Words."""

import re  # a comment beside code
from sys import argv

import numpy as np


def function() -> str:
    """Words
    over two lines.
    """
    import json

    # Alone.
    return json.dumps(re.sub("#", "", argv[0]))
'''


def test_docstrings_comments_and_blank_lines_are_no_code():
    assert budget.code_lines(PROGRAM) == 6


def test_imports_are_counted_at_the_top_and_within_functions():
    assert budget.imports(PROGRAM) == (1, 1)


def test_a_list_that_a_program_writes_has_no_words():
    list_, mark = "<!-- site: inputs -->\n\n| a | b |\n\n<!-- end -->\n", "<!-- site: inputs -->\n"
    assert budget.words("One two\n" + list_ + mark + list_ + "three") == 3 + len(mark.split())


def test_every_excess_is_named(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    some = [budget.Count("commands", 17, 17), budget.Count("options", 151, 150)]
    monkeypatch.setattr(budget, "counts", lambda: some)
    assert budget.main() == 1
    printed = capsys.readouterr()
    assert [line.split() for line in printed.out.splitlines()] == [["commands", "17", "17"], ["options", "151", "150"]]
    assert printed.err == "too many options: 151, at most 150\n"
    monkeypatch.setattr(budget, "counts", lambda: some[:1])
    assert budget.main() == 0


def test_all_commands_are_counted_also_those_of_a_group():
    names = [name for name, _ in budget.commands()]
    assert "plan shots" in names
    assert len(names) == len({*names})
