"""Complete words in the shell: return candidates, of which typer keeps those that begin with the word.

Nothing here needs numpy, so that completions appear at once.
"""

from collections.abc import Callable, Iterable
from glob import escape, glob

import armour
from armour.analysis.quantities import QUANTITIES
from armour.files import shipped_files, shipped_notebooks, shipped_suites, shipped_tests
from armour.scenario.inputs import INPUTS, NAMES, NAMING, ROLES, THREAT
from armour.scenario.library import named_threats


def shipped_scenarios() -> list[str]:
    """Return the names of shipped scenarios."""
    return list(shipped_files("scenarios", ".toml"))


def shipped_names() -> list[str]:
    """Return the names of shipped scenarios, suites, tables and notebooks."""
    return [*shipped_scenarios(), *shipped_suites(), *shipped_tests(), *shipped_notebooks()]


def _shipped(*kinds: Callable[[], Iterable[str]]) -> Callable[[str], list[str]]:
    """Return a function that completes a word to names of these kinds, or to none if a file begins with the word.

    Shells then complete to files.  No name of a file is returned, as shells may evaluate what is.
    """

    def offered(incomplete: str) -> list[str]:
        return [] if glob(f"{escape(incomplete)}*") else [name for names in kinds for name in names()]

    return offered


scenarios = _shipped(shipped_scenarios)
suites = _shipped(shipped_suites)
scenarios_and_suites = _shipped(shipped_suites, shipped_scenarios)
tables = _shipped(shipped_tests)


def entries() -> list[str]:
    """Return the names of all entries and threats in the library."""
    return [*(name for names in armour.shipped_library().entries.values() for name in names), *named_threats()]


def inputs() -> list[str]:
    """Return the names of inputs."""
    return list(INPUTS)


def quantities(incomplete: str) -> list[str]:
    """Complete a list of quantities separated by commas with each quantity that is not in it."""
    done, comma, _ = incomplete.rpartition(",")
    names = done.split(",") if comma else []
    return [done + comma + name for name in QUANTITIES if name not in names and set(names) <= {*QUANTITIES}]


def axes() -> list[str]:
    """Return the inputs that a sweep can vary, each followed by "="."""
    return [f"{name}=" for name in INPUTS]


def assignments(incomplete: str) -> list[str]:
    """Return the inputs, each followed by "="; once it is typed, the names of the library that the input can have."""
    key, equal, _ = incomplete.partition("=")
    if not equal:
        return [f"{name}=" for name in (*INPUTS, *NAMING)]
    names = {name: armour.shipped_library().names(ROLES[role]) for role, name in NAMES.items()}
    return [f"{key}={name}" for name in {**names, THREAT: named_threats()}.get(key, ())]
