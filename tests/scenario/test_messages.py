"""Messages for mistakes in a scenario."""

import re
import tomllib

import pytest

from armour.errors import InputError
from armour.scenario.keys import changed
from armour.scenario.scenario import parse_scenario
from tests.helpers.cases import data

NORMAL = {"distribution": "normal", "standard_deviation_percent": 10.0}
AXIS = {"min": 2.0, "max": 9.0, "step": 0.5}
# The Wilkins case with a grid and distributions.
WHOLE = data(
    optimise={"ceramic_thickness_mm": AXIS, "backing_thickness_mm": AXIS},
    uncertainty={
        "ceramic": {"density_kg_m3": NORMAL, "flow_stress_GPa": NORMAL},
        "armour": {"backing_thickness_mm": NORMAL},
    },
)
# Additions to it, each followed by the beginning of its message, which four spaces precede.
TABLE = r"""
impact.velocity_m_s = -3
    impact.velocity_m_s: must be at least 10, found -3
impact.velocity_m_s = inf
    impact.velocity_m_s: must be a finite number, found inf
impact.velocity_m_s = "800"
    impact.velocity_m_s: must be a number, found the text "800"
impact.velocity_m_s = true
    impact.velocity_m_s: must be a number, found true
impact.velocity_m_s = 1e6
    impact.velocity_m_s: must be at most 10000, found 1000000.0
ballistic_limit.velocity_min_m_s = 5e-324
    ballistic_limit.velocity_min_m_s: must be at least 1e-09, found 4.94066e-324
impact.velocity_m_s = 12345678901234567890
    impact.velocity_m_s: must be at most 10000, found a whole number of more than 64 bits
impact.projectile = 7
    impact.projectile: must be a text in quotes, found 7
armour.ceramic_thickness_mm = -1.0
    armour.ceramic_thickness_mm: must be at least 0, found -1.0
armour.thickness_mm = 1.0
    armour.thickness_mm: unknown key; did you mean "ceramic_thickness_mm"?
armour.layer = [{ name = "glue", place = "under", thickness_mm = 1.0, areal_density_kg_m2 = 1.2 }]
    armour.layer[0].place: must be "front", "between" or "behind", found the text "under"
armour.layer = [{ name = "glue", place = "front", thickness_mm = 1.0 }]
    armour.layer[0].areal_density_kg_m2: is missing
design = { scatter_percent = 1.5, scatter_source = "ours" }
    design.scatter_percent: must be at least 2.5, or be given in an entry of the library with an own firing of 36 shots
design.scatter_percent = 4.0
    design: must have scatter_percent and scatter_source, or neither
model.shear_perimeter = "cone"
    model.shear_perimeter: must be "conoid" or "projectile", found the text "cone"; did you mean "conoid"?
value = 1
    value: unknown key; choose from title, author, project, date, impact, armour, model, solver, ballistic_limit,
title = "a\u001b[31m"
    title: must be one line of printable text, found "a\u001b[31m"
impact = 3
    impact: must be a table, found 3
impact.projectile = "7.62 mm"
    impact.projectile: must name a projectile of the library, found "7.62 mm"; choose from 7.62 mm AP, 7.62 mm
armour.ceramic = "AD85x"
    armour.ceramic: must name a ceramic of the library, found "AD85x"; did you mean "AD85"?
armour.ceramic = "carbide"
    armour.ceramic: must name a ceramic of the library, found "carbide"; choose from SiC, B4C
armour.ceramic = "stone"
    armour.ceramic: must name a ceramic of the library, found "stone"; armour library lists them
impact.threat = "STANAG 4569 level 3"
    impact: threat must name a threat of the library, found "STANAG 4569 level 3"; did you mean "STANAG 4569 level 3,
impact.obliquity_deg = 61.0
    impact.obliquity_deg: must be at most 60, found 61.0
threat = [{ threat = "STANAG 4569 level 3, B32" }, { threat = "STANAG 4569 level 3, B32" }]
    threat[1].name: must be different for each threat, found "STANAG 4569 level 3, B32" twice
ballistic_limit.velocity_max_m_s = 20
    ballistic_limit.velocity_max_m_s: must be above velocity_min_m_s, which is 20, found 20
ballistic_limit.velocity_min_m_s = 5000
    ballistic_limit.velocity_max_m_s: must be above velocity_min_m_s, which is 5000, found 4000
optimise.ceramic_thickness_mm = { min = 3, max = 2, step = 0.1 }
    optimise.ceramic_thickness_mm.max: must be at least min, which is 3, found 2
optimise.ceramic_thickness_mm = { min = 2, max = 3, step = 1e-9 }
    optimise.ceramic_thickness_mm: must contain at most 100,000 values, found 1e+09; widen the step
optimise.ceramic_thickness_mm = { min = -2, max = 3, step = 1 }
    optimise.ceramic_thickness_mm.min: must be at least 0, found -2
optimise.backing_thickness_mm = { min = 0, max = 3, step = 1 }
    optimise.backing_thickness_mm: min must be greater than 0, found 0
design.pareto = ["thickness_mm", "thickness_mm"]
    design.pareto: must not name a criterion twice, found thickness_mm, thickness_mm
design.pareto = ["thickness_mm", "thickness_mm", "thickness_mm", "thickness_mm"]
    design.pareto: must list at most 3 values, found 4
uncertainty.model = { mean_percent = 5 }
    uncertainty.model: must have scale_percent
uncertainty.model = { included = false, source = "a" }
    uncertainty.model: must have nothing else if included is false, found source
uncertainty.samples = 200.5
    uncertainty.samples: must be a whole number, found 200.5
uncertainty.samples = 1000
    uncertainty.samples: must be a power of 2 for Sobol' points, such as 1024, found 1000
uncertainty.impact.velocity_m_s = { distribution = "normal", standard_deviation = 1, standard_deviation_percent = 1 }
    uncertainty.impact.velocity_m_s: must have standard_deviation or standard_deviation_percent, and not both
uncertainty.impact.velocity_m_s = { distribution = "uniform", min = 1.0, max = 2.0, mean = 1.5 }
    uncertainty.impact.velocity_m_s: a uniform distribution must have min and max, and nothing else
uncertainty.impact.velocity_m_s = { distribution = "normal", standard_deviation = 1.0, min = 3.0, max = 2.0 }
    uncertainty.impact.velocity_m_s.max: must be above min, which is 3, found 2
uncertainty.impact.velocity_m_s = { distribution = "lognormal", standard_deviation = 1.0, max = 0.0 }
    uncertainty.impact.velocity_m_s: a lognormal distribution must have a max greater than 0, found 0
uncertainty.correlation = [{ between = ["a"], coefficient = 0 }]
    uncertainty.correlation[0].between: must list at least 2 values, found 1
uncertainty.correlation = [{ between = ["ceramic.density_kg_m3", "hardness"], coefficient = 0.5 }]
    uncertainty: correlation must be between inputs that have a distribution, found "hardness"
uncertainty.correlation = [{ between = ["ceramic.density_kg_m3", "ceramic.density_kg_m3"], coefficient = 0.5 }]
    uncertainty: correlation must name two different inputs, once for each pair, found ceramic.density_kg_m3
uncertainty.correlation = [
  { between = ["ceramic.density_kg_m3", "ceramic.flow_stress_GPa"], coefficient = 0.5 },
  { between = ["ceramic.flow_stress_GPa", "ceramic.density_kg_m3"], coefficient = 0.5 },
]
    uncertainty: correlation must name two different inputs, once for each pair, found ceramic.density_kg_m3,
uncertainty.correlation = [
  { between = ["ceramic.density_kg_m3", "ceramic.flow_stress_GPa"], coefficient = 0.9 },
  { between = ["ceramic.density_kg_m3", "armour.backing_thickness_mm"], coefficient = 0.9 },
  { between = ["ceramic.flow_stress_GPa", "armour.backing_thickness_mm"], coefficient = -0.9 },
]
    uncertainty: correlation coefficients must go together: their matrix is not positive definite
library = []
    library: must be a table, found a list
library.files = "a.toml"
    library.files: must be a list, found the text "a.toml"
library.ceramic.a = { based_on = "AD85", flow_stress_product_exponent = 3.1 }
    library.ceramic.a.flow_stress_product_exponent: must be at most 3, found 3.1
library.metal.m = { based_on = "6061-T6", flow_stress_backing_slope = -0.5 }
    library.metal.m.flow_stress_backing_slope: unknown key; choose from description, based_on
library.metal.m.density_kg_m3 = { value = 1e4, tests = [{ a = [] }] }
    library.metal.m.density_kg_m3.tests[0].a: must be a number, found a list
library.ceramic."<b>" = { based_on = "AD85", density_kg_m3 = { value = 1 } }
    library.ceramic."<b>".density_kg_m3: must be at least 100, found 1
library.ceramic.value = { based_on = "AD85", density_kg_m3 = { value = 1 } }
    library.ceramic.value.density_kg_m3: must be at least 100, found 1
library.ceramic."<list>x" = { based_on = "AD85", density_kg_m3 = { value = 1 } }
    library.ceramic."<list>x".density_kg_m3: must be at least 100, found 1
library.ceramic = { a = { density_kg_m3 = 3000, youngs_modulus_GPa = 300 }, b = { based_on = "a" } }
    library.ceramic.a.flow_stress_GPa: is missing and must be given, or based_on an entry that has it
library.projectile.p = { based_on = "7.62 mm AP", penetrator_mass_g = 5460 }
    library.projectile.p.penetrator_mass_g: must make a rod 0.1 to 100 diameters long with the diameter and density
library.ceramic.a = { based_on = "AD85", aliases = ["AD99.5"] }
    library.ceramic.a.aliases: must be names of this entry alone, found "AD99.5", a name of "AD99.5" too
library.ceramic = { a = { based_on = "AD85", aliases = ["x"] }, b = { based_on = "AD85", aliases = ["x"] } }
    library.ceramic.b.aliases: must be names of this entry alone, found "x", a name of "a" too
"""
MESSAGES = re.findall(r"((?:^(?! {4}).+\n)+)^ {4}(.+)$", TABLE, re.MULTILINE)


@pytest.mark.parametrize(("addition", "message"), MESSAGES, ids=[message for _, message in MESSAGES])
def test_a_mistake_has_one_message(addition: str, message: str):
    with pytest.raises(InputError) as error:
        parse_scenario(changed(WHOLE, tomllib.loads(addition)))
    [problem] = error.value.problems
    assert f"{problem.key}: {problem.message}".startswith(message)
