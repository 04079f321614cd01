from pathlib import Path

import pytest

from armour.errors import NoAnswerError
from armour.scenario.library import read_library, shipped_library
from armour.statistics.calibration import calibrate
from armour.statistics.fitted_library import library_text
from armour.statistics.test_data import read_tests
from tests.helpers.cases import TESTS, csv_file, scenario, shipped_scenario

C, B = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"


def test_a_library_holds_the_tests(tmp_path: Path):
    wilkins = shipped_scenario("wilkins")
    tests = read_tests(TESTS, wilkins)
    path = tmp_path / "lib.toml"
    path.write_text(library_text(calibrate(tests, wilkins), tests, wilkins))
    entry = read_library(path, shipped_library()).entries["ceramic"]["AD85, calibrated"]
    value = entry.values["flow_stress_GPa"]
    assert value.value == pytest.approx(5.20935, abs=2e-5)
    assert value.status == "fitted"
    assert value.source.startswith("armour calibrate, 13 tests of wilkins.csv, constant law, 95 % interval 4.87 to 5.5")
    assert len(value.tests) == 13
    assert value.tests[0] == {
        "impact.projectile": "7.62 mm AP",
        "armour.backing": "6061-T6",
        C: 5.8,
        B: 7.24,
        "ballistic_limit_m_s": 735.0,
    }
    assert entry["density_kg_m3"] == 3430.0


def test_a_coefficient_that_is_not_identified_is_not_written(tmp_path: Path):
    wilkins = shipped_scenario("wilkins")
    rows = [f"6.35,6.35,{v}" for v in (700, 710, 720)]
    tests = read_tests(csv_file(tmp_path / "t.csv", f"{C},{B},ballistic_limit_m_s", *rows), wilkins)
    with pytest.raises(NoAnswerError, match="not identified"):
        library_text(calibrate(tests, wilkins, law="linear"), tests, wilkins)


def test_a_fit_that_no_scenario_allows_is_not_written(tmp_path: Path):
    wilkins = shipped_scenario("wilkins")
    rows = ("5,6,166.39", "6,7,181.98", "7,5,173.88", "8,8,203.81")
    tests = read_tests(csv_file(tmp_path / "t.csv", f"{C},{B},ballistic_limit_m_s", *rows), wilkins)
    result = calibrate(tests, wilkins, ["projectile.penetrator_diameter_mm"])
    with pytest.raises(NoAnswerError, match=r"nothing to write: .* must make a rod 0\.1 to 100 diameters long"):
        library_text(result, tests, wilkins)


def test_an_entry_of_the_scenario_is_written_whole(tmp_path: Path):
    entry = {"based_on": "AD85", "density_kg_m3": 3500.0}
    for name in ("mine", "AD85"):
        case = scenario(ceramic=name, library={"ceramic": {name: entry}})
        tests = read_tests(TESTS, case)
        (tmp_path / "lib.toml").write_text(library_text(calibrate(tests, case), tests, case))
        written = read_library(tmp_path / "lib.toml", shipped_library()).entries["ceramic"][f"{name}, calibrated"]
        assert written["density_kg_m3"] == 3500.0
        assert written["youngs_modulus_GPa"] == 267.0
