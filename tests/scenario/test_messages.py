from collections.abc import Callable, Mapping
from types import NoneType
from typing import Any

import pytest

from armour.errors import InputError
from armour.scenario.keys import describe, key_name
from armour.scenario.messages import PATH, check_sequence, check_types


@pytest.mark.parametrize(
    ("parts", "name"),
    [
        (["impact", "velocity_m_s"], "impact.velocity_m_s"),
        (["library", "files", 0], "library.files[0]"),
        (
            ["library", "ceramic", "AD85, mine", "flow_stress_GPa"],
            'library.ceramic."AD85, mine".flow_stress_GPa',
        ),
        (["a\nb"], '"a\\nb"'),
    ],
)
def test_keys_are_written_as_toml_writes_them(parts: list[str | int], name: str):
    assert key_name(parts) == name


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (True, "true"),
        ({}, "a table"),
        ([1], "a list"),
        ("x", 'the text "x"'),
        (-3, "-3"),
        (float("nan"), "nan"),
    ],
)
def test_what_was_found(value: object, words: str):
    assert describe(value) == words


def test_a_long_text_is_cut():
    assert len(describe("x" * 1000)) < 60
    assert describe(10**5000) == "a whole number of more than 64 bits"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (5, "f: names: must be a name or a sequence of names, found 5"),
        ({}, "f: names: must be a name or a sequence of names, found a dict"),
        (["a", 5], "f: names: must be a sequence of names, found 5 in it"),
        (["a", "a"], 'f: names: must not name anything twice, found the text "a" twice'),
    ],
)
def test_a_wrong_sequence_of_names(given: object, message: str):
    with pytest.raises(InputError) as error:
        check_sequence("f", "names", given)
    assert str(error.value) == message


def test_a_text_is_one_name():
    assert check_sequence("f", "names", "abc") == ("abc",)
    assert check_sequence("f", "names", (x for x in "ab")) == ("a", "b")


@pytest.mark.parametrize(
    ("value", "kind", "message"),
    [
        (True, int, "f: x: must be a whole number, found true"),
        ([1], (int, NoneType), "f: x: must be a whole number or None, found a list"),
        (3, (Mapping, *PATH), "f: x: must be a mapping or a text or a path, found 3"),
        (None, Callable, "f: x: must be a function, found None"),
    ],
)
def test_a_wrong_argument(value: object, kind: Any, message: str):
    with pytest.raises(InputError) as error:
        check_types("f", x=(value, kind))
    assert str(error.value) == message
