"""Studies against brute force that goes through every design, one scenario at a time or with no order of its own."""

from typing import Any

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit
from armour.analysis.impact import simulate
from armour.core.state import Outcome
from armour.design.catalogue import StudyResult, asks_for_study, study, undominated
from armour.design.optimisation import optimise
from armour.engine import batch
from armour.errors import InputError, NoDesignError
from armour.reporting.contents import contents_of
from armour.scenario.loading import Scenario, load_scenario
from armour.statistics.uncertainty import uncertainty
from tests.cases import SCENARIOS, scenario

RANGE = {"min": 4.0, "max": 12.0, "step": 1.0}
THREATS = [
    {"projectile": "7.62 mm AP", "velocity_m_s": 800.0},
    {"projectile": "7.62 mm APM2", "velocity_m_s": 780.0, "margin_m_s": 25.0, "name": "M2"},
]
CERAMICS = [
    {"material": "AD85", "thickness_mm": RANGE, "cost_per_kg": 12.0},
    {"material": "AD99.5", "thickness_mm": [4.5, 6.5, 9.0], "cost_per_kg": 30.0, "density_kg_m3": 3900.0},
]
METALS = [
    {"material": "6061-T6", "thickness_mm": RANGE, "cost_per_kg": 7.0, "cost_per_m2": 15.0},
    {"material": "7075-T6", "thickness_mm": [4.0, 6.0, 8.0], "cost_per_kg": 11.0},
]


def asked(threats: Any = THREATS, uncertain: Any = None, **design: Any) -> Scenario:
    sections: dict[str, Any] = {"threat": threats, "design": {"ceramic": CERAMICS, "backing": METALS, **design}}
    return scenario(**sections, **({} if uncertain is None else {"uncertainty": uncertain}))


def every_design(case: Scenario) -> list[Any]:
    """Areal density, thickness, cost and names of all that defeats every threat, by plain runs."""
    found = []
    assert case.design is not None
    for ceramic in case.design.ceramic:
        for backing in case.design.backing:
            for hc in ceramic.thicknesses():
                for hb in backing.thicknesses():
                    names = {"armour.ceramic": ceramic.material, "armour.backing": backing.material}
                    own = case.replaced({**names, "armour.ceramic_thickness_mm": hc, "armour.backing_thickness_mm": hb})
                    if ceramic.density_kg_m3:
                        entry = {"based_on": ceramic.material, "density_kg_m3": ceramic.density_kg_m3}
                        own = own.replaced({"library": {"ceramic": {ceramic.material: entry}}})
                    if all(
                        simulate(
                            own.replaced(
                                {
                                    "impact.projectile": threat.projectile,
                                    "impact.velocity_m_s": threat.velocity_m_s + threat.margin_m_s,
                                }
                            )
                        ).outcome
                        == "defeated"
                        for threat in case.threat
                    ):
                        armour = own.core_armour()
                        masses = armour.rho_c * hc / 1000.0, armour.rho_B * hb / 1000.0
                        cost = ceramic.cost_per_kg * masses[0] + backing.cost_per_kg * masses[1] + backing.cost_per_m2
                        found.append((sum(masses), hc + hb, cost, (ceramic.material, backing.material, hc, hb)))
    return found


ALL = every_design(asked())


def names(result: StudyResult) -> tuple[Any, ...]:
    best = result.best
    return best.ceramic, best.backing, best.ceramic_thickness_mm, best.backing_thickness_mm


@pytest.mark.parametrize(("minimise", "column"), [("areal_density_kg_m2", 0), ("thickness_mm", 1), ("cost_per_m2", 2)])
def test_the_best_is_that_of_brute_force(minimise: str, column: int):
    result = study(asked(minimise=minimise))
    least = min(ALL, key=lambda design: design[column])
    assert getattr(result.best, minimise) == pytest.approx(least[column], rel=1e-12)
    assert names(result) in [design[3] for design in ALL if design[column] == pytest.approx(least[column])]
    by_pair = {pair: min(design[column] for design in ALL if design[3][:2] == pair) for pair in {d[3][:2] for d in ALL}}
    for pair in result.pairs:
        assert pair.best is not None
        assert getattr(pair.best, minimise) == pytest.approx(by_pair[pair.ceramic, pair.backing], rel=1e-12)
        excess = 100.0 * (by_pair[pair.ceramic, pair.backing] / least[column] - 1.0)
        assert pair.excess_percent == pytest.approx(excess, abs=1e-9)


def test_limits_are_kept_and_what_is_added_counts():
    added = {"added_areal_density_kg_m2": 1.5, "added_thickness_mm": 0.5, "added_cost_per_m2": 20.0}
    limits = {"thickness_max_mm": 16.5, "cost_max_per_m2": 1500.0}
    result = study(asked(**added, **limits))
    kept = [d for d in ALL if d[1] + 0.5 <= 16.5 and d[2] + 20.0 <= 1500.0]
    assert result.best.areal_density_kg_m2 == pytest.approx(min(kept)[0] + 1.5)
    assert result.best.thickness_mm <= 16.5
    assert result.best.cost_per_m2 == pytest.approx(min(kept)[2] + 20.0)


@pytest.mark.parametrize(
    "criteria", [["areal_density_kg_m2", "cost_per_m2"], ["areal_density_kg_m2", "thickness_mm", "cost_per_m2"]]
)
def test_the_pareto_front_is_that_of_brute_force(criteria: list[str]):
    columns = [("areal_density_kg_m2", "thickness_mm", "cost_per_m2").index(name) for name in criteria]
    costs = [tuple(round(design[c], 9) for c in columns) for design in ALL]
    front = {
        own
        for own in costs
        if not any(all(o <= m for o, m in zip(other, own, strict=True)) and other != own for other in costs)
    }
    found = study(asked(pareto=criteria)).pareto
    assert sorted(tuple(round(getattr(item, name), 9) for name in criteria) for item in found) == sorted(front)


def test_a_front_with_margins():
    """More margin costs mass: along the front both rise, and every design has the margin it says."""
    found = study(asked(THREATS[:1], pareto=["areal_density_kg_m2", "margin_m_s"])).pareto
    masses, margins = [item.areal_density_kg_m2 for item in found], [item.margin_m_s or 0.0 for item in found]
    assert len(found) > 5
    assert masses == sorted(masses)
    assert margins == sorted(margins)
    assert margins[0] >= 0.0


def test_undominated_rows():
    costs = np.array([[1.0, 5.0], [2.0, 2.0], [2.0, 2.0], [3.0, 3.0], [5.0, 1.0], [1.0, 6.0]])
    assert undominated(costs).tolist() == [0, 1, 4]


def test_margins_and_the_threat_that_governs():
    best = study(asked()).best
    assert best.margins_m_s["M2"] >= 25.0
    left = {"7.62 mm AP at 800 m/s": best.margins_m_s["7.62 mm AP at 800 m/s"], "M2": best.margins_m_s["M2"] - 25.0}
    assert best.governing == min(left, key=lambda title: left[title])


def test_who_governs_along_the_frontier():
    """Each by its own limits: the least of what is left of the margins."""
    result = study(asked())
    for design, governing in zip(result.frontier, result.frontier_governed_by, strict=True):
        left = {}
        for threat in asked().threat:
            own = asked().replaced(
                {
                    "armour.ceramic": result.best.ceramic,
                    "armour.backing": result.best.backing,
                    "armour.ceramic_thickness_mm": design.ceramic_thickness_mm,
                    "armour.backing_thickness_mm": design.backing_thickness_mm,
                    "impact.projectile": threat.projectile,
                }
            )
            limit = ballistic_limit(own).ballistic_limit_m_s
            left[threat.title] = limit - threat.velocity_m_s - threat.margin_m_s
        assert governing == min(left, key=lambda title: left[title])
        assert min(left.values()) >= -0.01


def test_thicknesses_that_are_free_come_to_the_refined_optimum():
    optimum = load_scenario(SCENARIOS / "paper" / "optimum_7.62mm_AP.toml")
    refined = optimise(optimum, refine=True).refined
    assert refined is not None
    free = {"material": "AD85", "thickness_mm": {"min": 2.0, "max": 20.0}}
    metal = {"material": "5083-H3", "thickness_mm": {"min": 2.0, "max": 14.0}}
    best = study(optimum.replaced({"design": {"ceramic": [free], "backing": [metal]}})).best
    assert best.areal_density_kg_m2 == pytest.approx(refined.areal_density_kg_m2, abs=2e-4)
    assert best.backing_thickness_mm == pytest.approx(refined.backing_thickness_mm, abs=0.05)
    one = study(optimum.replaced({"design": {"ceramic": [free], "backing": [{**metal, "thickness_mm": [6.0]}]}})).best
    other = study(
        optimum.replaced(
            {"design": {"ceramic": [{**free, "thickness_mm": [one.ceramic_thickness_mm]}], "backing": [metal]}}
        )
    ).best
    assert other.backing_thickness_mm == pytest.approx(6.0, abs=1e-4)


def test_free_thicknesses_of_which_some_are_not_enough_and_limits():
    """Up to 9 mm of ceramic is too little on thin plates; a limit on the thickness then leaves a heavier optimum."""
    layers = {
        "ceramic": [{"material": "AD85", "thickness_mm": {"min": 2.0, "max": 9.0}}],
        "backing": [{"material": "6061-T6", "thickness_mm": {"min": 1.0, "max": 14.0}}],
    }
    wide = study(asked(THREATS[:1], **layers)).best
    assert wide.ceramic_thickness_mm <= 9.0
    thinnest = study(asked(THREATS[:1], **layers, minimise="thickness_mm")).best
    middle = 0.5 * (thinnest.thickness_mm + wide.thickness_mm)
    assert thinnest.thickness_mm < middle
    narrow = study(asked(THREATS[:1], **layers, thickness_max_mm=middle)).best
    assert narrow.thickness_mm <= middle
    assert wide.areal_density_kg_m2 < narrow.areal_density_kg_m2 < thinnest.areal_density_kg_m2
    coarse = {
        "ceramic": [{"material": "AD85", "thickness_mm": {"min": 2.0, "max": 9.0, "step": 0.05}}],
        "backing": [{"material": "6061-T6", "thickness_mm": {"min": 1.0, "max": 14.0, "step": 0.05}}],
    }
    by_grid = study(asked(THREATS[:1], **coarse)).best.areal_density_kg_m2
    assert by_grid - 0.35 < wide.areal_density_kg_m2 <= by_grid


def test_without_a_catalogue_it_is_the_grid():
    """One threat that is the impact, the scenario's own pair: the optimum and the frontier of the paper's grid."""
    optimum = load_scenario(SCENARIOS / "paper" / "optimum_7.62mm_AP.toml")
    assert not asks_for_study(optimum)
    as_study = optimum.replaced({"threat": [{"projectile": "7.62 mm AP", "velocity_m_s": 850.0}]})
    assert asks_for_study(as_study)
    there, here = optimise(optimum), study(as_study)
    assert here.best.areal_density_kg_m2 == pytest.approx(there.best.areal_density_kg_m2)
    assert [d.ceramic_thickness_mm for d in here.frontier] == [d.ceramic_thickness_mm for d in there.frontier]


UNCERTAIN = {
    "samples": 1024,
    "ceramic": {"flow_stress_GPa": {"distribution": "normal", "standard_deviation_percent": 4.0}},
    "armour": {"backing_thickness_mm": {"distribution": "normal", "standard_deviation": 0.05}},
}


def test_a_bound_on_the_probability_of_perforation():
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": 800.0, "probability_of_perforation": 0.02}
    case = asked([threat], UNCERTAIN)
    best = study(case).best
    [estimate] = best.probabilities.values()
    assert estimate.high <= 0.02
    plain = study(asked([{k: threat[k] for k in ("projectile", "velocity_m_s")}])).best
    assert best.areal_density_kg_m2 > plain.areal_density_kg_m2
    # Every lighter design that defeats the threat as it stands is perforated too often.
    for mass, _, _, (ceramic, backing, hc, hb) in every_design(asked([{**threat, "margin_m_s": 0.0}])):
        if mass < best.areal_density_kg_m2 - 1e-9:
            own = case.replaced(
                {
                    "armour.ceramic": ceramic,
                    "armour.backing": backing,
                    "armour.ceramic_thickness_mm": hc,
                    "armour.backing_thickness_mm": hb,
                    "impact.velocity_m_s": 800.0,
                }
            )
            assert uncertainty(own).probability_of_perforation.high > 0.02


def test_the_probability_is_at_the_threats_own_velocity():
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": 800.0, "probability_of_perforation": 0.02}
    plain, with_margin = (study(asked([{**threat, "margin_m_s": margin}], UNCERTAIN)).best for margin in (0.0, 20.0))
    assert plain.margins_m_s["7.62 mm AP at 800 m/s"] > 20.0
    assert plain == with_margin


@pytest.mark.parametrize(
    "uncertain",
    [
        {"impact": {"velocity_m_s": {"distribution": "uniform", "min": 100.0, "max": 110.0}}},
        {"armour": {"ceramic_thickness_mm": {"distribution": "normal", "mean": 12.0, "standard_deviation": 0.1}}},
        {"ceramic": {"flow_stress_GPa": {"distribution": "normal", "mean": 9.0, "standard_deviation": 0.1}}},
    ],
)
def test_distributions_must_follow_the_designs(uncertain: Any):
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": 800.0, "probability_of_perforation": 0.05}
    with pytest.raises(InputError, match="must be about the value of each design or threat"):
        study(asked([threat], uncertain))


def test_samples_that_are_not_allowed():
    threat = {"projectile": "7.62 mm AP", "velocity_m_s": 500.0, "probability_of_perforation": 0.4}
    wide = {"armour": {"ceramic_thickness_mm": {"distribution": "normal", "standard_deviation": 10.0}}}
    with pytest.raises(InputError, match="must not reach values that are not allowed"):
        study(asked([threat], wide))


def test_margins_do_not_depend_on_the_range_of_the_search():
    wide = study(asked())
    for search in ({"velocity_max_m_s": 500.0}, {"velocity_min_m_s": 1500.0}):
        narrow = study(asked().replaced({"ballistic_limit": search}))
        assert narrow.best.margins_m_s == pytest.approx(wide.best.margins_m_s, abs=0.02)
        assert narrow.best.governing == wide.best.governing


def test_a_material_twice_with_two_densities():
    """The dossier is of the design that won."""
    ceramics = [
        {"material": "AD85", "thickness_mm": [9.0]},
        {"material": "AD85", "thickness_mm": [11.0], "density_kg_m3": 5000.0},
    ]
    case = asked(ceramic=ceramics)
    found = contents_of(case)
    assert found.impact.areal_density_kg_m2 == pytest.approx(study(case).best.areal_density_kg_m2)


def test_equal_sums_are_equal_on_the_front():
    steps = {"min": 4.0, "max": 12.0, "step": 0.1}
    layers = {
        "ceramic": [{"material": "AD99.5", "thickness_mm": steps}],
        "backing": [{"material": "7075-T6", "thickness_mm": {"min": 2.0, "max": 8.0, "step": 0.3}}],
    }
    front = study(asked(THREATS[:1], **layers, pareto=["thickness_mm", "areal_density_kg_m2"])).pareto
    thicknesses = [round(item.thickness_mm, 6) for item in front]
    assert len(set(thicknesses)) == len(thicknesses)


def test_what_costs_nothing():
    free = [
        {"material": "AD85", "thickness_mm": [12.0]},
        {"material": "AD99.5", "thickness_mm": [12.0], "cost_per_kg": 9.0},
    ]
    metal = [{"material": "6061-T6", "thickness_mm": [10.0]}]
    result = study(asked(ceramic=free, backing=metal, minimise="cost_per_m2"))
    assert [(pair.ceramic, pair.reason) for pair in result.pairs] == [("AD85", ""), ("AD99.5", "dearer")]


def test_a_big_catalogue_is_exact():
    """6 ceramics, 6 metals, 40 by 40 thicknesses and 3 threats against all 57,600 at once."""
    thick = {"min": 2.0, "max": 21.5, "step": 0.5}
    library = {
        "ceramic": {
            f"C{i}": {"based_on": "AD85", "density_kg_m3": 3300.0 + 97.0 * i, "flow_stress_GPa": 4.5 + 0.3 * i}
            for i in range(6)
        },
        "metal": {
            f"M{i}": {"based_on": "6061-T6", "density_kg_m3": 2650.0 + 61.0 * i, "flow_stress_GPa": 0.8 + 0.1 * i}
            for i in range(6)
        },
    }
    threats = [*THREATS, {"projectile": "7.62 mm AP", "velocity_m_s": 700.0, "margin_m_s": 130.0, "name": "slow"}]
    case = scenario(
        threat=threats,
        library=library,
        design={
            "ceramic": [{"material": name, "thickness_mm": thick} for name in library["ceramic"]],
            "backing": [{"material": name, "thickness_mm": thick} for name in library["metal"]],
        },
    )
    result = study(case)
    assert result.designs == 57_600
    hc, hb = (values.ravel() for values in np.meshgrid(*[2.0 + 0.5 * np.arange(40)] * 2))
    least = np.inf
    for ceramic in library["ceramic"]:
        for metal in library["metal"]:
            good = np.ones(1600, dtype=bool)
            for threat in case.threat:
                changes = {"armour.ceramic": ceramic, "armour.backing": metal, "impact.projectile": threat.projectile}
                a = case.replaced(changes).core_armour()
                rows = batch.packed([a._replace(Hc0=c / 1000.0, Hb=b / 1000.0) for c, b in zip(hc, hb, strict=True)])
                velocity = threat.velocity_m_s + threat.margin_m_s
                good &= batch.impacts(rows, np.full(1600, velocity)).outcome == Outcome.DEFEATED
            least = min(least, float(np.where(good, a.rho_c * hc + a.rho_B * hb, np.inf).min()) / 1000.0)
    assert result.best.areal_density_kg_m2 == pytest.approx(least, rel=1e-12)


def test_nothing_on_offer():
    with pytest.raises(NoDesignError, match="nothing on offer keeps to the limits"):
        study(asked(thickness_max_mm=5.0))
    fast = [{"projectile": "7.62 mm AP", "velocity_m_s": 2500.0}]
    with pytest.raises(NoDesignError, match=r"nothing on offer defeats 7.62 mm AP at 2500 m/s"):
        study(asked(fast))


def test_a_pair_that_cannot():
    metals = [{"material": "6061-T6", "thickness_mm": [10.0]}, {"material": "7075-T6", "thickness_mm": [0.5]}]
    result = study(asked(backing=metals))
    assert [pair.reason for pair in result.pairs if pair.best is None] == [
        "nothing on offer defeats 7.62 mm AP at 800 m/s or M2"
    ] * 2


@pytest.mark.parametrize(
    ("case", "message"),
    [
        (lambda: scenario(design={}), "optimise: is missing and must be given"),
        (lambda: asked([{**THREATS[0], "margin_m_s": 9500.0}]), "must be at most 10000 together, found 800 and 9500"),
        (lambda: asked([{**THREATS[0], "name": "a\x1b[31m"}]), "must be one line of printable text"),
        (lambda: asked(added_cost_per_m2=1e308), "design.added_cost_per_m2: must be at most 1e+09"),
        (lambda: asked(pareto=["thickness_mm"]), "must have at least 2 of them"),
        (
            lambda: asked([THREATS[1], THREATS[1]]),
            'threat[1].name: must tell the threat from the others, found "M2" twice',
        ),
        (
            lambda: asked([{**THREATS[0], "probability_of_perforation": 0.05}]),
            "uncertainty: is missing and must be given",
        ),
        (
            lambda: asked(
                [{**THREATS[0], "probability_of_perforation": 0.05}],
                UNCERTAIN,
                ceramic=[{"material": "AD85", "thickness_mm": {"min": 4.0, "max": 12.0}}],
            ),
            "must have a step for each thickness_mm",
        ),
        (
            lambda: asked([{**THREATS[0], "probability_of_perforation": 0.001}], UNCERTAIN),
            "uncertainty.samples: must be more to show a probability of perforation of 0.001, found 1024",
        ),
        (lambda: asked(ceramic=[{"material": "AD86", "thickness_mm": [5.0]}]), "did you mean 'AD85'?"),
        (lambda: asked(backing=[{"material": "6061-T6", "thickness_mm": 5.0}]), "thickness_mm: must be a table"),
        (lambda: asked(backing=[{"material": "6061-T6", "thickness_mm": []}]), "thickness_mm: must not be empty"),
    ],
)
def test_wrong_questions(case: Any, message: str):
    with pytest.raises(InputError) as error:
        study(case())
    assert message in str(error.value)
