import pickle

import pytest

from armour.errors import InputError, NoLimitError, Note, Problem, choices, listed, suggestion


def test_a_problem_reads_file_key_message():
    assert str(Problem("a.toml", "impact.x", "must be y")) == "a.toml: impact.x: must be y"
    assert str(Problem("a.toml", "", "cannot be read")) == "a.toml: cannot be read"


def test_a_note_is_a_text_with_the_key_that_it_is_about():
    note = Note("is high", "impact.velocity_m_s")
    assert [str(note), str(Note("is odd"))] == ["impact.velocity_m_s: is high", "is odd"]
    assert pickle.loads(pickle.dumps(note)) == note


def test_no_answer_is_not_wrong_input():
    assert not issubclass(NoLimitError, InputError)


def test_a_suggestion_is_the_closest_name():
    assert suggestion("AD85x", ["AD85", "Al-N"]) == '; did you mean "AD85"?'
    assert suggestion("ad85", ["AD85"]) == '; did you mean "AD85"?'
    assert suggestion("nothing", ["uncertain", "dwell"]) == ""
    assert suggestion("", ["uncertain"]) == ""
    levels = ["STANAG 4569 level 3, B32", "STANAG 4569 level 4, B32"]
    assert suggestion("stanag level 3", levels) == f'; did you mean "{levels[0]}"?'


@pytest.mark.parametrize(
    ("word", "other"),
    [
        ("penetrator_length_mm", "penetrator_diameter_mm"),
        ("core_mass_g", "projectile_mass_g"),
        ("flow_stress_backing_slope", "flow_stress_GPa"),
        ("ceramic.shear_strength_MPa", "backing.shear_strength_MPa"),
        ("AD90", "AD99.5"),
        ("7.62x51", "7.62x54R B32"),
        ("STANAG 4569 level 5", "STANAG 4569 level 4, B32"),
    ],
)
def test_another_quantity_or_another_number_is_no_misspelling(word: str, other: str):
    assert suggestion(word, [other]) == ""


@pytest.mark.parametrize(
    ("word", "meant"),
    [
        ("penetrator_diametre_mm", "penetrator_diameter_mm"),
        ("densty_kg_m3", "density_kg_m3"),
        ("cermic.flow_stres_GPa", "ceramic.flow_stress_GPa"),
        ("backingthickness_mm", "backing_thickness_mm"),
        ("thickness_mm", "ceramic_thickness_mm"),
        ("7075-T6 plate", "7075-T6"),
    ],
)
def test_a_misspelling_is_recognised(word: str, meant: str):
    assert suggestion(word, [meant]) == f'; did you mean "{meant}"?'


def test_a_list_of_choices_stands_once():
    known = ["AD85", "Al-N"]
    error = InputError([Problem("a", name, f"unknown{choices(name, known)}") for name in ("x", "AD85x", "y")])
    assert str(error).splitlines() == [
        "a: x: unknown; choose from AD85, Al-N",
        'a: AD85x: unknown; did you mean "AD85"?',
        "a: y: unknown",
    ]
    assert choices("x", ["AD85", "level 3, B32"]) == "; choose from AD85; level 3, B32"


def test_no_suggestion_among_very_many_names():
    """Ten thousand wrong names are not compared with as many others."""
    assert suggestion("AD85x", ["AD85", *map(str, range(1000))]) == ""


def test_a_sentence_lists_seven_names():
    names = [f"c{i}" for i in range(1000)]
    assert listed(names[:7]) == "c0, c1, c2, c3, c4, c5, c6"
    assert listed(names) == "c0, c1, c2, c3, c4, c5, c6 and 993 more"
