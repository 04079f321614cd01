"""Questions that compare designs; those of one row are tested with the quantities."""

import pytest

from armour.analysis.evaluate import evaluate
from armour.design.optimise import optimise
from armour.errors import NoAnswerError
from armour.scenario.scenario import Scenario
from armour.validation.questions import QUESTIONS, Subject, answer
from tests.helpers.cases import scenario
from tests.helpers.results import best_of

GRID = {
    "ceramic_thickness_mm": {"min": 0.0, "max": 60.0, "step": 1.0},
    "backing_thickness_mm": {"min": 1.0, "max": 60.0, "step": 1.0},
}
THIN = {layer: {"min": 0.5, "max": 2.0, "step": 0.5} for layer in GRID}


@pytest.fixture(scope="module")
def wilkins() -> Scenario:
    """The Wilkins case with a grid of designs."""
    return scenario(optimise=GRID)


def test_the_lightest_design(wilkins: Scenario):
    best, subject = best_of(optimise(wilkins)), Subject(wilkins)
    assert answer("optimum_ceramic_thickness_mm", subject) == best.ceramic_thickness_mm
    assert answer("optimum_backing_thickness_mm", subject) == best.backing_thickness_mm
    assert answer("optimum_areal_density_kg_m2", subject) == best.areal_density_kg_m2


@pytest.mark.parametrize(("layer", "material"), [("ceramic", "AD99.5"), ("backing", "7075-T6")])
def test_what_a_replacement_saves(wilkins: Scenario, layer: str, material: str):
    after = wilkins.replaced({f"armour.{layer}": material})
    subject = Subject(wilkins, after)
    name = f"required_{layer}_thickness_mm"
    thick, thin = (float(evaluate(s, {}, [name])[name][0]) for s in (wilkins, after))
    assert answer("thickness_saved_percent", subject) == pytest.approx(100.0 * (thick - thin) / (6.35 + thick))
    key = f"armour.{layer}_thickness_mm"
    heavy = wilkins.replaced({key: thick}).areal_density_kg_m2()
    light = after.replaced({key: thin}).areal_density_kg_m2()
    assert answer("weight_saved_percent", subject) == pytest.approx(100.0 * (1.0 - light / heavy))


@pytest.mark.parametrize("name", [name for name, reads in QUESTIONS.items() if "optimise" in reads])
def test_no_design_is_enough(name: str):
    fast = scenario(ceramic_mm=1.0, backing_mm=1.0, optimise=THIN)
    with pytest.raises(NoAnswerError, match="no design"):
        answer(name, Subject(fast, fast.replaced({"armour.backing": "7075-T6"})))
