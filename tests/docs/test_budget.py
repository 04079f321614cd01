"""What the budget counts."""

from tools import budget

PROGRAM = '''import re  # a comment beside code
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


def test_docstrings_comments_and_blank_lines_are_no_code_and_imports_are_counted():
    assert (budget.code_lines(PROGRAM), *budget.imports(PROGRAM)) == (6, 1, 1)


def test_a_list_that_a_program_writes_has_no_words():
    list_, mark = "<!-- site: inputs -->\n\n| a | b |\n\n<!-- end -->\n", "<!-- site: inputs -->\n"
    assert budget.words("One two\n" + list_ + mark + list_ + "three") == 3 + len(mark.split())
