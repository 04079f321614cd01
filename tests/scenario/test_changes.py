from collections.abc import Mapping
from typing import Any

import pytest

from armour.errors import InputError
from armour.scenario.changes import changed, changes_of
from armour.scenario.keys import canonical, parts_of
from tests.helpers.cases import data, scenario


def refused(changes: Mapping[str, object], **sections: Any) -> list[str]:
    with pytest.raises(InputError) as error:
        changed(data(**sections), changes, "a.toml")
    return [str(problem) for problem in error.value.problems]


@pytest.mark.parametrize(
    ("key", "parts"),
    [
        ("armour.ceramic", ("armour", "ceramic")),
        (' armour . "ceramic" ', ("armour", "ceramic")),
        ('library.projectile."7.62 mm AP".density_kg_m3', ("library", "projectile", "7.62 mm AP", "density_kg_m3")),
        ("'a=b]#'.c", ("a=b]#", "c")),
    ],
)
def test_a_key_is_read_as_toml_reads_it(key: str, parts: tuple[str, ...]):
    assert parts_of(key) == parts


@pytest.mark.parametrize(
    "key", ["", ".", "a.", "a..b", "a b", "a = 1 #", "a] #", "a\nb", "a]\n[b", "a = 1\nb", "ä", ".".join("a" * 21)]
)
def test_what_is_no_key(key: str):
    with pytest.raises(ValueError):  # noqa: PT011
        parts_of(key)
    [message] = refused({key: 1.0})
    assert message.startswith("a.toml: must be a key of the scenario as TOML writes it")


@pytest.mark.parametrize(
    ("key", "message"),
    [
        (
            "armour.ceramic.density_kg_m3",
            'must not go below armour.ceramic, which is the text "AD85"; did you mean "ceramic.density_kg_m3"?',
        ),
        (
            "impact.velocity_m_s.mean",
            'must not go below impact.velocity_m_s, which is 800.0; did you mean "impact.velocity_m_s"?',
        ),
        (
            "threat.margin_m_s",
            "must not go below threat, which is a list; a list is given whole, such as threat=[{...}]",
        ),
    ],
)
def test_a_key_below_a_value(key: str, message: str):
    assert refused({key: 1.0}, threat=[]) == [f"a.toml: {key}: {message}"]
    with pytest.raises(InputError, match="must not go below"):
        scenario(threat=[]).replaced({key: 1.0})


def test_a_key_that_is_given_twice():
    assert refused({"impact.velocity_m_s": 1.0, 'impact."velocity_m_s"': 2.0, "impact": {"velocity_m_s": 3.0}}) == [
        "a.toml: impact.velocity_m_s: must be given once, found 1.0 and 2.0",
        "a.toml: impact.velocity_m_s: must be given once, found 2.0 and 3.0",
    ]
    assert changed(data(), {"impact.velocity_m_s": 1, "impact": {"velocity_m_s": 1}})["impact"]["velocity_m_s"] == 1


def test_a_change_leaves_the_data():
    original = data()
    changed(original, {"armour": {"ceramic": "AD90"}, "library.metal.m.density_kg_m3": {"value": 1.0}})
    assert original == data()


def test_assignments():
    assert changes_of(["a.b=1", 'a."b"= 1', "c=x y", "d = [1, 2]", "'e=f'.g=h=i"]) == {
        "a.b": 1,
        "c": "x y",
        "d": [1, 2],
        '"e=f".g': "h=i",
    }
    with pytest.raises(InputError, match=r"--set a\.b: must be given once, found 1 and 2"):
        changes_of(["a.b=1", 'a."b"=2'])
    for text in ("a", "=1", "a..b=1", "a=1\nb=2"):
        with pytest.raises(InputError, match="must be KEY=VALUE"):
            changes_of([text])


def test_keys_in_one_spelling():
    assert canonical([' a."b"', "c"], "f") == ["a.b", "c"]
    with pytest.raises(InputError, match=r"f: a\.b: must be given once"):
        canonical(["a.b", 'a."b"'], "f")
