"""Completions that the shell offers for a word; typer keeps those that begin with it.

Nothing here needs numpy, so that completions appear at once.  Modules of scenarios are imported only when needed, since
every command imports this module.
"""

import os
import re
from collections.abc import Callable, Iterable, Iterator
from glob import escape, glob
from typing import Any, Literal, get_args, get_origin

import armour.lazy as lazy
from armour.analysis.quantities import QUANTITIES
from armour.files import shipped_files, shipped_notebooks, shipped_suites, shipped_tests
from armour.scenario.inputs import INPUTS, NAMES, NAMING, ROLES, THREAT

# Names of files to offer: zsh evaluates the output of typer, and other shells insert words as they are.
_PLAIN = re.compile(rf"(?:[\w@%+=:,./-]|{re.escape(os.sep)}| (?! ))+")


def shipped_names() -> list[str]:
    """Return the names of shipped scenarios, suites, tables and notebooks."""
    return [*_shipped_scenarios(), *shipped_suites(), *shipped_tests(), *shipped_notebooks()]


def _shipped_scenarios() -> list[str]:
    return list(shipped_files("scenarios", ".toml"))


def _files(ending: str, *shipped: Callable[[], Iterable[str]]) -> Callable[[str], list[str]]:
    """Return the completion of shipped names, and of files beside them; without any, shells offer files and folders."""

    def offered(incomplete: str) -> list[str]:
        names = [name for shipped_by_kind in shipped for name in shipped_by_kind() if name.startswith(incomplete)]
        return names and [*names, *sorted(filter(_PLAIN.fullmatch, glob(f"{escape(incomplete)}*{ending}")))]

    return offered


scenarios = _files(".toml", _shipped_scenarios)
suites = _files(".toml", shipped_suites)
scenarios_and_suites = _files(".toml", shipped_suites, _shipped_scenarios)
tables = _files(".csv", shipped_tests)


def entries() -> list[str]:
    """Return the names in the library."""
    return [*(name for names in lazy.shipped_library().entries.values() for name in names), *lazy.named_threats()]


def inputs() -> list[str]:
    """Return the names of inputs."""
    return list(INPUTS)


def quantities(incomplete: str) -> list[str]:
    """Return the names of quantities that can follow those in an incomplete list."""
    done, comma, _ = incomplete.rpartition(",")
    names = done.split(",") if comma else []
    return [done + comma + name for name in QUANTITIES if name not in names and set(names) <= {*QUANTITIES}]


def numbers(incomplete: str) -> list[str]:
    """Return the keys that a sweep can vary, each with an equals sign."""
    if "=" in incomplete:
        return []
    return [word for word in assignments(incomplete) if word.rstrip("=") not in ("title", *NAMING)]


def assignments(incomplete: str) -> list[str]:
    """Return inputs and keys, each with an equals sign or, after it, the words that the key can have."""
    key, equal, _ = incomplete.partition("=")
    if equal:
        words = {name: lazy.shipped_library().names(ROLES[role]) for role, name in NAMES.items()}
        words[THREAT] = list(lazy.named_threats())
        choices = {name: _choices(annotation) for name, annotation in _keys(lazy.Scenario)}
        return [f"{key}={word}" for word in (choices | words).get(key, ())]
    # The many keys of distributions are useful only once one has been begun.
    depth = 4 if incomplete.startswith("uncertainty.") else 3
    keys = [key for key, _ in _keys(lazy.Scenario) if len(key.split(".")) <= depth]
    return [f"{key}=" for key in dict.fromkeys((*INPUTS, *keys))]


def _keys(model: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the dotted keys, with types, of a section and of those within it, except lists and tables of any name."""
    for name, field in model.model_fields.items():
        inner = lazy.model_in(field.annotation)
        if inner is None:
            yield prefix + name, field.annotation
        elif get_origin(field.annotation) not in (list, dict) and name != "library":
            yield from _keys(inner, f"{prefix}{name}.")


def _choices(annotation: Any) -> list[str]:
    """Return the words of a type of a few words."""
    if get_origin(annotation) is Literal:
        return [word for word in get_args(annotation) if isinstance(word, str)]
    return [word for inner in get_args(annotation) for word in _choices(inner)]
