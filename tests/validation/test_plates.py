"""Measured limits of bare plates: the REL ballistic-limit data base, Ryan et al., Defence Technology 2023."""

import csv
import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import pytest

from armour.evidence.fit import shipped_data
from armour.scenario.library import shipped_library
from armour.validation.suite import Suite, load_suite
from armour.validation.validate import Check, SuiteResult, result_of, validate
from tests.helpers.cases import SCENARIOS
from tools.published import EVIDENCE, plates_page

pytestmark = pytest.mark.slow

FOLDER = SCENARIOS / "tests"
# Names of the data base's rounds in the library.
ROUNDS = {
    ".30 APM2": "7.62 mm APM2",
    ".50 APM2": "12.7 mm APM2",
    "14.5 mm BS41": "14.5 mm BS41",
    "14.5 mm B32": "14.5 mm B32",
    "20 mm M602": "20 mm M602",
    "30 mm APDS": "30 mm APDS",
    ".50 FSP": "12.7 mm FSP",
    "20 mm FSP": "20 mm FSP",
}


@cache
def rows() -> tuple[dict[str, str], ...]:
    with (FOLDER / "plates.csv").open() as file:
        return tuple(csv.DictReader(file))


@cache
def suite() -> Suite:
    return load_suite("plates")


@pytest.fixture(scope="module")
def result() -> SuiteResult:
    return validate(suite())


def errors(
    result: SuiteResult, metal: str, rounds: Sequence[str], least: float, most: float, *, oblique: bool
) -> list[float]:
    """Relative errors, %, of the tests of some rounds on a metal, with thickness over diameter in a closed range."""
    found = []
    for check in result.checks:
        cells = check.case.cells
        ratio = float(cells["armour.backing_thickness_mm"]) / float(cells["projectile.penetrator_diameter_mm"])
        angled = float(cells["impact.obliquity_deg"]) > 0.0
        if cells["metal"] == metal and cells["round"] in rounds and least <= ratio <= most and angled == oblique:
            assert check.computed is not None
            found.append(100.0 * (float(check.computed) / float(cells["ballistic_limit_m_s"]) - 1.0))
    return found


def test_the_data_are_whole():
    assert len(rows()) == 1084
    assert sum(row["impact.obliquity_deg"] == "0" for row in rows()) == 760
    assert sum(bool(row["question"]) for row in rows()) == 42
    assert sum(float(row["ballistic_limit_m_s"]) for row in rows()) == 807506.0
    for row in rows():
        ratio = float(row["armour.backing_thickness_mm"]) / float(row["projectile.penetrator_diameter_mm"])
        assert float(row["thickness_over_diameter"]) == pytest.approx(ratio, abs=5e-5)


@pytest.mark.parametrize(
    ("metal", "rounds", "least", "most", "number", "mean", "rms", "magnitude"),
    [
        ("aluminium", (".30 APM2", ".30 APM2 core", ".50 APM2", "14.5 mm BS41"), 0, 99, 528, 3.8, 8.5, 6.9),
        ("aluminium", (".30 APM2", ".30 APM2 core", ".50 APM2", "14.5 mm BS41"), 3, 7, 451, 2.9, 7.3, 6.0),
        ("aluminium", ("20 mm FSP",), 0, 99, 93, 8.3, 22.7, 18.1),
        ("steel", ("30 mm APDS",), 0, 99, 12, -26.1, 27.8, 26.1),
        ("aluminium at an angle", (".30 APM2", ".30 APM2 core"), 0, 99, 42, -8.1, 9.9, 8.4),
        ("steel at an angle", (".30 APM2", ".50 APM2", "14.5 mm B32", "14.5 mm BS41"), 0, 99, 278, 0.2, 7.5, 5.6),
    ],
)
def test_the_errors_that_the_documentation_states(
    result: SuiteResult,
    metal: str,
    rounds: Sequence[str],
    least: float,
    most: float,
    number: int,
    mean: float,
    rms: float,
    magnitude: float,
):
    metal, _, angle = metal.partition(" at ")
    found = errors(result, metal, rounds, least, most, oblique=bool(angle))
    of_found = math.fsum(found), math.fsum(map(abs, found)), math.sqrt(math.fsum(e * e for e in found) / len(found))
    stated = [len(found), round(of_found[0] / number, 1), round(of_found[2], 1), round(of_found[1] / number, 1)]
    assert stated == [number, mean, rms, magnitude]


def test_every_group_is_within_its_bands(result: SuiteResult):
    assert [summary.full_name for summary in result.summaries if summary.status == "outside"] == []
    assert sum(summary.status == "within" for summary in result.summaries) == 43
    # After a change that moves a number: make docs.
    assert (EVIDENCE / "plates.md").read_text() == plates_page(result)


@pytest.mark.parametrize("factor", [0.985, 1.015])
def test_a_change_of_the_limits_leaves_a_band(result: SuiteResult, factor: float):
    def changed(check: Check) -> Check:
        return replace(check, computed=factor * float(check.computed or 0.0))

    other = result_of(suite(), [changed(check) for check in result.checks])
    assert [s.full_name for s in other.summaries if s.status == "outside"][:1] == ["armour-piercing cores on aluminium"]


def test_the_library_has_the_plates_and_rounds():
    library = shipped_library().entries
    keys = {
        "density_kg_m3": ("backing.density_kg_m3", 1.0),
        "static_yield_strength_MPa": ("backing.dynamic_yield_strength_MPa", 1.0),
        "ultimate_tensile_strength_MPa": ("ultimate_tensile_strength_MPa", 1.0),
        "strain_to_fracture": ("elongation_percent", 0.01),
    }
    for row in rows():
        metal = library["metal"][row["plate"]]
        for key, (column, factor) in keys.items():
            assert metal[key] == pytest.approx(factor * float(row[column]), rel=1e-3), (row["plate"], key)
        assert metal.derived == {"dynamic_yield_strength_MPa", "flow_stress_GPa", "shear_strength_MPa"}
        if row["round"] in ROUNDS:
            core = library["projectile"][ROUNDS[row["round"]]]
            for key in ("penetrator_diameter_mm", "penetrator_mass_g", "density_kg_m3"):
                assert core[key] == pytest.approx(float(row[f"projectile.{key}"]), rel=3e-4), (row["round"], key)
            assert core["flow_stress_GPa"] == 2.35


def test_the_errors_that_answers_state(result: SuiteResult):
    """Those of `Note`s about armours whose limits these tests contradict, see configs/evidence.toml."""
    words = {name: data["words"] for name, data in shipped_data()["caveat"].items()}
    fragments = [e for metal in ("aluminium", "steel") for e in of(result, metal, ".50 FSP", "20 mm FSP")]
    dense, cores = of(result, "steel", "30 mm APDS"), sorted(of(result, "steel", ".30 APM2", ".50 APM2"))
    mean = math.fsum(map(abs, fragments)) / len(fragments)
    assert f"{mean:.0f} % on average, up to {max(map(abs, fragments)):.0f} %" in words["fragments"]
    low, least = -math.fsum(dense) / len(dense), -min(dense)
    assert f"{low:.0f} % too low on average, up to {least:.0f} %" in words["sub_calibre"]
    *sound, doubtful = cores
    assert doubtful > 90.0
    high = math.fsum(sound) / len(sound)
    assert f"{high:.0f} % too high on average, up to {max(sound):.0f} %" in words["normal_steel"]
    page = (SCENARIOS.parent / "docs" / "evidence" / "own-tests.md").read_text()
    [row] = [line.split(" | ") for line in page.splitlines() if line.startswith("| cores on steel | 0 | all |")]
    assert f"off by {row[8].rstrip(' |')} points on average" in words["lots_of_steel"]


def of(result: SuiteResult, metal: str, *rounds: str) -> list[float]:
    return errors(result, metal, rounds, 0.0, 99.0, oblique=False)
