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


def test_rounds_and_materials_are_listed_with_each_other():
    found = tested.tested_with()
    assert found["metal", "AA5083-H116"] == ("7.62 mm APM2",)
    assert "AA5083-H116" in found["projectile", "7.62 mm APM2"]
    assert found["ceramic", "AD85"] == ("7.62 mm AP, on 6061-T6",)


def test_files_of_these_names_in_the_working_folder_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "tests").mkdir()
    for name in ("tests/plates", "tests/wilkins", "wilkins"):
        (tmp_path / name).write_text("a,b\n1,2\n")
    monkeypatch.chdir(tmp_path)
    assert tested.tested_with.__wrapped__() == tested.tested_with()
