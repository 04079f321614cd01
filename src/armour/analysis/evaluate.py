"""Evaluate quantities of a scenario for many values of its keys at once, in rows.

Sweeps, suites, figures, uncertainty, sensitivity, calibration and designs use this module, or `Variants` directly.
A question without an answer gives NaN; a run that does not end raises an InputError that names the key at fault.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from armour.analysis.quantities import QUANTITIES, reads_of, with_round
from armour.analysis.variants import Bools, Floats, Ints, Variants, ballistic_limits, grid_of, variants_of
from armour.core import equations
from armour.core.state import Outcome
from armour.engine import batch
from armour.errors import InputError, Problem, choices, refuse, restated
from armour.evidence.mixture import Mixture
from armour.evidence.tests import far_from_tests
from armour.scenario.effect import check_columns, check_effect
from armour.scenario.inputs import INPUTS
from armour.scenario.keys import canonical, parts_of
from armour.scenario.scenario import EXACT_INPUTS, Place, Scenario, in_row
from armour.units import MM, US, G


class Group(NamedTuple):
    """Rows of a table with the same settings: all that a worker needs to evaluate them."""

    where: Ints  # indices of the rows in the table
    variants: Variants


def evaluate(scenario: Scenario, columns: Mapping[str, Any], quantities: Sequence[str]) -> dict[str, Any]:
    """Evaluate quantities, given by name, for n rows; return an array, (n,), by name of quantity.

    `columns` has the values of the rows, (n,), by key of the scenario or name of input; without columns, the only row
    is the scenario itself.  A question without an answer gives NaN.  Raise an InputError if a quantity is unknown, a
    row is not valid, or a key has no effect.
    """
    check_quantities(scenario, quantities, "evaluate")
    check_keys(scenario, {key: values[0].item() for key, values in columns.items()}, quantities, "evaluate")
    return evaluate_groups(groups_of(scenario, columns), quantities)[0]


def check_quantities(scenario: Scenario, quantities: Sequence[str], file: str) -> None:
    """Check that quantities are known, and that the scenario has a grid if one needs it; messages name `file`."""
    unknown = [name for name in quantities if name not in QUANTITIES]
    problems = [
        Problem(file, "quantities", f'unknown quantity "{name}"{choices(name, list(QUANTITIES))}') for name in unknown
    ]
    if any(QUANTITIES[name].on_grid for name in quantities if name not in unknown):
        try:
            grid_of(scenario)
        except InputError as error:
            problems += error.problems
    refuse(problems)


def check_keys(scenario: Scenario, row: Mapping[str, float | str], quantities: Sequence[str], file: str) -> None:
    """Check that each key of a table affects the quantities; `row` is one row of it, `file` its name for messages."""
    row = dict(zip(canonical(row, file), row.values(), strict=True))
    try:
        changed = scenario.replaced({key: value for key, value in row.items() if key not in INPUTS})
    except InputError:
        return  # the check of the rows reports it
    reads, computed = [with_round(QUANTITIES[name].reads) for name in quantities], " or ".join(quantities)
    check_effect(map(parts_of, row), [(changed, each) for each in reads], file, computed)
    check_columns(changed, list(row), set().union(*reads), file, computed)


def groups_of(scenario: Scenario, columns: Mapping[str, Floats]) -> list[Group]:
    """Return rows of values as variants of the scenario, in a group for each combination of settings."""
    found = scenarios_of(scenario, columns)
    return [Group(where, variants_of(changed, inputs, len(where))) for where, changed, inputs in found]


def scenarios_of(
    scenario: Scenario, columns: Mapping[str, Floats], place: Place = in_row
) -> Iterator[tuple[Ints, Scenario, dict[str, Floats]]]:
    """Check rows of values; yield each scenario with the indices of its rows and the rows' values of inputs, by name.

    Each combination of values of the keys that are not inputs makes a scenario.  `place` takes the index of a row and
    its problem, and returns the problem with the row named.
    """
    columns = dict(zip(canonical(columns, scenario.file), columns.values(), strict=True))
    count = len(next(iter(columns.values()))) if columns else 1
    settings = [key for key in columns if key not in INPUTS]
    inputs = {key: columns[key] for key in columns if key in INPUTS}
    if not settings:
        scenario.check_rows(inputs, place)
        yield np.arange(count), scenario, inputs
        return
    # Indices into the sorted values, since the values may be numbers in one column and names in another.
    table = np.column_stack([np.unique(columns[key], return_inverse=True)[1] for key in settings])
    _, first, combination_of_row = np.unique(table, axis=0, return_index=True, return_inverse=True)
    for index in np.argsort(first):
        row = int(first[index])
        with restated(partial(place, row)):
            changed = scenario.replaced({key: columns[key][row].item() for key in settings})
        where = np.flatnonzero(combination_of_row == index)
        inputs_of_rows = {key: values[where] for key, values in inputs.items()}
        changed.check_rows(inputs_of_rows, partial(lambda where, row, problem: place(int(where[row]), problem), where))
        yield where, changed, inputs_of_rows


def evaluate_groups(
    groups: Sequence[Group], quantities: Sequence[str], threads: int | None = None
) -> tuple[dict[str, Any], Counter[str]]:
    """Evaluate quantities for groups of rows; return them, (n,) by name, and the number of rows of each warning.

    On `threads`, see `Variants`.  The verdict is left out, as `armour.design.check.evaluated` gives it.
    """
    answers = [QuantityValues(group.variants._replace(threads=threads)) for group in groups]
    order = np.argsort(np.concatenate([group.where for group in groups]), kind="stable")
    computed = {name: COMPUTED[name] for name in quantities if name in COMPUTED}
    columns = {name: np.concatenate([*map(compute, answers)])[order] for name, compute in computed.items()}
    warnings: Counter[str] = Counter()
    for answer in answers:
        warnings.update(dict(answer.variants.caveats()))
        warnings.update(answer.changes(quantities))
        if "uncertainty.model" in reads_of(computed) and answer.variants.scenario.unused_distributions():
            warnings[f"uncertainty: {EXACT_INPUTS}"] += len(answer.variants.velocities)
    return columns, warnings


def far_of(scenario: Scenario, columns: Mapping[str, Any]) -> Bools:
    """Return whether each of n rows of values is far from the tests, (n,); `columns` as in `evaluate`."""
    groups = groups_of(scenario, columns)
    is_far = np.zeros(sum(len(group.where) for group in groups), dtype=bool)
    for where, variants in groups:
        rows = (variants.armours.at([row]) for row in range(len(where)))
        is_far[where] = [bool(far_from_tests(variants.scenario, row)) for row in rows]
    return is_far


# Warnings for rows whose outcome changes more than once.
AGAIN = "the outcome changes more than once with the impact velocity, and the lowest change is taken"
THICKER = "a thicker {} is perforated at a velocity that a thinner one stops"


class QuantityValues:
    """Values of quantities of n variants, arrays of shape (n,); NaN where a quantity has no value.

    Each computation is done once, when it is first needed.
    """

    def __init__(self, variants: Variants) -> None:
        self.variants = variants
        # Least thicknesses of the "ceramic", "back plate" or whole "armour" that stop the impacts.
        self.least = cache(variants.least_thicknesses)

    @cached_property
    def impacts(self) -> batch.ImpactBatch:
        """Outcome and final state of each impact."""
        return self.variants.impacts()

    @cached_property
    def perforated(self) -> Bools:
        """Whether each impact perforates."""
        return self.impacts.outcome == Outcome.PERFORATED

    @cached_property
    def ballistic_limits(self) -> Floats:
        """Ballistic limits, m/s; NaN for none in the range of the section ``ballistic_limit``."""
        limits = ballistic_limits(self.variants)
        return np.where(np.isfinite(limits), limits, np.nan)

    @cached_property
    def with_least_ceramic(self) -> Variants:
        """The variants with the least ceramic thickness that stops the impact."""
        return self.variants.with_thicknesses(ceramic_mm=self.least("ceramic").mm)

    @cached_property
    def with_least_backing(self) -> Variants:
        """The variants with the least back plate thickness that stops the impact."""
        return self.variants.with_thicknesses(backing_mm=self.least("back plate").mm)

    @cached_property
    def residual_velocities(self) -> Floats:
        """Residual velocities, m/s; 0 if the projectile is stopped."""
        return np.where(self.perforated, self.impacts.V, 0.0)

    @cached_property
    def residual_masses(self) -> Floats:
        """Residual masses of the penetrators, g."""
        return self.fields.rho_p * equations.cross_section(self.fields.D0) * self.impacts.L / G

    @property
    def fields(self) -> Any:
        """Parameters of the variants, an array, (n,), by field of the core."""
        return batch.fields(self.variants.parameters)

    @cached_property
    def shots(self) -> Mixture:
        """Distributions of the velocities below which shots are stopped, given model error and scatter of shots."""
        return self.variants.shot_distributions(self.ballistic_limits)

    def changes(self, quantities: Sequence[str]) -> dict[str, int]:
        """Return warnings that the outcome changes more than once, for quantities, each with the number of its rows."""
        rows_by_words: dict[str, Bools] = {}
        if limits := [name for name in quantities if "ballistic_limit" in QUANTITIES[name].reads]:
            rows_by_words[f"{', '.join(limits)}: {AGAIN}"] = self.variants.stops_again_above(self.ballistic_limits)
        for name in quantities:
            if layer := QUANTITIES[name].least:
                rows_by_words[f"{name}: {THICKER.format(layer)}"] = self.least(layer).changes_again
        return {words: int(np.count_nonzero(rows)) for words, rows in rows_by_words.items() if rows.any()}


# Values of each quantity but the verdict, which `armour.design.check` gives.
COMPUTED: dict[str, Callable[[QuantityValues], Any]] = {
    "outcome": lambda a: np.where(a.perforated, "perforated", "stopped"),
    "residual_velocity_m_s": lambda a: a.residual_velocities,
    "residual_mass_g": lambda a: a.residual_masses,
    "residual_length_mm": lambda a: a.impacts.L / MM,
    "velocity_lost_percent": lambda a: 100.0 * (1.0 - a.residual_velocities / a.variants.velocities),
    "mass_lost_percent": lambda a: 100.0 * (1.0 - (a.impacts.L / MM) / (a.fields.L0 / MM)),
    "penetration_depth_mm": lambda a: a.impacts.Z / MM,
    "bulge_height_mm": lambda a: a.impacts.h / MM,
    "plug_velocity_m_s": lambda a: np.where(a.perforated, a.impacts.W, 0.0),
    "duration_us": lambda a: a.impacts.t / US,
    "areal_density_kg_m2": lambda a: a.variants.areal_densities_kg_m2(),
    "whole_areal_density_kg_m2": lambda a: a.variants.areal_densities_kg_m2(whole=True),
    "ballistic_limit_m_s": lambda a: a.ballistic_limits,
    "expected_limit_m_s": lambda a: a.shots.quantile(0.5),
    "probability_of_stopping": lambda a: np.minimum(
        a.shots.probability_above(a.variants.velocities), a.variants.errors.greatest
    ),
    "required_ceramic_thickness_mm": lambda a: a.with_least_ceramic.ceramics_mm,
    "required_backing_thickness_mm": lambda a: a.with_least_backing.backings_mm,
    "required_total_thickness_mm": lambda a: a.least("armour").mm,
    "required_areal_density_kg_m2": lambda a: a.with_least_ceramic.areal_densities_kg_m2(),
}
