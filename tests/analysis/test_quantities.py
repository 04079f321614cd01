import pytest

from armour.analysis.impact import simulate
from armour.analysis.quantities import QUANTITIES, Answers, answerable
from armour.design.optimisation import optimise
from armour.errors import InputError, NoDesignError
from tests.analysis.test_least_thickness import case
from tests.cases import scenario
from tests.design.test_optimisation import GRID

IMPACT = [
    "outcome",
    "residual_velocity_m_s",
    "residual_mass_g",
    "residual_length_mm",
    "penetration_depth_mm",
    "bulge_height_mm",
    "plug_velocity_m_s",
    "duration_us",
    "areal_density_kg_m2",
]


@pytest.mark.parametrize("name", IMPACT)
def test_quantities_of_an_impact_are_those_of_its_result(name: str):
    assert QUANTITIES[name].of(Answers(scenario())) == getattr(simulate(scenario()), name)


def test_what_is_lost():
    result = simulate(scenario())
    answers = Answers(scenario())
    velocity = QUANTITIES["velocity_lost_percent"].of(answers)
    mass = QUANTITIES["mass_lost_percent"].of(answers)
    assert velocity == pytest.approx(100.0 * (1.0 - result.residual_velocity_m_s / 800.0))
    assert mass == pytest.approx(100.0 * (1.0 - result.residual_mass_g / 5.46))


def test_the_optimum():
    best = optimise(case(GRID)).best
    answers = Answers(case(GRID))
    for layer, expected in (
        ("ceramic_thickness_mm", best.ceramic_thickness_mm),
        ("backing_thickness_mm", best.backing_thickness_mm),
        ("areal_density_kg_m2", best.areal_density_kg_m2),
    ):
        assert QUANTITIES[f"optimum_{layer}"].of(answers) == expected


def test_what_is_required():
    answers = Answers(case())
    ceramic = QUANTITIES["required_ceramic_thickness_mm"].of(answers)
    assert QUANTITIES["required_areal_density_kg_m2"].of(answers) == pytest.approx(3.43 * float(ceramic) + 2.75 * 6.35)
    both = float(QUANTITIES["required_total_thickness_mm"].of(answers))
    backing = QUANTITIES["required_backing_thickness_mm"].of(answers)
    assert float(ceramic) > both / 2 > 6.35 < float(backing)


@pytest.mark.parametrize(
    ("changes", "fixed"), [({"ceramic": "AD99.5"}, "backing"), ({"backing": "7075-T6"}, "ceramic")]
)
def test_what_a_replacement_saves(changes: dict[str, str], fixed: str):
    before = case()
    after = before.replaced({"armour": changes})
    answers = Answers(before, after)
    name = "required_backing_thickness_mm" if fixed == "ceramic" else "required_ceramic_thickness_mm"
    t1, t2 = (float(QUANTITIES[name].of(Answers(s))) for s in (before, after))
    saved = float(QUANTITIES["thickness_saved_percent"].of(answers))
    assert saved == pytest.approx(100.0 * (t1 - t2) / (6.35 + t1))
    weights = [answers.replaced[i].areal_density_kg_m2 for i in (0, 1)]
    assert QUANTITIES["weight_saved_percent"].of(answers) == pytest.approx(100.0 * (1.0 - weights[1] / weights[0]))


def test_no_design_is_enough():
    with pytest.raises(NoDesignError):
        QUANTITIES["required_ceramic_thickness_mm"].of(Answers(case(velocity=4000.0)))


def test_what_a_quantity_needs():
    answerable("ballistic_limit_m_s", scenario())
    with pytest.raises(InputError, match="optimise: is missing"):
        answerable("optimum_areal_density_kg_m2", scenario())
    other = {"armour": {"ceramic": "AD99.5", "backing": "7075-T6"}}
    for replacement in (None, case(), case().replaced(other)):
        with pytest.raises(InputError, match="another ceramic or another backing"):
            answerable("weight_saved_percent", case(), replacement)
    answerable("weight_saved_percent", case(), case().replaced({"armour.ceramic": "AD99.5"}))


def test_everything_on_the_grid_says_so():
    for name, quantity in QUANTITIES.items():
        needs = name.startswith(("required_", "optimum_")) or quantity.of_two
        assert quantity.on_grid == needs, name
        assert name.endswith(("_percent", "outcome")) or quantity.unit, name
