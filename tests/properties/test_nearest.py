"""Answers where no test is: random catalogues of untested ceramics against a plain loop over every design."""

from itertools import product
from math import inf
from random import Random
from typing import Any, NamedTuple

import pytest

from armour.analysis.variants import ballistic_limits, variants_of
from armour.design.optimise import BestDesign, optimise
from armour.scenario.scenario import Scenario
from tests.helpers.cases import scenario

pytestmark = pytest.mark.slow

ROUNDS = {"7.62 mm AP": (650, 950), "7.62 mm APM2": (650, 950), "7.62 mm B32": (650, 950), "14.5 mm B32": (600, 1000)}
CERAMICS, METALS = ("AD99.5", "Al-N", "SiC", "B4C"), ("6061-T6", "7075-T6", "5083-H3")


class Plain(NamedTuple):
    """A design of the loop."""

    names: tuple[str, str, float, float]
    areal_density: float
    short: dict[str, float]
    allowed: bool  # not of a ceramic with a single source
    over: float  # beyond the cap


def case(seed: int) -> Scenario:
    """A catalogue of untested ceramics with three threats and a cap, now and then with a confidence."""
    dice = Random(seed)
    threats = [
        {"name": name, "projectile": of, "velocity_m_s": float(dice.randint(*ROUNDS[of])), "margin_m_s": margin}
        for name, of, margin in zip(
            "abc", dice.choices([*ROUNDS], k=3), (0.0, dice.choice((0.0, 20.0)), 0.0), strict=True
        )
    ]
    design: dict[str, Any] = {
        "areal_density_max_kg_m2": dice.choice((35.0, 50.0, 70.0, 120.0)),
        "ceramic": [
            {"material": name, "thickness_mm": sorted(dice.sample(range(4, 15), 3))}
            for name in dice.sample(CERAMICS, 2)
        ],
        "backing": [
            {"material": name, "thickness_mm": sorted(dice.sample(range(4, 13), 2))} for name in dice.sample(METALS, 1)
        ],
    }
    if dice.random() < 0.7:
        design["probability_of_stopping"] = 0.9
    return scenario(threat=threats, design=design)


def against(case: Scenario, names: tuple[str, str, float, float], threat: Any) -> Scenario:
    ceramic, backing, hc, hb = names
    values = {"ceramic": ceramic, "backing": backing, "ceramic_thickness_mm": hc, "backing_thickness_mm": hb}
    impact = {"projectile": threat.projectile, "velocity_m_s": threat.velocity_m_s}
    return case.replaced({"design": None, "threat": [], "armour": values, "impact": impact})


def limit_of(of: Scenario) -> float:
    """The ballistic limit, m/s: inf where nothing in the range perforates, 0 where all does."""
    [limit] = ballistic_limits(variants_of(of, {}, 1))
    return max(float(limit), 0.0)


def designs(case: Scenario) -> list[Plain]:
    section, found = case.design, []
    assert section is not None
    for ceramic, backing in product(section.ceramic, section.backing):
        for hc, hb in product(ceramic.thicknesses(), backing.thicknesses()):
            names = (ceramic.material, backing.material, hc, hb)
            of = {threat.title: against(case, names, threat) for threat in case.threat}
            density = next(iter(of.values())).areal_density_kg_m2()
            short = {t.title: t.required_m_s - limit_of(of[t.title]) for t in case.threat}
            over = density - (section.areal_density_max_kg_m2 or inf)
            found.append(Plain(names, density, short, ceramic.material != "B4C", over))
    return found


def names_of(design: BestDesign) -> tuple[str, str, float, float]:
    return design.ceramic, design.backing, design.ceramic_thickness_mm, design.backing_thickness_mm


# A design that reaches, with a confidence and without; none, but for the cap or in any case.
@pytest.mark.parametrize("seed", [10, 4, 8, 1])
def test_the_answer_is_that_of_a_plain_loop(seed: int):
    of = case(seed)
    every, result = designs(of), optimise(of)
    within = [each for each in every if each.over <= 0.0]
    reaching = [each for each in within if max(each.short.values()) <= 0.0 and each.allowed]
    unsourced = [each for each in within if max(each.short.values()) <= 0.0 and not each.allowed]
    asked = of.design is not None and of.design.probability_of_stopping is not None
    shown = result.shown
    if reaching:
        assert result.reason == ("not known" if asked else "")
        expected = min(reaching, key=lambda each: each.areal_density)
    elif unsourced:
        assert result.reason == "not known"
        expected = min(unsourced, key=lambda each: each.areal_density)
    else:
        assert result.reason == "none passes"
        nearest = [each for each in every if each.allowed]
        least = max(min(each.over for each in nearest), 0.0)
        expected = min((each for each in nearest if each.over <= least), key=lambda each: max(each.short.values()))
    assert names_of(shown) == expected.names
    assert (result.best is None) == bool(result.reason)
    assert shown.short_m_s == pytest.approx({title: max(s, 0.0) for title, s in expected.short.items()}, abs=0.02)
