"""Small catalogues of any kind against a search through all of them."""

from typing import Any

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from armour.analysis.impact import simulate
from armour.design.catalogue import study
from armour.errors import NoDesignError
from armour.scenario.loading import Scenario
from armour.scenario.parameters import with_inputs
from tests.cases import scenario

THICKNESSES = st.lists(st.floats(3.0, 14.0).map(lambda t: round(t, 1)), min_size=1, max_size=4)
COSTS = st.floats(0.0, 50.0)
CERAMICS = st.sampled_from(["AD85", "AD99.5", "Al-N"])
OBJECTIVES = st.sampled_from(["areal_density_kg_m2", "thickness_mm", "cost_per_m2"])
METALS = st.sampled_from(["6061-T6", "7075-T6", "5083-H3"])
THREATS = st.lists(
    st.fixed_dictionaries(
        {
            "projectile": st.sampled_from(["7.62 mm AP", "7.62 mm APM2"]),
            "velocity_m_s": st.floats(500.0, 950.0),
            "margin_m_s": st.floats(0.0, 50.0),
        }
    ),
    min_size=1,
    max_size=3,
    unique_by=lambda threat: f"{threat['projectile']} {threat['velocity_m_s']:g}",
)


def layers(names: st.SearchStrategy[str]) -> st.SearchStrategy[list[dict[str, Any]]]:
    return st.lists(
        st.fixed_dictionaries(
            {"material": names, "thickness_mm": THICKNESSES, "cost_per_kg": COSTS, "cost_per_m2": COSTS},
            optional={"density_kg_m3": st.floats(2500.0, 4000.0)},
        ),
        min_size=1,
        max_size=2,
    )


def stands(case: Scenario, ceramic: Any, backing: Any, hc: float, hb: float) -> bool:
    """Whether a design defeats every threat, by plain runs."""
    for threat in case.threat:
        own = case.replaced(
            {
                "armour.ceramic": ceramic.material,
                "armour.backing": backing.material,
                "armour.ceramic_thickness_mm": hc,
                "armour.backing_thickness_mm": hb,
                "impact.projectile": threat.projectile,
                "impact.velocity_m_s": threat.velocity_m_s + threat.margin_m_s,
            }
        )
        densities = {"ceramic.density_kg_m3": ceramic.density_kg_m3, "backing.density_kg_m3": backing.density_kg_m3}
        own = with_inputs(own, {name: value for name, value in densities.items() if value is not None})
        if simulate(own).outcome == "perforated":
            return False
    return True


@given(
    layers(CERAMICS), layers(METALS), THREATS, st.sampled_from(["areal_density_kg_m2", "thickness_mm", "cost_per_m2"])
)
@settings(max_examples=25, deadline=None)
def test_the_best_of_any_catalogue(ceramics: Any, metals: Any, threats: Any, minimise: str):
    case = scenario(threat=threats, design={"ceramic": ceramics, "backing": metals, "minimise": minimise})
    assert case.design is not None
    found = []
    for ceramic in case.design.ceramic:
        for backing in case.design.backing:
            rho_c = ceramic.density_kg_m3 or case.entry("ceramic", ceramic.material)["density_kg_m3"]
            rho_b = backing.density_kg_m3 or case.entry("metal", backing.material)["density_kg_m3"]
            for hc in ceramic.thicknesses():
                for hb in backing.thicknesses():
                    if stands(case, ceramic, backing, hc, hb):
                        masses = rho_c * hc / 1000.0, rho_b * hb / 1000.0
                        cost = ceramic.cost_per_kg * masses[0] + backing.cost_per_kg * masses[1]
                        cost += ceramic.cost_per_m2 + backing.cost_per_m2
                        values = {"areal_density_kg_m2": sum(masses), "thickness_mm": hc + hb, "cost_per_m2": cost}
                        found.append(values[minimise])
    if not found:
        try:
            study(case)
        except NoDesignError:
            return
        raise AssertionError("a design where there is none")
    least = min(found)
    assume(least > 0.0)
    assert abs(getattr(study(case).best, minimise) - least) <= 1e-9 * least
