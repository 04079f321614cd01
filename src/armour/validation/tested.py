"""Partners of the entries of the library in the tests from which the model error is estimated."""

from functools import cache

import numpy as np

from armour.analysis.evaluate import groups_of
from armour.csv_files import shipped_rows
from armour.files import shipped_files
from armour.scenario.inputs import BACKING, CERAMIC, NAMES, Kind
from armour.scenario.library import shipped_library
from armour.scenario.scenario import load_scenario


@cache
def tested_with() -> dict[tuple[Kind, str], tuple[str, ...]]:
    """Return the rounds with which each material was tested, and the materials of each round, by kind and name."""
    # Files of the same name in the working folder must not replace the shipped ones.
    library, case = shipped_library(), load_scenario(shipped_files("scenarios", ".toml")["wilkins"])
    rounds = library.known("projectile")
    plates = [row for row in shipped_rows("tests/plates") if row["round"] in rounds]
    tested: dict[tuple[Kind, str], dict[str, None]] = {}

    def add(kind: Kind, name: str, words: str) -> None:
        tested.setdefault((kind, name), {})[words] = None

    bare = {
        NAMES["backing"]: np.array([row["plate"] for row in plates]),
        NAMES["projectile"]: np.array([rounds[row["round"]] for row in plates]),
        BACKING: np.array([float(row[BACKING]) for row in plates]),
    }
    for group in groups_of(case.replaced({CERAMIC: 0.0}), bare):
        if group.variants.errors.known.any():
            metal, projectile = (str(bare[NAMES[role]][group.where[0]]) for role in ("backing", "projectile"))
            add("metal", metal, projectile)
            add("projectile", projectile, metal)
    layers = {key: np.array([float(row[key]) for row in shipped_rows("tests/wilkins")]) for key in (CERAMIC, BACKING)}
    metal, projectile = case.armour.backing, case.impact.projectile
    for ceramic in library.names("ceramic"):
        [group] = groups_of(case.replaced({NAMES["ceramic"]: ceramic}), layers)
        if group.variants.errors.known.any():
            add("ceramic", ceramic, f"{projectile}, on {metal}")
            add("metal", metal, f"{projectile}, with {case.armour.ceramic}")
            add("projectile", projectile, f"{case.armour.ceramic} on {metal}")
    return {entry: tuple(words) for entry, words in tested.items()}
