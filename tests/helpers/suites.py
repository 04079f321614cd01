"""Suite files and their results."""

from functools import cache
from pathlib import Path

from armour.validation.suite import Suite, load_suite
from armour.validation.validate import SuiteResult, validate

# Ballistic limit of the Wilkins case, m/s, to the tolerance of its search.
WILKINS_LIMIT = 723.778
HEAD = 'scenario = "wilkins.toml"\nquantity = "ballistic_limit_m_s"\n'
TABLE = f"""
[[table]]
name = "t"
{HEAD}columns = ["armour.ceramic_thickness_mm", "expected"]
rows = [
    [6.35, 720.0],  # as tested
    [6.35, 730.0],
]
band = 10.0
rms_band = 5.0
"""


@cache
def of_paper() -> SuiteResult:
    """The result of the paper's suite."""
    return validate(load_suite("paper"))


def case(name: str, expected: float | str, rest: str) -> str:
    """A case of the Wilkins scenario's ballistic limit."""
    return f'[[case]]\nname = "{name}"\n{HEAD}expected = {expected}\n{rest}\n'


def load(folder: Path, text: str) -> Suite:
    """The suite of a text, as a file of the folder."""
    path = folder / "suite.toml"
    path.write_text(text)
    return load_suite(path)


def result(folder: Path, text: str) -> SuiteResult:
    """The result of the suite of a text."""
    return validate(load(folder, text))
