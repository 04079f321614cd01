import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from armour.analysis.evaluate import evaluate
from armour.errors import InputError, NoAnswerError
from armour.scenario.library import read_library, shipped_library
from armour.scenario.scenario import Scenario, load_scenario
from armour.statistics.calibration import calibrate, with_ceramic
from armour.statistics.fitted_library import library_text, save_fit, scenario_text
from armour.statistics.measured import read_tests
from tests.helpers.cases import TESTS, scenario, shipped_scenario
from tests.helpers.fits import table_of, wilkins_fit
from tests.helpers.known import known

WILKINS = shipped_scenario("wilkins")

pytestmark = pytest.mark.slow

C, B = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"
LIMITS = f"{C},{B},ballistic_limit_m_s"


def test_a_library_holds_the_tests(tmp_path: Path):
    tests = read_tests("tests/wilkins", WILKINS)
    path = tmp_path / "lib.toml"
    path.write_text(library_text(wilkins_fit(), tests, WILKINS, "lot 7"))
    entry = read_library(path, shipped_library()).entries["ceramic"]["AD85, lot 7"]
    value = entry.values["flow_stress_GPa"]
    assert value.value == pytest.approx(5.20935, abs=2e-5)
    assert value.status == "fitted"
    assert value.source.startswith(
        "armour calibrate, 13 tests of wilkins (shipped), constant law, 95 % interval 4.868 to 5.5"
    )
    assert len(value.tests) == 13
    assert value.tests[0] == {
        "impact.projectile": "7.62 mm AP",
        "armour.backing": "6061-T6",
        C: 5.8,
        B: 7.24,
        "ballistic_limit_m_s": 735.0,
    }
    assert entry["density_kg_m3"] == 3430.0


def test_a_law_is_written_as_keys_that_other_thicknesses_follow(tmp_path: Path):
    tests = read_tests(TESTS, WILKINS)
    result = wilkins_fit("backing")
    (tmp_path / "lib.toml").write_text(library_text(result, tests, WILKINS, "lot 7"))
    (tmp_path / "case.toml").write_text(
        WILKINS.to_toml().replace('"AD85"', '"AD85, lot 7"') + '[library]\nfiles = ["lib.toml"]\n'
    )
    columns = {C: np.array([5.8, 7.85]), B: np.array([7.24, 4.35])}
    limits = evaluate(load_scenario(tmp_path / "case.toml"), columns, ["ballistic_limit_m_s"])["ballistic_limit_m_s"]
    assert limits == pytest.approx([result.residuals[0].computed, result.residuals[9].computed], abs=0.1)


def test_other_laws_of_the_entry_are_not_written():
    with_product = with_ceramic(shipped_scenario("wilkins"), {"flow_stress_product_exponent": 0.3})
    tests = read_tests(TESTS, with_product)
    text = library_text(wilkins_fit("constant"), tests, with_product, "lot 7")
    entry = tomllib.loads(text)["ceramic"]["AD85, lot 7"]
    assert entry["flow_stress_product_exponent"] == 0.0
    assert len(entry["flow_stress_GPa"]["tests"]) == 13


def test_a_scenario_holds_the_fit_with_its_tests(tmp_path: Path):
    """Relative paths of libraries stay right, and other distributions stay; the tests replace those of the values."""
    (tmp_path / "libs").mkdir()
    (tmp_path / "libs/own.toml").write_text('[metal.own]\nbased_on = "6061-T6"\n')
    (tmp_path / "case.toml").write_text(
        shipped_scenario("wilkins").to_toml()
        + """
[library]
files = ["libs/own.toml"]
[uncertainty.ceramic]
flow_stress_GPa = { distribution = "uniform", min = 4.0, max = 6.0 }
density_kg_m3 = { distribution = "normal", standard_deviation_percent = 1.0 }
[[uncertainty.correlation]]
between = ["ceramic.flow_stress_GPa", "ceramic.density_kg_m3"]
coefficient = 0.2
"""
    )
    case = load_scenario(tmp_path / "case.toml")
    tests = read_tests(TESTS, case)
    result = wilkins_fit("backing")
    path = tmp_path / "libs/made.toml"
    path.write_text(scenario_text(result, tests, case, "lot 7", path))
    loaded: Scenario = load_scenario(path)
    assert loaded.library.files == ("own.toml",)
    assert loaded.uncertainty is not None
    inputs = loaded.uncertainty.inputs()
    assert inputs["ceramic.density_kg_m3"].standard_deviation_percent == 1.0
    assert not {coefficient.name for coefficient in result.coefficients} & inputs.keys()
    assert loaded.uncertainty.correlation == []
    assert loaded.uncertainty.model is None
    entry = loaded.entry("ceramic", "AD85, lot 7")
    assert entry["flow_stress_backing_exponent"] == pytest.approx(0.3232, abs=1e-3)
    assert known(entry.evidence).model_dump(exclude_none=True, exclude_defaults=True) == {
        **known(result.evidence),
        "lot": "lot 7",
    }


def test_every_place_that_names_the_material_follows(tmp_path: Path):
    with_design = shipped_scenario("wilkins").replaced(
        {
            "threat": [{"projectile": "7.62 mm AP", "velocity_m_s": 700.0}, {"threat": "NIJ 0101.06 type IV, M2 AP"}],
            "design.ceramic": [{"material": name, "thickness_mm": [6.0, 8.0]} for name in ("AD85", "SiC")],
            "design.backing": [{"material": "6061-T6", "thickness_mm": [6.35]}],
        }
    )
    tests = read_tests(TESTS, with_design)
    data = tomllib.loads(scenario_text(wilkins_fit(), tests, with_design, "lot 7", tmp_path / "a.toml"))
    assert data["armour"]["ceramic"] == "AD85, lot 7"
    assert [layer["material"] for layer in data["design"]["ceramic"]] == ["AD85, lot 7", "SiC"]
    assert (data["design"]["backing"][0]["material"], data["threat"][1]) == (
        "6061-T6",
        with_design.to_dict()["threat"][1],
    )
    assert "uncertainty" not in data
    of_round = calibrate(tests, with_design, "projectile.flow_stress_GPa")
    data = tomllib.loads(scenario_text(of_round, tests, with_design, "lot 7", tmp_path / "a.toml"))
    assert data["impact"]["projectile"] == data["threat"][0]["projectile"] == "7.62 mm AP, lot 7"
    assert "projectile" not in data["threat"][1]


def test_a_fit_of_several_inputs_is_written_with_their_distributions(tmp_path: Path):
    wilkins, names = shipped_scenario("wilkins"), ["ceramic.flow_stress_GPa", "backing.shear_strength_MPa"]
    tests = table_of(wilkins, *TESTS.read_text().splitlines()[:6])
    result = calibrate(tests, wilkins, names)
    assert result.evidence is None
    path = tmp_path / "made.toml"
    path.write_text(scenario_text(result, tests, wilkins, "lot 7", path))
    section = known(load_scenario(path).uncertainty)
    for coefficient in result.coefficients:
        assert section.inputs()[coefficient.name].distribution == "normal"
        assert section.inputs()[coefficient.name].standard_deviation == pytest.approx(
            coefficient.standard_error, rel=1e-5
        )
    [fitted] = section.correlation
    assert fitted.coefficient == pytest.approx(result.correlation[0][1], rel=1e-4)


def test_an_entry_of_the_scenario_is_written_whole(tmp_path: Path):
    entry = {"based_on": "AD85", "density_kg_m3": 3500.0}
    for name in ("mine", "AD85"):
        case = scenario(ceramic=name, library={"ceramic": {name: entry}})
        tests = read_tests(TESTS, case)
        (tmp_path / "lib.toml").write_text(library_text(wilkins_fit(), tests, case, "lot 7"))
        written = read_library(tmp_path / "lib.toml", shipped_library()).entries["ceramic"][f"{name}, lot 7"]
        assert written["density_kg_m3"] == 3500.0
        assert written["youngs_modulus_GPa"] == 267.0


def test_a_fit_is_saved_as_the_command_writes_it(tmp_path: Path):
    wilkins, result = shipped_scenario("wilkins"), wilkins_fit()
    tests = read_tests(TESTS, wilkins)
    save_fit(result, tests, wilkins, lot="lot 7", library=tmp_path / "lib.toml", fitted=tmp_path / "case.toml")
    assert (tmp_path / "lib.toml").read_text() == library_text(result, tests, wilkins, "lot 7")
    assert load_scenario(tmp_path / "case.toml").armour.ceramic == "AD85, lot 7"
    with pytest.raises(InputError, match="save_fit: library: must be given, or fitted"):
        save_fit(result, tests, wilkins, lot="lot 7")


OUTCOMES = "impact.velocity_m_s,outcome,ballistic_limit_uncertainty_m_s"


def test_a_file_of_toml_is_written_or_none():
    """A name in another encoding is no text."""
    fit = (wilkins_fit(), read_tests(TESTS, WILKINS), WILKINS)
    assert "AD85, é\u00a07" in tomllib.loads(library_text(*fit, "é\u00a07"))["ceramic"]
    with pytest.raises(InputError, match=r"must be given names in UTF-8, found .*\\udce9"):
        library_text(*fit, "\udce9")
    with pytest.raises(InputError, match=r"must be given names in UTF-8, found .*\\udce9"):
        scenario_text(*fit, "\udce9", Path("a.toml"))


def test_a_library_of_outcomes_has_their_velocities_and_no_interval_that_is_open():
    tests = table_of(WILKINS, OUTCOMES, "700,stopped,10", "750,perforated,10")
    result = calibrate(tests, WILKINS)
    [stress] = result.coefficients
    opened = replace(result, coefficients=(replace(stress, interval=(None, 6.0)),))
    for fit_result, interval in ((result, True), (opened, False)):
        [entry] = tomllib.loads(library_text(fit_result, tests, WILKINS, "lot 7"))["ceramic"].values()
        assert ("% interval" in entry["flow_stress_GPa"]["source"]) is interval
        assert [test["impact.velocity_m_s"] for test in entry["flow_stress_GPa"]["tests"]] == [700.0, 750.0]


def test_one_test_is_enough(tmp_path: Path):
    tests = table_of(WILKINS, f"{C},ballistic_limit_m_s", "6.35,720")
    result = calibrate(tests, WILKINS)
    [warning] = (text for text in result.warnings if "too few" in text)
    assert "4 % of each measured value is assumed" in warning
    (tmp_path / "s.toml").write_text(scenario_text(result, tests, WILKINS, "lot 7", tmp_path / "s.toml"))
    evidence = known(load_scenario(tmp_path / "s.toml").entry("ceramic", "AD85, lot 7").evidence)
    assert (evidence.lot, evidence.source) == ("lot 7", "1 test of rows")


@pytest.mark.parametrize(
    ("table", "settings", "message"),
    [
        (
            [OUTCOMES, "700,stopped,10", "690,stopped,10"],
            {"fit": ["ceramic.flow_stress_GPa", "backing.shear_strength_MPa"]},
            "on one side only|not identified",
        ),
        ([LIMITS, "6.35,6.35,700", "6.35,6.35,710", "6.35,6.35,720"], {"law": "ceramic"}, "not identified"),
        (
            [LIMITS, "5,6,166.39", "6,7,181.98", "7,5,173.88", "8,8,203.81"],
            {"fit": ["projectile.penetrator_diameter_mm"]},
            r"nothing to write: .* must make a rod 0\.1 to 100 diameters long",
        ),
    ],
)
def test_what_is_not_written(tmp_path: Path, table: list[str], settings: dict[str, Any], message: str):
    """An input that is bounded on one side only or not identified, and a fit that no scenario allows."""
    tests = table_of(WILKINS, *table)
    with pytest.raises(NoAnswerError, match=message):
        scenario_text(calibrate(tests, WILKINS, **settings), tests, WILKINS, "lot 7", tmp_path / "s.toml")
