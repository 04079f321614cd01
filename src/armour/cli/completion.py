"""What the shell offers to complete a word, of which typer keeps what starts like it.

Nothing here needs numpy, so that it comes at once. What it needs of scenarios is imported where a word is asked for,
since every command imports this module.
"""

import os
from collections.abc import Iterator
from glob import escape, glob
from typing import Any, get_origin

from armour.analysis.quantities import QUANTITIES
from armour.files import shipped_files


def shipped_names() -> list[str]:
    """Return the names of shipped scenarios."""
    return list(shipped_files("scenarios", ".toml"))


def scenarios(incomplete: str) -> list[str]:
    """Return shipped scenarios, and files beside them; where there are none, shells offer files and folders."""
    return _with_files(shipped_names(), incomplete, ".toml")


def tables(incomplete: str) -> list[str]:
    """Return shipped tables of tests and shots, and files beside them."""
    return _with_files([f"{name}.csv" for name in shipped_files("scenarios/tests", ".csv")], incomplete, ".csv")


def entries() -> list[str]:
    """Return the names in the library."""
    from armour.scenario.library import shipped_library

    # bash takes a word as it is; the scripts of other shells quote it.
    space = "\\ " if os.environ.get("_ARMOUR_COMPLETE") == "complete_bash" else " "
    return [name.replace(" ", space) for names in shipped_library().entries.values() for name in names]


def inputs() -> list[str]:
    """Return the names of inputs."""
    from armour.scenario.parameters import INPUTS

    return list(INPUTS)


def quantities(incomplete: str) -> list[str]:
    """Return the names of quantities after those of a list that are there."""
    done, comma, _ = incomplete.rpartition(",")
    return [done + comma + name for name in QUANTITIES if name not in done.split(",")]


def numbers(incomplete: str) -> list[str]:
    """Return the keys that a sweep can vary, each with a sign of equality."""
    from armour.scenario.parameters import NAMES

    return [word for word in assignments(incomplete) if word.rstrip("=") not in ("title", *NAMES.values())]


def assignments(incomplete: str) -> list[str]:
    """Return inputs and keys, each with a sign of equality or, after the key of a name, the names."""
    from armour.scenario.library import shipped_library
    from armour.scenario.loading import Scenario
    from armour.scenario.parameters import INPUTS, NAMES, ROLES

    for role, key in NAMES.items():
        if incomplete.startswith(f"{key}="):
            return [f"{key}={name}" for name in shipped_library().names(ROLES[role])]
    # The many keys of distributions are only of use where one is begun.
    depth = 4 if incomplete.startswith("uncertainty.") else 3
    keys = [key for key in _keys(Scenario) if len(key.split(".")) <= depth]
    return [f"{key}=" for key in dict.fromkeys((*INPUTS, *keys))]


def _keys(model: Any, prefix: str = "") -> Iterator[str]:
    """Yield the dotted keys of a section and of those within it, but for lists and tables of any name."""
    from armour.scenario.messages import model_in

    for name, field in model.model_fields.items():
        inner = model_in(field.annotation)
        if inner is None:
            yield prefix + name
        elif get_origin(field.annotation) not in (list, dict) and name != "library":
            yield from _keys(inner, f"{prefix}{name}.")


def _with_files(names: list[str], incomplete: str, ending: str) -> list[str]:
    found = [name for name in names if name.startswith(incomplete)]
    return found and [*found, *sorted(glob(f"{escape(incomplete)}*{ending}"))]
