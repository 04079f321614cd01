"""What entries of the library were tested with."""

from pathlib import Path

import pytest

from armour import confidence, shipped_library
from armour.validation import tested
from tests.helpers.cases import scenario


def test_the_error_is_known_of_what_was_tested_and_of_no_other_entry():
    found, library = tested.tested_with(), shipped_library()
    assert {("ceramic", "AD85"), ("metal", "6061-T6"), ("projectile", "7.62 mm AP")} < found.keys()
    assert not {("ceramic", "AD85 initial"), ("ceramic", "SiC"), ("metal", "Ti-6Al-4V")} & found.keys()
    assert not {("projectile", "7.62 mm B32"), ("projectile", "30 mm APDS")} & found.keys()
    for ceramic in library.names("ceramic"):
        known = confidence(scenario(ceramic=ceramic)).model_error is not None
        assert known == (("ceramic", ceramic) in found), ceramic


def test_files_of_these_names_in_the_working_folder_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "tests").mkdir()
    for name in ("tests/plates", "tests/wilkins", "wilkins"):
        (tmp_path / name).write_text("a,b\n1,2\n")
    monkeypatch.chdir(tmp_path)
    assert tested.tested_with.__wrapped__() == tested.tested_with()


def test_the_tested_armours_nearest_to_a_limit_are_those_against_such_a_core():
    """7.62 mm B32, 854 m/s: the core is like that of the AP and of the APM2, and unlike that of the M80 ball."""
    found = tested.nearest_measured(scenario("7.62 mm B32"), 854.0)
    tile, *plates = found
    assert (tile.armour, tile.projectile, tile.ballistic_limit_m_s) == (
        "7.83 mm AD85 on 6.35 mm 6061-T6",
        "7.62 mm AP",
        847.0,
    )
    assert tile.areal_density_kg_m2 == pytest.approx(3.43 * 7.83 + 2.75 * 6.35)
    assert {plate.projectile for plate in plates} == {".30 APM2"}
    assert min(plate.areal_density_kg_m2 for plate in plates) > 70.0
    assert tested.nearest_measured(scenario("20 mm FSP"), 854.0)[0].projectile == "20 mm FSP"
    assert tested.nearest_measured(scenario("25 mm APDS"), 854.0) == ()
    assert tested.nearest_measured(scenario().replaced({"impact.obliquity_deg": 30.0}), 854.0) == ()
