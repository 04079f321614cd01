"""Conversion factors from the units of files and tables to SI: multiply to convert to SI, divide to convert back."""

import re
from collections.abc import Sequence

MM = 1e-3
G = 1e-3
US = 1e-6
FT = 0.3048
MPA = 1e6
GPA = 1e9
KN = 1e3

# Units by the ending of a key; the first ending that fits counts.
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


def feet_note(velocity_m_s: float, limit_m_s: float) -> str:
    """Return a note if the ratio of a velocity to a limit suggests that one of them is in ft/s; otherwise ""."""
    ratio = velocity_m_s / limit_m_s
    for factor, unit in ((1.0 / FT, "ft/s"), (FT, "m/s in a column of ft/s")):
        if 1.0 / 1.4 < ratio / factor < 1.4:  # as much as a computed limit and a measured one may differ
            return (
                f"the velocities, about {velocity_m_s:.0f} m/s, are {ratio:.2g} times the limit by the model, "
                f"{limit_m_s:.0f} m/s: they are probably {unit}; give the unit in the header, as in Velocity (ft/s)"
            )
    return ""


def words_and_unit(key: str) -> tuple[str, str]:
    """Split the last part of a dotted key into words and unit, such as "ceramic thickness" and "mm", or ""."""
    name = key.rsplit(".", 1)[-1]
    for ending, unit in ENDINGS.items():
        if name.endswith(ending):
            return name.removesuffix(ending).replace("_", " "), unit
    return name.replace("_", " "), ""


def key_hint(name: str, names: Sequence[str]) -> str:
    """Return a hint at the one of `names` that differs from a wrong name only by section or unit; "" if none does."""
    keys: dict[str, str] = {}
    for key in names:
        keys.setdefault(key, key)
        keys.setdefault(key.rpartition(".")[2], key)
    if name in keys:
        return f'; did you mean "{keys[name]}"?'
    stems = {word.removesuffix(ending): word for ending in ENDINGS for word in keys if word.endswith(ending)}
    if name in stems:
        return f"; its unit is missing: {keys[stems[name]]}"
    for stem, word in stems.items():
        # Another unit has short parts, such as ft and s.
        if re.fullmatch(rf"{re.escape(stem)}(_[^_]{{1,4}})+", name):
            return f"; its unit must be {words_and_unit(word)[1]}: {keys[word]}"
    return ""
