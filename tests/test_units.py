import pytest

from armour.units import ENDINGS, missing_unit, words_and_unit


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


def test_a_missing_unit():
    assert missing_unit("velocity", ["velocity_m_s"]) == "; its unit is missing: velocity_m_s"
    assert missing_unit("velocity", ["velocities_m_s"]) == ""
