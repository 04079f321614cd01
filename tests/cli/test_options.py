"""Options of commands, beside the parameters of the Python functions of the same name."""

import inspect
from collections.abc import Iterator
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest
import typer

import armour
from armour.cli import experiments, scenario_commands
from armour.cli.app import app

COMMANDS = [scenario_commands.optimise, experiments.v50, experiments.calibrate, experiments.plan_shots]


@pytest.mark.parametrize("words", ["v50 tests/shots wilkins", "calibrate tests/wilkins wilkins"])
def test_a_table_and_a_scenario_are_given_in_either_order(cli, words: str):
    command, table, scenario = words.split()
    assert cli(command, scenario, table).stdout == cli(command, table, scenario).stdout


@pytest.mark.parametrize("command", COMMANDS)
def test_every_parameter_that_a_word_or_a_number_sets_has_an_option(command: Any):
    function = getattr(armour, command.__name__)
    hints = get_type_hints(function)
    plain = (bool, int, float)
    names = {name for name, hint in hints.items() if any(kind in plain for kind in (hint, *get_args(hint)))}
    assert names <= get_type_hints(command).keys()


@pytest.mark.parametrize("command", COMMANDS)
def test_completion_offers_the_words_of_a_choice(command: Any):
    hints, options = get_type_hints(getattr(armour, command.__name__)), inspect.signature(command).parameters
    for name, hint in hints.items():
        kinds = [kind for kind in (hint, *get_args(hint)) if get_origin(kind) is Literal]
        if words := [word for kind in kinds for word in get_args(kind)]:
            assert [*options[name].default.autocompletion()] == words


def parameters(command: Any) -> Iterator[Any]:
    yield from command.get_params(typer.Context(command))
    for inner in getattr(command, "commands", {}).values():
        yield from parameters(inner)


def test_every_option_says_what_it_is():
    assert [each.name for each in parameters(typer.main.get_command(app)) if not each.help] == []
