"""Options of commands, made of the signatures and the docstrings of public functions."""

from collections.abc import Iterator
from typing import Annotated, Any, Literal

import pytest
import typer
from pydantic import Field

from armour.cli.app import app
from armour.cli.question import number, options_of, share


def asked(
    scenario: object,
    *,
    pairs: Annotated[int, Field(ge=1)] | None = None,
    level: float = 0.95,
    rule: Literal["a", "b"] = "a",
    prior: bool = False,
) -> None:
    """Ask.

    Parameters
    ----------
    scenario : object
        No option.
    pairs : int, optional
        Number of pairs,
        at least 1.
    level : float
        Level of the ``interval``.
    rule : {"a", "b"}
        Rule.
    prior : bool
        Whether to add the prior.
    """


@pytest.mark.parametrize("words", ["v50 tests/shots wilkins", "calibrate tests/wilkins wilkins"])
def test_a_table_and_a_scenario_are_given_in_either_order(cli, words: str):
    command, table, scenario = words.split()
    assert cli(command, scenario, table).stdout == cli(command, table, scenario).stdout


def test_options_have_the_words_and_the_defaults_of_a_function():
    made = {each.name: each.annotation.__metadata__[0] for each in options_of(asked)}
    assert {name: each.help for name, each in made.items()} == {
        "pairs": "Number of pairs, at least 1.",
        "level": "Level of the interval; by default 0.95.",
        "rule": "Rule; by default a.",
        "prior": "Add the prior.",
    }
    assert made["rule"].metavar == "a|b"


def test_words_that_are_numbers_become_numbers():
    """They are those that tables read; a sign of per cent goes with a share, which it divides by 100."""
    assert [number(text) for text in ("5", "-0.5", "95%", "5 m")] == [5, -0.5, "95%", "5 m"]
    assert [share(text) for text in ("0.95", "95%", "0.95 %", "9_5%")] == [0.95, 0.95, 0.0095, "9_5%"]


def parameters(command: Any) -> Iterator[Any]:
    yield from command.get_params(typer.Context(command))
    for inner in getattr(command, "commands", {}).values():
        yield from parameters(inner)


def test_every_option_says_what_it_is():
    assert [each.name for each in parameters(typer.main.get_command(app)) if not each.help] == []
