from pathlib import Path

import pytest

from armour.reporting.table import in_words
from armour.scenario.inputs import INPUTS


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("ceramic.flow_stress_GPa", "ceramic flow stress, GPa"),
        ("armour.backing_thickness_mm", "back plate thickness, mm"),
        ("model.limit_error_percent", "error of the model, %"),
        ('library.projectile."7.62 mm AP".penetrator_mass_g', "7.62 mm AP penetrator mass, g"),
    ],
)
def test_inputs_and_keys_in_words(name: str, words: str):
    assert in_words(name) == words


def test_the_page_of_names_has_every_input_with_its_words():
    page = Path(__file__).parents[2].joinpath("docs/howto/sensitivity.md").read_text(encoding="utf-8")
    assert [line for line in page.splitlines() if line.startswith("| `")] == [
        f"| `{name}` | {in_words(name)} |" for name in INPUTS
    ]
