"""Reach of keys that are changed, or vary from row to row: whether their values can change what is computed.

A computation reads the projectile, the armour, the model and the solver, and what its `reads` name: sections, or keys.
A key of the library counts where the impact or the armour takes its value from it.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence

from armour.errors import Problem, choices, refuse
from armour.scenario.inputs import ANY_IMPACT, CERAMIC, INPUTS, NAMES, ROLES
from armour.scenario.keys import key_name, leaves, parts_of, upwards
from armour.scenario.library import UNUSED, Kind
from armour.scenario.scenario import Scenario

# What every computation reads.
ALWAYS = ("model", "solver")
NO_EFFECT = "must have an effect: {} does not depend on it"


def check_read(changes: Mapping[str, object], reads: Collection[str], what: str = "the answer") -> None:
    """Check that a command reads what options set, but for the library, see `check_used`, and the title.

    `what` is what it computes, in words.  It reads an input of a role where it reads the name in that role.
    """
    read = {*ALWAYS, *reads, "title", "library"}
    keys = [leaf for key, value in changes.items() for leaf, _ in leaves(value, parts_of(key))]
    refuse(
        Problem("command line", f"--set {key_name(key)}", NO_EFFECT.format(what))
        for key in keys
        if read.isdisjoint(upwards(NAMES.get(key[0]) or key_name(key)))
    )


def read_of(scenario: Scenario, reads: Collection[str]) -> set[str]:
    """Return what a command reads of a scenario: not what threats and a catalogue replace, if it reads these.

    Of a section ``uncertainty`` without distributions, a design, and a report, depend on the model error alone.
    """
    replaced: set[str] = set()
    if "threat" in reads and not (scenario.uncertainty is not None and scenario.uncertainty.inputs()):
        reads, replaced = {*reads, "uncertainty.model"}, {"uncertainty"}
    if "threat" in reads and scenario.threat:
        replaced |= {"impact"}
    if "design" in reads and scenario.design is not None:
        replaced |= {f"armour.{layer}" for layer in ("ceramic", "backing") if getattr(scenario.design, layer)}
    return {*reads} - replaced


def check_reach(
    scenario: Scenario,
    keys: Sequence[str],
    reads: Collection[str],
    file: str,
    what: str = "the answer",
    *,
    closed_forms: bool = False,
) -> None:
    """Check that each of the keys counts for a computation, of `what` in words.

    Closed forms also read the optional values of the library.
    """
    read = {*ALWAYS, *ANY_IMPACT, *reads}
    problems = []
    given: dict[str, str] = {}
    # No row has a ceramic, and no search varies its thickness.
    bare = scenario.armour.ceramic_thickness_mm == 0.0 and CERAMIC not in keys and "optimise" not in reads
    for key in keys:
        section, *rest = parts_of(key)
        name = key if key in INPUTS else scenario.input_of((*rest,)) if section == "library" else ""
        counts = name.split(".")[0] in ROLES or not read.isdisjoint(upwards(key))
        if not counts and not (closed_forms and {*rest} & {*UNUSED}):
            used = ", ".join(f'{role} "{scenario.name_of(role)}"' for role in ROLES if scenario.name_of(role))
            hint = f"; the scenario has the {used}" if section == "library" else ""
            problems.append(Problem(file, key, NO_EFFECT.format(what) + hint))
        elif name.startswith("ceramic.") and bare:
            problems.append(Problem(file, key, f"must not be given if {CERAMIC} is 0"))
        elif name and given.setdefault(name, key) != key:
            problems.append(Problem(file, key, f"must not be given with {given[name]}, which sets the same input"))
    refuse(problems)


def check_used(
    changes: Mapping[str, object], *scenarios: Scenario, file: str = "command line", option: str = "--set "
) -> None:
    """Check that the scenarios use every entry of the library that changes, in a file or by an option, set."""
    used = {entry for scenario in scenarios for entry in _entries_of(scenario)}
    problems = {}
    for key, value in changes.items():
        for leaf, _ in leaves(value, parts_of(key)):
            if leaf[0] == "library" and len(leaf) > 2 and leaf[1:3] not in used:
                names = sorted(name for kind, name in used if kind == leaf[1])
                hint = choices(leaf[2], names) if names else ""
                message = f"must be an entry of the library that the scenario uses{hint}"
                problems[leaf[:3]] = Problem(file, option + key_name(leaf[:3]), message)
    refuse(problems.values())


def _entries_of(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Yield kind and name of the entries that a scenario names, and of those that they are based on."""
    named: list[tuple[Kind, str | None]] = [(kind, scenario.name_of(role)) for role, kind in ROLES.items()]
    named += [("projectile", threat.projectile) for threat in scenario.threat]
    if scenario.design is not None:
        named += [("ceramic", layer.material) for layer in scenario.design.ceramic]
        named += [("metal", layer.material) for layer in scenario.design.backing]
    for kind, name in named:
        yield from ((kind, base) for base in scenario.bases_of(kind, name or ""))
