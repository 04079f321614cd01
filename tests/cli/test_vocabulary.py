"""One word for each notion: words that another one replaced occur in no session of a command and in no help."""

import re
from pathlib import Path

import pytest

from armour.cli.app import COMMANDS, named
from tests.helpers.commands import invoke

SESSIONS = sorted((Path(__file__).parent / "golden").glob("*.txt"))
# By the word that replaced them, as docs/nomenclature.md has it.
DEAD = {
    "expected limit": ["with the model error", "median limit", "nominal ballistic limit"],
    "limit by the model": ["computed (ballistic )?limit"],
    "stops a shot with": [
        "probability of stopping the projectile",
        "probability of perforation",
        "perforated (more often|with a probability)",
        "survival",
    ],
    "required": ["asked for", "meets the requirements", "demand"],
    "up to": ["one-sided"],
    "far from the tests": [
        "outside the tests",
        "extrapolat",
        "outside what the model was compared with",
        "too unlike",
        "do not rely",
    ],
    "no test": ["untested"],
    "the verdict": ["lacks", "shortfall", "short by", "does not suffice", "slack"],
    "not known": [r"probability (is |: )?unknown", "undecided"],
    "lightest": ["runner-up", "optimum design"],
    "materials": ["pairs of materials", "candidates"],
}


def found(text: str) -> list[str]:
    """The dead words in a text, whose lines may end anywhere."""
    words = " ".join(re.sub(r"\n! |[│\n]", " ", text).split())
    return [each for dead in DEAD.values() for each in dead if re.search(rf"\b{each}", words, re.IGNORECASE)]


@pytest.mark.parametrize("session", SESSIONS, ids=lambda path: path.stem)
def test_a_session_has_no_dead_word(session: Path):
    assert found(session.read_text()) == []


@pytest.mark.parametrize("command", [named(each) for group in COMMANDS.values() for each in group])
def test_a_help_has_no_dead_word(command: str):
    assert found(invoke([*command.split(), "--help"]).stdout) == []
