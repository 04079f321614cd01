"""Words of quantities, inputs and keys, which tables, reports and plots for people show in place of the names."""

from armour.analysis.quantities import label_and_unit
from armour.reporting.text import spelt
from armour.scenario.inputs import ROLES
from armour.scenario.keys import parts_of


def words_of(name: str) -> tuple[str, str]:
    """Return label and unit of a quantity, an input or a key of a scenario."""
    words, unit = label_and_unit(name)
    words = spelt(words)
    *sections, _ = parts_of(name)
    if len(sections) > 1:
        # A value of the library has the name of its entry.
        words = f"{sections[-1]} {words}"
    elif {*sections} & {"impact", *ROLES} and not words.startswith(("penetrator", "projectile")):
        words = f"{spelt(sections[0])} {words}"
    return words, unit


def in_words(name: str) -> str:
    """Return label and unit of a quantity, an input or a key, such as "ceramic flow stress, GPa"."""
    words, unit = words_of(name)
    return f"{words}, {unit}" if unit else words
