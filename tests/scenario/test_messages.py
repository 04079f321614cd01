import pytest

from armour.scenario.messages import describe, key_name


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
