"""The only conversions between the units of files and tables and SI: multiply to get SI, divide to leave it."""

from collections.abc import Iterable

MM = 1e-3
G = 1e-3
US = 1e-6
MPA = 1e6
GPA = 1e9
KN = 1e3

# How the units end the keys of files and results.
ENDINGS = {
    "_kg_m2": "kg/m²",
    "_kg_m3": "kg/m³",
    "_m_s": "m/s",
    "_percent": "%",
    "_GPa": "GPa",
    "_MPa": "MPa",
    "_mm": "mm",
    "_us": "µs",
    "_g": "g",
}


def words_and_unit(key: str) -> tuple[str, str]:
    """The last part of a dotted key in words, and its unit; empty where it has none."""
    name = key.rsplit(".", 1)[-1]
    for ending, unit in ENDINGS.items():
        if name.endswith(ending):
            return name.removesuffix(ending).replace("_", " "), unit
    return name.replace("_", " "), ""


def missing_unit(name: str, known: Iterable[str]) -> str:
    """A hint at the known name that differs by the unit at its end alone; empty where none does."""
    found = [other for other in known if any(other == name + ending for ending in ENDINGS)]
    return f"; its unit is missing: {found[0]}" if found else ""
