"""What the model cannot do, said in the answers."""

from collections.abc import Callable
from typing import Any
from xml.etree.ElementTree import tostring

import pytest
from scipy.optimize import brentq

import armour
from armour.core import equations
from armour.core.state import Parameters
from armour.evidence.caveats import long_rod
from armour.reporting.by_result import in_a_line
from armour.reporting.scenario_report import scenario_report
from armour.reporting.views.analysis import tables_of_impact, tables_of_limit
from armour.reporting.views.design import check_junit, tables_of_check, tables_of_design
from armour.reporting.words import said_of
from armour.scenario.library import shipped_library
from armour.scenario.scenario import Scenario
from tests.helpers.cases import scenario
from tests.helpers.known import known

NO_METAL = (
    "a back plate of 980 kg/m³ may be no metal: laminates and rubber fail by delamination and tension, which is not "
    "modelled (below 1,740, the density does not tell a laminate from a magnesium-lithium alloy)"
)

ROD = {"penetrator_diameter_mm": 10.0, "penetrator_mass_g": 138.2, "density_kg_m3": 17600.0, "flow_stress_GPa": 1.9}


def on(density: float, **sections: object) -> Scenario:
    """The Wilkins case on another material, strong enough to stop the round by the model."""
    library = {"metal": {"X": {"density_kg_m3": density, "static_yield_strength_MPa": 900.0}}}
    return scenario("7.62 mm AP", "AD85", "X", 8.0, 15.0, library=library, **sections)


def said(result: armour.CheckResult | armour.DesignResult | armour.ImpactResult) -> list[str]:
    return [note.text for note in result.notes if note.said not in ("", "far", "detail")]


def texts_of(result: armour.CheckResult | armour.DesignResult) -> list[str]:
    """The lines of an answer that are no tables; the first is the verdict, or the design found."""
    tables = tables_of_check(result) if isinstance(result, armour.CheckResult) else tables_of_design(result)
    return [text for text in tables if isinstance(text, str)]


def test_no_answer_passes_an_armour_on_what_is_no_metal():
    laminate = on(980.0, design={"probability_of_stopping": 0.6})
    checked, impact = armour.check(laminate), armour.simulate(laminate)
    assert impact.outcome == "stopped"
    assert checked.verdict == "not known"
    assert in_a_line(checked) == f"not known: {NO_METAL}"
    assert tables_of_impact(impact)[0] == f"not known: {NO_METAL}"
    assert tables_of_limit(armour.ballistic_limit(laminate))[0] == f"not known: {NO_METAL}"
    assert f'message="not known: {NO_METAL}"' in _xml(checked, laminate)
    report = scenario_report(laminate, "")
    assert (report.passed, NO_METAL in report.lead) == (False, True)
    assert armour.confidence(laminate).flow_stress is None
    given = {"scale_percent": 1.0, "degrees_of_freedom": 1e6, "source": "tests"}
    assert armour.check(laminate.replaced({"uncertainty.model": given})).verdict == "not known"


def _xml(checked: armour.CheckResult, of: Scenario) -> str:
    return tostring(check_junit(checked, of, 0.0, {}), encoding="unicode")


def test_a_model_error_that_is_given_does_not_make_it_pass():
    given = on(
        980.0,
        design={"probability_of_stopping": 0.6},
        uncertainty={"model": {"scale_percent": 1.0, "degrees_of_freedom": 1e6, "source": "tests"}},
    )
    assert armour.check(given).verdict == "not known"


def test_a_search_judges_the_metals_alone():
    grid = {"min": 6.0, "max": 12.0, "step": 1.0}
    ceramics = [{"material": "AD85", "thickness_mm": grid}]
    backings = [{"material": name, "thickness_mm": grid} for name in ("X", "6061-T6")]
    found = armour.optimise(on(980.0, design={"ceramic": ceramics, "backing": backings}))
    assert found.best is not None
    assert {pair.backing: pair.best is None for pair in found.pairs} == {"6061-T6": False, "X": True}
    assert in_a_line(known(found.pairs[1].nearest).check) == f"not known: {NO_METAL}"
    slow = {"projectile": "7.62 mm AP", "velocity_m_s": 1500.0}
    none = armour.optimise(on(980.0, threat=[slow], design={"ceramic": ceramics, "backing": backings}))
    assert (none.reason, none.shown.backing) == ("not known", "X")
    alone = armour.optimise(on(980.0, design={"ceramic": ceramics, "backing": backings[:1]}))
    assert (alone.reason, in_a_line(alone.shown.check)) == ("not known", f"not known: {NO_METAL}")
    thin = {"ceramic": ceramics, "backing": backings[:1], "thickness_max_mm": 5.0}
    assert armour.optimise(on(980.0, design=thin)).reason == "none passes"


@pytest.mark.parametrize(
    ("density", "question"), [(1350.0, None), (1739.9, None), (1740.0, True), (2099.9, True), (2100.0, False)]
)
def test_up_to_2100_the_answer_asks_whether_it_is_a_metal(density: float, question: bool | None):
    checked = armour.check(on(density))
    assert (checked.verdict == "not known") is (question is None)
    text = " ".join(texts_of(checked))
    assert text.count("a metal?") == bool(question)
    assert f"{int(density):,} kg/m³" in text or question is False


def test_a_search_asks_it_of_pairs_that_it_does_not_name_first():
    grid = {"min": 6.0, "max": 12.0, "step": 1.0}
    layers = {
        "ceramic": [{"material": "AD85", "thickness_mm": grid}],
        "backing": [{"material": name, "thickness_mm": grid} for name in ("X", "6061-T6")],
    }
    found = armour.optimise(on(1840.0, design={**layers, "probability_of_stopping": 0.6}))
    assert known(found.best).backing == "6061-T6"
    assert [words for words in texts_of(found) if words.startswith("is a back plate of 1,840 kg/m³ a metal?")]
    assert not said_of(found.notes)


def test_long_rods_are_named_with_the_depth_that_the_equations_give():
    """Without strengths, V (V - U) = 0.446 U^2 gives U / (V - U) = 2.99 lengths; the hydrodynamic depth is 1.50."""
    rods = {"rod": ROD, "core": ROD | {"penetrator_mass_g": 80.0}}
    rod, core = (
        scenario(name, None, "RHA Class 1", 0.0, 60.0, library={"projectile": rods}, velocity=1500.0) for name in rods
    )
    [words] = said(armour.simulate(rod))
    assert "3.0 times its length into this plate, 2.0 times the hydrodynamic depth" in words
    assert words in texts_of(armour.check(rod))
    assert [text for text in said(armour.simulate(core)) if text.startswith("a long rod")] == []


@pytest.mark.parametrize(
    ("ceramic", "plate", "density", "verdict"),
    [
        (None, "RHA Class 1", 17600.0, "not known"),
        (None, "RHA Class 1", 2700.0, "perforated by the model"),
        ("AD85", "RHA Class 1", 17600.0, "perforated by the model"),
        (None, "5083-H3", 17600.0, "perforated by the model"),
    ],
)
def test_nothing_fails_by_a_limit_that_is_known_to_be_too_low(
    ceramic: str | None, plate: str, density: float, verdict: str
):
    rods = {"rod": ROD | {"density_kg_m3": density, "penetrator_mass_g": 138.2 * density / 17600.0}}
    hc = 5.0 if ceramic else 0.0
    rod = scenario("rod", ceramic, plate, hc, 10.0, library={"projectile": rods}, velocity=1500.0)
    is_too_low, checked, impact = verdict == "not known", armour.check(rod), armour.simulate(rod)
    assert impact.outcome == "perforated"
    assert checked.verdict == verdict
    required = armour.check(rod.replaced({"design": {"probability_of_stopping": 0.9}}))
    assert required.verdict == ("not known" if is_too_low else "fails")
    assert texts_of(checked)[-1].endswith("the limit is too low") is is_too_low
    assert in_a_line(impact).startswith("not known: a long rod") is is_too_low
    layers: dict[str, Any] = {"backing": [{"material": plate, "thickness_mm": [8.0, 10.0]}]}
    layers |= {"ceramic": [{"material": ceramic, "thickness_mm": hc}]} if ceramic else {}
    found = armour.optimise(rod.replaced({"design": layers}))
    assert found.reason == ("not known" if is_too_low else "none passes")
    assert texts_of(found)[0].startswith("lightest by the model: " if is_too_low else "nearest: ")
    stopped = rod.replaced({"impact.velocity_m_s": 50.0})
    assert armour.check(stopped).verdict == "stopped by the model"


@pytest.mark.parametrize(("velocity", "of_fluxes", "of_halves"), [(1000.0, 1.57, 0.75), (1500.0, 2.44, 1.18)])
def test_a_long_rod_penetrates_steel_as_the_page_says(velocity: float, of_fluxes: float, of_halves: float):
    rod = scenario("rod", None, "RHA Class 1", 0.0, 1000.0, library={"projectile": {"rod": ROD}}, velocity=velocity)
    p = rod.core_armour()
    assert armour.simulate(rod).penetration_depth_mm / 1000.0 / p.L0 == pytest.approx(of_fluxes, abs=0.005)
    for flux, expected in (
        (lambda speed, other: speed * other, of_fluxes),
        (lambda _, other: other**2 / 2.0, of_halves),
    ):
        assert integrated_depth(p, velocity, flux) / p.L0 == pytest.approx(expected, abs=0.01)


def integrated_depth(p: Parameters, velocity: float, flux: Callable[[float, float], float]) -> float:
    """The depth in a thick plate by short steps, given the flux of a density of 1 at a speed, and at the speed of loss.

    The target's flux is that of its own speed of penetration.
    """

    def excess(U: float) -> float:
        return p.Yp + p.rho_p * flux(V, V - U) - p.YB - p.rho_B * flux(U, U)

    V, L, depth, step = velocity, p.L0, 0.0, 5e-8
    while L > 0.0 and V > 1.0 and p.Yp + p.rho_p * flux(V, V) > p.YB:
        U = V if excess(V) > 0.0 else brentq(excess, 0.0, V)
        pressure = p.Yp if U < V else p.YB + p.rho_B * flux(V, V)
        V, L, depth = V - step * pressure / (p.rho_p * L), L - step * (V - U), depth + step * U
    return depth


def test_answers_name_doubtful_values_and_own_values_are_not_doubted():
    library = {"metal": {"Mine": {"based_on": "MARS500", "static_yield_strength_MPa": 1200.0}}}
    marked, own = (scenario("7.62 mm APM2", None, name, 0.0, 9.0, library=library) for name in ("MARS500", "Mine"))
    [words, *others] = said(armour.check(marked))
    assert words.startswith("the values of MARS500 are doubtful: ")
    assert said(armour.check(own)) == others


def test_a_tile_thinner_than_any_tested_is_far_from_the_tests_in_every_answer():
    """Against 12.7 mm APM2 of 10.9 mm, tests begin at 0.89 diameters, 9.7 mm."""
    thin = scenario("12.7 mm APM2", "SiC", "6061-T6", 3.0, 40.0, velocity=500.0)
    impact, limit, checked = armour.simulate(thin), armour.ballistic_limit(thin), armour.check(thin)
    far = "far from the tests: SiC (no test), 3 mm tile (tested 9.7 to 13.2 mm, scaled to this round), 40 mm plate "
    for texts in (texts_of(checked), tables_of_impact(impact), tables_of_limit(limit)):
        assert [text for text in texts if isinstance(text, str) and text.startswith(far)]
    assert any(isinstance(fact, str) and fact.startswith(far) for fact in scenario_report(thin, "").facts)


def test_the_depth_of_a_long_rod_is_by_the_equation_as_it_is():
    original = equations.penetration_velocity
    assert "drive a fast one 3.0 times its length" in long_rod(10.0, 7850.0, 17600.0)
    with armour.equations(penetration_velocity=lambda *args: 0.5 * original(*args)):
        assert "drive a fast one 0.6 times its length" in long_rod(10.0, 7850.0, 17600.0)


SHORT = "against fragment simulators, "
DENSE = "against tungsten-alloy cores, "
STEEL, LOTS = "on bare steel at normal incidence, ", "on bare steel, a probability is off by 28 points "


@pytest.mark.parametrize(
    ("projectile", "ceramic", "metal", "obliquity", "expected"),
    [
        ("20 mm FSP", "AD85", "6061-T6", 0.0, [SHORT]),
        ("20 mm FSP", None, "6061-T6", 30.0, [SHORT]),
        ("12.7 mm FSP", None, "RHA Class 1", 0.0, [SHORT]),
        ("30 mm APDS", None, "RHA Class 1", 0.0, [DENSE]),
        ("30 mm APDS", "AD85", "6061-T6", 0.0, [DENSE]),
        ("7.62 mm APM2", None, "RHA Class 1", 0.0, [STEEL, LOTS]),
        ("7.62 mm APM2", None, "RHA Class 1", 30.0, [LOTS]),
        ("14.5 mm BS41", None, "RHA Class 1", 0.0, [STEEL, LOTS]),
        ("7.62 mm APM2", "AD85", "RHA Class 1", 0.0, []),
        ("7.62 mm APM2", None, "6061-T6", 0.0, []),
        ("7.62 mm AP", "AD85", "6061-T6", 0.0, []),
        ("25 mm APDS", "AD85", "6061-T6", 0.0, []),
    ],
)
def test_answers_say_where_tests_contradict_the_model(
    projectile: str, ceramic: str | None, metal: str, obliquity: float, expected: list[str]
):
    """By what the projectile is, under any name."""
    entry = shipped_library().entry("projectile", projectile)
    names = "penetrator_diameter_mm", "penetrator_mass_g", "density_kg_m3", "flow_stress_GPa"
    library = {"projectile": {"X": {name: entry[name] for name in names}}}
    hc = 1.3 * entry["penetrator_diameter_mm"] * bool(ceramic)
    case = scenario("X", ceramic, metal, hc, 10.0, library=library, velocity=300.0)
    case = case.replaced({"impact.obliquity_deg": obliquity})
    checked = armour.check(case)
    texts = said(checked)
    assert [words for text in texts for words in (SHORT, DENSE, STEEL, LOTS) if text.startswith(words)] == expected
    assert [text in texts_of(checked) for text in texts] == [True] * len(texts)
    assert said(armour.simulate(case)) == texts
    assert {*texts} <= {item for item in tables_of_limit(armour.ballistic_limit(case)) if isinstance(item, str)}
    [output] = check_junit(checked, case, 0.0, {}).iter("system-out")
    assert (output.text or "").splitlines()[1:] == texts
