"""Perturb every input of the library that the paper's suite uses; every scored case must fail under one of them.

A case that stays within its band whatever changes by up to 20 % is no case: it may be shown, but must not be scored.

    python -m tools.campaigns perturbations

prints the least change of a single input that makes each scored case and table leave its band, and exits with 3 if
there is none for some. The mass of the penetrator is kept
where its diameter or density changes, which changes its length: this too must be by at most 20 %.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

from armour.scenario.inputs import INPUTS, ROLES, Kind
from armour.scenario.keys import key_name
from armour.validation.suite import Suite, load_suite
from armour.validation.validate import FAILED, validate
from tools.campaigns.verdict import verdict

# Changes of an input, from the least: a result need not depend on it monotonically.
STEPS = (0.01, 0.02, 0.03, 0.05, 0.08, 0.1, 0.15, 0.2)
# Powers of the projectile's values in the length of the penetrator.
LENGTH = {"penetrator_mass_g": 1, "density_kg_m3": -1, "penetrator_diameter_mm": -2}


class Perturbation(NamedTuple):
    """A relative change of a value of a library entry."""

    kind: Kind
    entry: str
    key: str
    value: float
    change: float

    @property
    def changes(self) -> dict[str, object]:
        """The change as keys of a scenario."""
        section = key_name(["library", self.kind, self.entry])
        value = self.value * (1.0 + self.change)
        return {f"{section}.based_on": self.entry, f"{section}.{self.key}": value}

    def __str__(self) -> str:
        return f"{100.0 * self.change:+.0f} % {self.key} of {self.entry}"


def scored(suite: Suite) -> list[str]:
    """Return the names of the cases and tables that a suite holds to a band."""
    tables = [table for table in suite.tables if (table.rms_band, table.rms_band_percent) != (None, None)]
    return [*(case.full_name for case in suite.cases if not case.not_scored), *(table.name for table in tables)]


def perturbations(suite: Suite) -> Iterator[Perturbation]:
    """Yield the perturbations of all entries that a suite uses, from the least change."""
    values: dict[tuple[Kind, str, str], float] = {}
    for case in suite.cases:
        for scenario in case.scenarios:
            for role, kind in ROLES.items():
                entry = scenario.entry_of(role)
                keys = [one.key for one in INPUTS.values() if one.section == role]
                if entry is not None:
                    values.update({(kind, entry.name, key): entry[key] for key in keys if key in entry.values})
    for step in STEPS:
        for change in (step, -step):
            for (kind, name, key), value in values.items():
                length = (1.0 + change) ** LENGTH.get(key, 0) if kind == "projectile" else 1.0
                if abs(length - 1.0) <= STEPS[-1]:
                    yield Perturbation(kind, name, key, value, change)


def outside(suite: Suite, perturbation: Perturbation) -> set[str]:
    """Return the scored cases and tables of a suite that a perturbation makes leave their bands."""
    changed = load_suite(suite.file, perturbation.changes)
    role = next(role for role, kind in ROLES.items() if kind == perturbation.kind)
    using = {
        case.full_name
        for case in suite.cases
        if any(scenario.name_of(role) == perturbation.entry for scenario in case.scenarios)
    }
    result = validate(replace(changed, cases=tuple(case for case in changed.cases if case.full_name in using)))
    failed = {check.case.full_name for check in result.checks if check.status in FAILED}
    return failed | {summary.full_name for summary in result.summaries if summary.status in FAILED}


def survivors(suite: Suite, some: Iterable[Perturbation]) -> list[str]:
    """Return the scored cases and tables that none of some perturbations makes fail; print what makes the others."""
    left = dict.fromkeys(scored(suite))
    for perturbation in some:
        # Only what nothing has made fail yet; a table needs all its rows.
        rest = replace(suite, cases=tuple(c for c in suite.cases if c.full_name in left or c.group in left))
        for name in outside(rest, perturbation):
            if name in left:
                del left[name]
                print(f"{name}: {perturbation}", flush=True)
    return list(left)


def main() -> int:
    """Run all perturbations; the exit code is 3 if something scored stays within its band under all."""
    suite = load_suite("paper")
    left = survivors(suite, perturbations(suite))
    number = len(scored(suite))
    text = f"{number - len(left)} of {number} scored values leave their bands; not: {', '.join(left) or 'none'}"
    return verdict(text, right=not left)
