"""Complete words in the shell: return candidates, of which typer keeps those that begin with the word.

Nothing here needs numpy, so that completions appear at once.  Every command imports this module, so it imports the
modules of scenarios only when needed.
"""

import os
import re
from collections.abc import Callable, Iterable, Iterator
from glob import escape, glob
from typing import Any, Literal, get_args, get_origin

import armour
from armour.analysis.quantities import QUANTITIES
from armour.files import shipped_files, shipped_notebooks, shipped_suites, shipped_tests
from armour.scenario.inputs import INPUTS, NAMES, NAMING, ROLES, THREAT

# Names of files that are safe to offer: zsh evaluates the output of typer, other shells insert it without quotes.
_PLAIN = re.compile(rf"(?:[\w@%+=:,./-]|{re.escape(os.sep)}| (?! ))+")


def shipped_names() -> list[str]:
    """Return the names of shipped scenarios, suites, tables and notebooks."""
    return [*_shipped_scenarios(), *shipped_suites(), *shipped_tests(), *shipped_notebooks()]


def _shipped_scenarios() -> list[str]:
    return list(shipped_files("scenarios", ".toml"))


def _files(ending: str, *shipped: Callable[[], Iterable[str]]) -> Callable[[str], list[str]]:
    """Return a function that completes a word to shipped names and to files with an ending.

    If no shipped name begins with the word, it returns nothing, and shells complete to files and folders.
    """

    def offered(incomplete: str) -> list[str]:
        names = [name for shipped_by_kind in shipped for name in shipped_by_kind() if name.startswith(incomplete)]
        return names and [*names, *sorted(filter(_PLAIN.fullmatch, glob(f"{escape(incomplete)}*{ending}")))]

    return offered


scenarios = _files(".toml", _shipped_scenarios)
suites = _files(".toml", shipped_suites)
scenarios_and_suites = _files(".toml", shipped_suites, _shipped_scenarios)
tables = _files(".csv", shipped_tests)


def entries() -> list[str]:
    """Return the names of all entries and threats in the library."""
    from armour.scenario.library import named_threats

    return [*(name for names in armour.shipped_library().entries.values() for name in names), *named_threats()]


def inputs() -> list[str]:
    """Return the names of inputs."""
    return list(INPUTS)


def quantities(incomplete: str) -> list[str]:
    """Complete a list of quantities separated by commas with each quantity that is not in it."""
    done, comma, _ = incomplete.rpartition(",")
    names = done.split(",") if comma else []
    return [done + comma + name for name in QUANTITIES if name not in names and set(names) <= {*QUANTITIES}]


def numbers(incomplete: str) -> list[str]:
    """Return the keys that a sweep can vary, each followed by "=", while no "=" is typed."""
    if "=" in incomplete:
        return []
    return [word for word in assignments(incomplete) if word.rstrip("=") not in ("title", *NAMING)]


def assignments(incomplete: str) -> list[str]:
    """Return all inputs and keys, each followed by "="; once "=" is typed, the words that the key can have."""
    from armour.scenario.library import named_threats

    key, equal, _ = incomplete.partition("=")
    if equal:
        words = {name: armour.shipped_library().names(ROLES[role]) for role, name in NAMES.items()}
        words[THREAT] = list(named_threats())
        choices = {name: _choices(annotation) for name, annotation in _keys(armour.Scenario)}
        return [f"{key}={word}" for word in (choices | words).get(key, ())]
    # The many keys of distributions are offered only once "uncertainty." is typed.
    depth = 4 if incomplete.startswith("uncertainty.") else 3
    keys = [key for key, _ in _keys(armour.Scenario) if len(key.split(".")) <= depth]
    return [f"{key}=" for key in dict.fromkeys((*INPUTS, *keys))]


def _keys(model: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the dotted keys of a section and of the sections within it, each with its type.

    Skip arrays of tables, tables with names of the user's choice, and the library.
    """
    from armour.scenario.sections import model_in

    for name, field in model.model_fields.items():
        inner = model_in(field.annotation)
        if inner is None:
            yield prefix + name, field.annotation
        elif get_origin(field.annotation) not in (list, dict) and name != "library":
            yield from _keys(inner, f"{prefix}{name}.")


def _choices(annotation: Any) -> list[str]:
    """Return the words that a type permits by `Literal`, also within unions."""
    if get_origin(annotation) is Literal:
        return [word for word in get_args(annotation) if isinstance(word, str)]
    return [word for inner in get_args(annotation) for word in _choices(inner)]
