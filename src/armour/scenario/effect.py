"""Check that keys which are changed, or which vary from row to row, affect a computation.

A computation depends on the model, the solver, and the sections and keys of the scenario that are called its `reads`,
such as "impact" or "design.scatter_percent".
"""

from collections.abc import Collection, Iterable, Sequence
from contextlib import suppress

from armour.errors import InputError, Problem, choices, refuse
from armour.scenario.inputs import BACKING, CERAMIC
from armour.scenario.keys import Parts, is_read, key_name, parts_of
from armour.scenario.library import SCATTER_KEYS
from armour.scenario.scenario import Scenario

NO_EFFECT = "must have an effect: {} does not depend on it"


def check_effect(
    keys: Iterable[Parts],
    scenarios: Sequence[tuple[Scenario, Collection[str]]],
    file: str,
    computed: str = "the answer",
    option: str = "",
) -> None:
    """Raise an InputError unless each key affects a computation on at least one of several scenarios.

    Each of `scenarios` is given with the `reads` of the computation on it; `file` is that of the keys, for messages.  A
    key of the library must belong to an entry that a scenario uses.  In messages, `computed` names the result, and
    `option` precedes a key.
    """
    entries = {entry for scenario, _ in scenarios for entry in _entries_of(scenario)}
    reads = {name for scenario, names in scenarios for name in _read_of(scenario, names)}
    problems = {}
    for key in keys:
        if key[0] == "library" and len(key) > 2 and key[1:3] not in entries:
            names = sorted(name for kind, name in entries if kind == key[1])
            hint = choices(key[2], names) if names else ""
            message = f"must be an entry of the library that the scenario uses{hint}"
            problems[key[:3]] = Problem(file, option + key_name(key[:3]), message)
        elif not is_read(key, reads):
            problems[key] = Problem(file, option + key_name(key), NO_EFFECT.format(computed))
    refuse(problems.values())


def check_columns(scenario: Scenario, keys: Sequence[str], reads: Collection[str], file: str, computed: str) -> None:
    """Raise an InputError unless keys that vary from row to row set inputs of the scenario, each another one.

    `reads` and `computed` are as in `check_effect`.
    """
    # No row has a ceramic, and no search varies its thickness.
    is_bare = scenario.armour.ceramic_thickness_mm == 0.0 and CERAMIC not in keys and "optimise" not in reads
    problems = []
    setters: dict[str, str] = {}
    for key in keys:
        parts = parts_of(key)
        name = _input_set_by(scenario, parts, reads) if parts[0] == "library" else key
        if not name:
            problems.append(Problem(file, key, NO_EFFECT.format(computed)))
        elif name.startswith("ceramic.") and is_bare:
            problems.append(Problem(file, key, f"must not be given if {CERAMIC} is 0"))
        elif setters.setdefault(name, key) != key:
            problems.append(Problem(file, key, f"must not be given with {setters[name]}, which sets the same input"))
    refuse(problems)


def _input_set_by(scenario: Scenario, parts: Parts, reads: Collection[str]) -> str:
    """Return the name of the input that changes with a number of a library entry; "" if no input does.

    `parts` are those of the number's key; a scatter of shots, which is no input, gives its own key if it is read.
    """
    _, kind, name, key = parts[:4]
    if key == SCATTER_KEYS[0]:
        return key_name(parts) if f"design.{key}" in reads else ""
    value = scenario.entry(kind, name)[key]  # type: ignore[arg-type]
    inputs = scenario.inputs()
    for factor in (1.01, 0.99):  # one of them is within the bounds
        with suppress(InputError):
            changed = scenario.replaced({key_name(parts[:4]): factor * value or 0.01}).inputs()
            return next((name for name in inputs if inputs[name] != changed[name]), "")
    return ""


def _read_of(scenario: Scenario, reads: Collection[str]) -> set[str]:
    """Return the sections and keys of a scenario that a computation depends on, given its `reads`.

    If it reads threats or a catalogue, the keys that these replace are left out.  If the section ``uncertainty`` has no
    distributions, computations with threats depend only on its model error.
    """
    replaced: set[str] = set()
    if "threat" in reads and not scenario.distributions():
        reads, replaced = {*reads, "uncertainty.model"}, {"uncertainty"}
    if "threat" in reads and scenario.threat:
        replaced |= {"impact"}
    if "design" in reads and scenario.design is not None:
        replaced |= {f"armour.{layer}" for layer in ("ceramic", "backing") if getattr(scenario.design, layer)}
        if scenario.design.existing:
            reads, replaced = {*reads, "armour.backing", BACKING}, replaced - {"armour.backing"}
    return {*reads} - replaced


def _entries_of(scenario: Scenario) -> set[tuple[str, str]]:
    """Return kind and name of each library entry that a scenario uses: those it names, and those they are based on."""
    entries: set[tuple[str, str]] = set()
    for kind, named in scenario.named_entries():
        own_entries, name = getattr(scenario.library, kind), named
        while name and (kind, name) not in entries:
            entries.add((kind, name))
            name = own_entries[name].based_on if name in own_entries else ""
    return entries
