"""The only conversions between the units of files and tables and SI: multiply to get SI, divide to leave it."""

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
    "_us": "us",
    "_g": "g",
}


def words_and_unit(key: str) -> tuple[str, str]:
    """The last part of a dotted key in words, and its unit; empty where it has none."""
    name = key.rsplit(".", 1)[-1]
    for ending, unit in ENDINGS.items():
        if name.endswith(ending):
            return name.removesuffix(ending).replace("_", " "), unit
    return name.replace("_", " "), ""
