"""Names of columns in configs/columns.toml, as headings of tables."""

import pytest

from armour.columns import UNITS, USUAL_NAMES, column_of
from armour.units import words_and_unit


@pytest.mark.parametrize("key", USUAL_NAMES)
def test_every_name_in_every_unit_is_read_as_its_key(key: str):
    for name in USUAL_NAMES[key]:
        for unit, factor in UNITS.get(words_and_unit(key)[1], {"": 1.0}).items():
            for heading in (f"{name} [{unit}]", f"{name.upper()} {unit}", f"{name.replace(' ', '_')}_{unit}"):
                column = column_of(heading, (key,))
                assert (column.key, column.factor, column.known) == (key, factor, True), heading
