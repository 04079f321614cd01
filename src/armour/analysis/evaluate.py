"""Evaluate quantities of a scenario for many values of its keys at once.

Sweeps, suites, figures, uncertainty, sensitivity, calibration and designs use it, or the `Variants` that it is made of.
A question without an answer gives NaN; a run that does not end raises an InputError that names the key at fault.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from armour.analysis.answers import COLUMNS, Answers
from armour.analysis.variants import Floats, Ints, Variants, variants_of
from armour.scenario.assignments import changes_of_values
from armour.scenario.loading import Scenario
from armour.scenario.parameters import INPUTS, check_ranges


class Group(NamedTuple):
    """Rows of a table with the same settings: all that a worker needs to evaluate them."""

    where: Ints  # their places in the table
    variants: Variants


def evaluate(
    scenario: Scenario, columns: Mapping[str, Floats], quantities: Sequence[str], threads: int | None = None
) -> dict[str, Any]:
    """Return quantities by name, each an array, (n,), for n rows of values by key of the scenario or name of input.

    Without values, they are those of the scenario itself.  A question without an answer gives NaN.
    """
    return evaluate_groups(groups_of(scenario, columns), quantities, threads)


def groups_of(scenario: Scenario, columns: Mapping[str, Floats]) -> list[Group]:
    """Return rows of values as variants of the scenario, grouped by their settings."""
    inputs = {key: columns[key] for key in columns if key in INPUTS}
    return [
        Group(where, variants_of(made, {key: values[where] for key, values in inputs.items()}, len(where)))
        for where, made in scenarios_of(scenario, columns)
    ]


def scenarios_of(scenario: Scenario, columns: Mapping[str, Floats]) -> Iterator[tuple[Ints, Scenario]]:
    """Check rows of values, and yield their scenarios, each with the places of its rows.

    Inputs go straight into the engine's arrays; each combination of values of other keys makes a scenario.
    """
    count = len(next(iter(columns.values()))) if columns else 1
    others = [key for key in columns if key not in INPUTS]
    check_ranges(scenario, {key: columns[key] for key in columns if key in INPUTS})
    if not others:
        yield np.arange(count), scenario
        return
    table = np.column_stack([columns[key] for key in others])
    _, first, which = np.unique(table, axis=0, return_index=True, return_inverse=True)
    for index, row in enumerate(first):
        made = scenario.replaced(changes_of_values(dict(zip(others, table[row].tolist(), strict=True))))
        yield np.flatnonzero(which.reshape(-1) == index), made


def evaluate_groups(groups: Sequence[Group], quantities: Sequence[str], threads: int | None = None) -> dict[str, Any]:
    """Evaluate quantities for groups of rows, see `evaluate`."""
    answers = [Answers(group.variants, threads) for group in groups]
    order = np.argsort(np.concatenate([group.where for group in groups]), kind="stable")
    return {name: np.concatenate([COLUMNS[name](answer) for answer in answers])[order] for name in quantities}
