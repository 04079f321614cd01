from time import perf_counter

import pytest

from armour.scenario.keys import key_name, line_of, lines_of

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
    text = 'a = """\n' + "[b]  # \\\" '\n" * 50_000 + "\"\"\"\n[c]\nd = '''\"\n'''\ne = [\n\"]\",\n]\nf = 1"
    begun = perf_counter()
    assert lines_of(text) == {"a": 1, "c": 50_003, "c.d": 50_004, "c.e": 50_006, "c.e[0]": 50_006, "c.f": 50_009}
    assert perf_counter() - begun < 5.0


def test_what_stands_before_an_error():
    assert lines_of("a = 1\n[b]\nc = = 2\nd = 3\n") == {"a": 1, "b": 2}


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
