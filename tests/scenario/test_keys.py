from collections.abc import Mapping
from time import perf_counter
from typing import Any

import pytest

from armour.errors import InputError
from armour.scenario.inputs import CERAMIC
from armour.scenario.keys import canonical, changed, changes_of, key_name, line_of, lines_of, parts_of, with_plain_keys
from tests.helpers.cases import data, scenario

TEXT = """# a comment
title = "x [not.a.table]"

[impact]
projectile = "7.62 mm AP"
velocity_m_s = 800.0
[library.ceramic."My alumina"]
flow_stress_GPa = { value = 4.5, status = "fitted" }
[[threat]]
velocity_m_s = 1.0
[[threat]]
name = \"\"\"
[impact]
\"\"\"
velocity_m_s = 2.0
[design]
pareto = [
  "a",   # velocity_m_s = 3
  "b",
]
[[design.ceramic]]
material = "AD85"
[[design.ceramic]]
thickness_mm = { min = 1.0, max = 2.0 }
model.shear_perimeter = "conoid"
"""


@pytest.mark.parametrize(
    ("key", "line"),
    [
        ("title", 2),
        ("impact", 4),
        ("impact.velocity_m_s", 6),
        ("impact.missing", 4),
        ('library.ceramic."My alumina"', 7),
        ('library.ceramic."My alumina".flow_stress_GPa', 8),
        ('library.ceramic."My alumina".flow_stress_GPa.status', 8),
        ("threat[0].velocity_m_s", 10),
        ("threat[1].velocity_m_s", 15),
        ("threat[1].projectile", 11),
        ("design.pareto[1]", 17),
        ("design.ceramic[0].material", 22),
        ("design.ceramic[1].thickness_mm.max", 24),
        ("design.ceramic[1].model.shear_perimeter", 25),
        ("armour.backing", None),
        ("imp", None),
    ],
)
def test_where_a_key_is(key: str, line: int | None):
    assert line_of(key, lines_of(TEXT)) == line


def test_a_long_text_takes_no_time():
    text = "[c]\nd = '''\"\n'''\ne = [\n\"]\",\n]\nf = 1\na = \"\"\"\n" + "[b]  # \\\" '\n" * 50_000
    begun = perf_counter()
    assert lines_of(text) == {"c": 1, "c.d": 2, "c.e": 4, "c.e[0]": 4, "c.f": 7}
    assert perf_counter() - begun < 5.0


def test_what_stands_before_an_error():
    assert lines_of("a = 1\n[b]\nc = = 2\nd = 3\n") == {"a": 1, "b": 2}


@pytest.mark.parametrize(
    ("parts", "name"),
    [
        (["impact", "velocity_m_s"], "impact.velocity_m_s"),
        (["library", "files", 0], "library.files[0]"),
        (["library", "ceramic", "AD85, mine", "flow_stress_GPa"], 'library.ceramic."AD85, mine".flow_stress_GPa'),
        (["a\nb"], '"a\\nb"'),
    ],
)
def test_keys_are_written_as_toml_writes_them(parts: list[str | int], name: str):
    assert key_name(parts) == name


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


def test_a_change_leaves_the_data():
    original = data()
    changed(original, {"armour": {"ceramic": "AD90"}, "library.metal.m.density_kg_m3": {"value": 1.0}})
    assert original == data()


@pytest.mark.parametrize("assignments", [["uncertainty={}"], ["uncertainty.samples=5", "uncertainty={seed=2}"]])
def test_an_assigned_table_replaces_that_of_the_data(assignments: list[str]):
    original = data(uncertainty={"samples": 9, CERAMIC: {"distribution": "uniform", "min": 1.0, "max": 2.0}})
    expected = {"samples": 5, "seed": 2} if len(assignments) > 1 else {}
    assert changed(original, with_plain_keys(changes_of(assignments), "f"))["uncertainty"] == expected
    assert "min" in original["uncertainty"][CERAMIC]


def test_assignments():
    found = changes_of(["a.b=1", 'a."b"= 1', "c=x y", "d = [1, 2]", "'e f'.g=h=i"])
    assert found == {"a.b": 1, "c": "x y", "d": [1, 2], '"e f".g': "h=i"}
    with pytest.raises(InputError, match=r"--set a\.b: must be given once, found 1 and 2"):
        changes_of(["a.b=1", 'a."b"=2'])
    for text in ("a", "=1", "a..b=1"):
        with pytest.raises(InputError, match="must be KEY=VALUE"):
            changes_of([text])


def test_keys_in_one_spelling():
    assert canonical([' a."b"', "c"], "f") == ["a.b", "c"]
    with pytest.raises(InputError, match=r"f: a\.b: must be given once"):
        canonical(["a.b", 'a."b"'], "f")
