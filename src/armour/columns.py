"""Names of the columns of tables that people write, in English, German and French, and the words in their cells."""

import re
import unicodedata
from collections.abc import Sequence
from functools import cache, lru_cache
from typing import NamedTuple

from armour.units import words_and_unit

VELOCITIES = (
    *("velocity", "v", "impact velocity", "striking velocity", "strike velocity", "shot velocity", "speed"),
    *("Geschwindigkeit", "Auftreffgeschwindigkeit", "vitesse", "vitesse d'impact"),
)
RESULTS = ("result", "outcome", "penetration", "Ergebnis", "Resultat", "Befund", "résultat", "résultat du tir")
SHOT_NAMES = (
    *("shot", "shot #", "shot no", "shot number", "shot id", "no", "nr", "#", "number", "round no"),
    *("Schuss", "Schuss-Nr.", "Schussnummer", "Nummer", "lfd. Nr.", "tir", "tir n°", "n° de tir", "n°", "numéro"),
)
# Usual names of columns by key, without the unit, whose letters, spaces and punctuation do not matter.
NAMES: dict[str, tuple[str, ...]] = {
    "shot": SHOT_NAMES,
    "velocity_m_s": VELOCITIES,
    "result": RESULTS,
    "perforated": (
        *("perforated", "perforation", "complete", "complete penetration"),
        *("Durchschlag", "durchschlagen", "perforé", "perforation complète"),
    ),
    "stopped": ("stopped", "partial", "partial penetration", "gestoppt", "gehalten", "arrêté", "non perforé"),
    "counts": (
        *("counts", "fair", "fair hit", "valid", "valid hit", "valid shot"),
        *("gültig", "gewertet", "zählt", "valable", "valide", "coup valable"),
    ),
    "panel": ("panel", "panel no", "panneau"),
    "target": ("target", "target no", "Ziel", "cible"),
    "plate": ("plate", "plate no", "Platte", "Platten-Nr.", "plaque"),
    "lab": ("lab", "laboratory", "Labor", "laboratoire"),
    "lot": ("lot", "lot no", "Los"),
    "laboratory": ("laboratory", "lab", "Labor", "laboratoire"),
    "series": ("series", "test series", "Serie", "série"),
    "date": ("date", "Datum"),
    "test": ("test", "test no", "Versuch", "Versuch-Nr.", "essai", *SHOT_NAMES),
    "impact.velocity_m_s": VELOCITIES,
    "outcome": RESULTS,
    "impact.projectile": ("projectile", "Projektil", "Geschoss"),
    "impact.obliquity_deg": ("obliquity", "NATO angle", "Auftreffwinkel NATO"),
    "armour.ceramic": ("ceramic", "Keramik", "céramique"),
    "armour.ceramic_thickness_mm": (
        *("ceramic thickness", "thickness of ceramic", "Dicke Keramik", "Keramikdicke"),
        *("épaisseur céramique", "épaisseur de la céramique"),
    ),
    "armour.backing": ("backing", "back plate", "Rücken", "Rückplatte", "support"),
    "armour.backing_thickness_mm": (
        *("backing thickness", "thickness of backing", "back plate thickness", "Dicke Rücken", "Rückendicke"),
        *("Dicke Stahl", "Dicke Backing", "épaisseur support", "épaisseur du support"),
    ),
    "ballistic_limit_m_s": ("ballistic limit", "V50", "ballistische Grenzgeschwindigkeit", "limite balistique"),
    "ballistic_limit_uncertainty_m_s": ("ballistic limit uncertainty", "V50 uncertainty", "s", "s V50"),
    "residual_velocity_m_s": ("residual velocity", "Restgeschwindigkeit", "vitesse résiduelle"),
    "residual_velocity_uncertainty_m_s": ("residual velocity uncertainty",),
    "residual_mass_g": ("residual mass", "Restmasse", "masse résiduelle"),
    "residual_mass_uncertainty_g": ("residual mass uncertainty",),
}
# Columns of text that tell the targets of shots apart.
GROUPS = ("panel", "target", "plate", "lab", "lot")
# Factors to the units of keys, by the units that people write.
UNITS = {
    "m/s": {"m/s": 1.0, "m s-1": 1.0, "ms-1": 1.0, "mps": 1.0, "ft/s": 0.3048, "fps": 0.3048, "f/s": 0.3048},
    "mm": {"mm": 1.0, "cm": 10.0, "in": 25.4, "inch": 25.4, "inches": 25.4},
    "g": {"g": 1.0, "kg": 1000.0, "grain": 0.06479891, "grains": 0.06479891, "gr": 0.06479891},
    "°": {"°": 1.0, "deg": 1.0, "degrees": 1.0},
}
# Pairs of words for an armour that stopped a shot and for one that was perforated.
OUTCOMES = (
    ("stopped", "perforated"),
    ("partial", "complete"),
    ("p", "c"),
    ("pp", "cp"),
    ("no", "yes"),
    ("stop", "perforate"),
    ("defeated", "perforated"),
    ("not perforated", "perforated"),
    ("no perforation", "perforation"),
    ("partial penetration", "complete penetration"),
    ("partial perforation", "complete perforation"),
    ("incomplete penetration", "complete penetration"),
    ("kein Durchschlag", "Durchschlag"),
    ("nicht durchschlagen", "durchschlagen"),
    ("kein Durchschuss", "Durchschuss"),
    ("nicht perforiert", "perforiert"),
    ("gestoppt", "durchschlagen"),
    ("gehalten", "durchschlagen"),
    ("aufgehalten", "durchschlagen"),
    ("Steckschuss", "Durchschuss"),
    ("KD", "D"),
    ("nein", "ja"),
    ("non perforé", "perforé"),
    ("pas de perforation", "perforation"),
    ("perforation partielle", "perforation complète"),
    ("pénétration partielle", "pénétration complète"),
    ("partielle", "complète"),
    ("partiel", "complet"),
    ("arrêté", "perforé"),
    ("arrêt", "perforation"),
    ("non", "oui"),
)
# Pairs of words for no and yes, which are results only in a column whose header says of what.
YES_OR_NO = (
    *(("no", "yes"), ("n", "y"), ("false", "true"), ("0", "1")),
    *(("nein", "ja"), ("n", "j"), ("falsch", "wahr"), ("non", "oui"), ("n", "o"), ("faux", "vrai")),
)
# What the numbers of a key can be, by key or else by unit: the bounds tell 1,234 from 1.234.
BOUNDS = {
    **dict.fromkeys(("velocity_m_s", "impact.velocity_m_s", "ballistic_limit_m_s"), (10.0, 1e4)),
    "m/s": (0.0, 1e4),
    "mm": (0.0, 1e3),
    "°": (0.0, 60.0),
}
_BRACKETS = re.compile(r"[(\[{]([^)\]}]*)[)\]}]")


class Column(NamedTuple):
    """A column: its key, or its name if it has none, the factor to the key's unit, and the unit as it is written."""

    key: str
    factor: float = 1.0
    unit: str = ""  # "" if the header is the key itself, or has no unit
    known: bool = True
    yes: bool | None = None  # whether yes means that the armour was perforated, where the header says of what


def folded(text: str) -> str:
    """Return the letters and digits of a text, without accents and case, its words divided by underscores."""
    plain = unicodedata.normalize("NFKD", text.casefold())
    return "_".join(re.findall(r"[^\W_]+|[#°]", "".join(c for c in plain if not unicodedata.combining(c))))


_UNIT_NAMES = {folded(unit): unit for units in UNITS.values() for unit in units}
PERFORATED = {folded(word): place == 1 for pair in OUTCOMES for place, word in enumerate(pair)}
_YES = {word: place == 1 for pair in YES_OR_NO for place, word in enumerate(pair)}


@lru_cache
def perforates(word: str) -> bool | None:
    """Return whether a word says that an armour was perforated; None if it says neither."""
    return PERFORATED.get(folded(word))


def is_yes(word: str) -> bool | None:
    """Return whether a word says yes; None if it says neither yes nor no."""
    return _YES.get(word.casefold())


def is_unit(text: str) -> bool:
    """Return whether a text is a unit, perhaps in brackets."""
    return folded(text) in _UNIT_NAMES


@cache
def _keys(columns: tuple[str, ...]) -> dict[str, str]:
    """Return the keys of columns by their folded names without units."""
    keys = {folded(name): key for key in reversed(columns) for name in NAMES.get(key, ())}
    for key in columns:
        unit = words_and_unit(key)[1]
        keys[folded(key).removesuffix(f"_{folded(unit)}" if unit in UNITS else "")] = key
    return keys


def column_of(header: str, columns: Sequence[str]) -> Column:
    """Return the column that a header names: one of some keys, by any usual name and in any unit, or another one.

    The factor is 0 if the unit is missing or is none of the key's.
    """
    if header in columns:
        return Column(header)
    if by_yes := _of_yes(header, columns):
        return by_yes
    keys = _keys(tuple(columns))
    name = _BRACKETS.sub(lambda bracket: bracket[0] if is_unit(bracket[1]) else " ", header)
    for text in map(folded, (header, name)):
        ending = max((unit for unit in _UNIT_NAMES if text.endswith(f"_{unit}")), key=len, default="")
        stem = re.sub("_(in|en)$", "", text.removesuffix(f"_{ending}")) if ending else text
        key = keys.get(stem) or keys.get(text)
        if key is None:
            continue
        units = UNITS.get(words_and_unit(key)[1])
        if units is None:
            return Column(key) if text in keys else Column(header, known=False)
        unit = _UNIT_NAMES.get(ending, "")
        return Column(key, units.get(unit, 0.0), unit)
    return Column(header, known=False)


def _of_yes(header: str, columns: Sequence[str]) -> Column | None:
    """Return the column of a header such as "Result (1 = perforated)", if it is one."""
    meaning = re.search(r"\b([01])\s*[=:]\s*([^\W\d]+(?: [^\W\d]+)*)", header)
    result = None if meaning is None else perforates(meaning[2])
    if meaning is None or result is None or folded(_BRACKETS.sub("", header)) not in map(folded, RESULTS):
        return None
    key = "perforated" if result == (meaning[1] == "1") else "stopped"
    return Column(key) if key in columns else None
