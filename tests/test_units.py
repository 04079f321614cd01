import pytest

from armour.units import ENDINGS, key_hint, words_and_unit


@pytest.mark.parametrize(
    ("key", "words", "unit"),
    [
        ("armour.ceramic_thickness_mm", "ceramic thickness", "mm"),
        ("areal_density_kg_m2", "areal density", "kg/m²"),
        ("duration_us", "duration", "µs"),
        ("outcome", "outcome", ""),
    ],
)
def test_words_and_unit(key: str, words: str, unit: str):
    assert words_and_unit(key) == (words, unit)


@pytest.mark.parametrize("ending", ENDINGS)
def test_every_ending_is_recognised(ending: str):
    assert words_and_unit(f"x{ending}") == ("x", ENDINGS[ending])


def test_a_hint_at_the_section_and_the_unit_of_a_key():
    keys = ["impact.velocity_m_s", "armour.ceramic_thickness_mm", "optimise.ceramic_thickness_mm", "title"]
    assert (
        key_hint("impact.velocity", keys) == key_hint("velocity", keys) == "; its unit is missing: impact.velocity_m_s"
    )
    assert key_hint("velocity_ft_s", keys) == "; its unit must be m/s: impact.velocity_m_s"
    assert key_hint("ceramic_thickness_mm", keys) == '; did you mean "armour.ceramic_thickness_mm"?'
    assert key_hint("velocities", keys) == key_hint("titles", keys) == ""
