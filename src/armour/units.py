"""Conversion factors from the units of files and tables to SI: multiply to convert to SI, divide to convert back."""

from collections.abc import Sequence

MM = 1e-3
G = 1e-3
US = 1e-6
MPA = 1e6
GPA = 1e9
KN = 1e3

# Units by the ending of a key; a longer ending precedes any that it ends with.
ENDINGS = {
    "_kg_m2": "kg/m²",
    "_kg_m3": "kg/m³",
    "_m_s": "m/s",
    "_percent": "%",
    "_GPa": "GPa",
    "_MPa": "MPa",
    "_mm": "mm",
    "_us": "µs",
    "_deg": "°",
    "_g": "g",
}


def words_and_unit(key: str) -> tuple[str, str]:
    """Split the last part of a dotted key into words and unit, such as "ceramic thickness" and "mm", or ""."""
    name = key.rsplit(".", 1)[-1]
    for ending, unit in ENDINGS.items():
        if name.endswith(ending):
            return name.removesuffix(ending).replace("_", " "), unit
    return name.replace("_", " "), ""


def missing_unit(name: str, names: Sequence[str]) -> str:
    """Return a hint at the name that differs from a wrong one only by a unit at its end; "" if there is none."""
    complete = next((f"{name}{ending}" for ending in ENDINGS if f"{name}{ending}" in names), "")
    return f"; its unit is missing: {complete}" if complete else ""
