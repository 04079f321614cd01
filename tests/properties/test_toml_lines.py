"""Every key of any TOML file is found on a line that holds its name."""

import tomllib
from collections.abc import Iterator
from typing import Any

import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st

from armour.scenario.keys import key_name, line_of, lines_of

NAMES = st.text(st.characters(codec="ascii", exclude_characters="\n\r\x00"), min_size=1, max_size=6)
SCALARS = st.integers(-9, 9) | st.booleans() | st.text(max_size=8) | st.floats(allow_nan=False, allow_infinity=False)
VALUES = st.recursive(SCALARS, lambda v: st.lists(v, max_size=3) | st.dictionaries(NAMES, v, max_size=3), max_leaves=12)


def leaves(value: Any, parts: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Yield the keys of the scalars of a document outside lists."""
    if isinstance(value, dict):
        for name, child in value.items():
            yield from leaves(child, (*parts, name))
    elif not isinstance(value, list):
        yield parts


@given(st.dictionaries(NAMES, VALUES, max_size=4))
@settings(max_examples=30, deadline=None)
def test_every_key_is_found_on_its_line(data: dict[str, Any]):
    text = tomli_w.dumps(data)
    found, written = lines_of(text), text.split("\n")
    for parts in leaves(tomllib.loads(text)):
        assert key_name(parts) in found
        line = line_of(key_name(parts), found)
        assert line is not None
        last = tomli_w.dumps({str(parts[-1]): 0}).removesuffix(" = 0\n")
        assert last in written[line - 1]
