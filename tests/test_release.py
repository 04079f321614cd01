"""The version, the changelog and CITATION.cff agree; `make release` checks the rest."""

import re
import runpy
import zipfile
from pathlib import Path

import pytest
from hatchling.build import build_wheel

import armour
from armour import files

ROOT = Path(__file__).parent.parent
CHECKOUT = (ROOT / "src").exists()  # not in the environment of `make release`
RELEASE = runpy.run_path(str(ROOT / "tools" / "release.py")) if CHECKOUT else {}
pytestmark = pytest.mark.skipif(not CHECKOUT, reason="needs the sources")


def test_the_version_is_that_of_the_changelog_and_the_citation():
    assert RELEASE["VERSION"] == armour.__version__
    assert RELEASE["disagreements"]() == []


def test_workflows_on_a_page_use_this_version():
    page = (ROOT / "docs" / "howto" / "ci.md").read_text(encoding="utf-8")
    assert re.findall(r"(?:armour@|rev: )(\S+)", page) == [RELEASE["TAG"]] * 2


def test_another_version_is_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    tmp_path.joinpath("CHANGELOG.md").write_text(f"## Unreleased\n\n## {armour.__version__} (2001-02-03)\n")
    tmp_path.joinpath("CITATION.cff").write_text("version: 0.0.1\ndate-released: 2001-02-03\n")
    names = RELEASE["disagreements"].__globals__
    monkeypatch.setitem(names, "ROOT", tmp_path)
    assert RELEASE["disagreements"]() == [f"CITATION.cff: must have the line version: {armour.__version__}"]
    monkeypatch.setitem(names, "VERSION", "0.0.1")
    assert RELEASE["disagreements"]() == [
        f"CHANGELOG.md: the first version must be 0.0.1, with its date, found {armour.__version__} (2001-02-03)"
    ]


def test_no_text_tells_to_install_the_program_by_name():
    """On a package index the name may be another program's."""
    by_name = re.compile(
        r"""(install|pipx run|uvx)( -\S+)* ["']?armour(-ballistics)?(?![\w/-])|["']armour(-ballistics)?\["""
    )
    places = ("*.*", "Makefile", ".github/**/*", "docs/**/*", "src/**/*", "tools/**/*")
    paths = [path for place in places for path in ROOT.glob(place) if path.is_file()]
    texts = {path: path.read_bytes().decode(errors="replace") for path in paths}
    assert len(texts) > 200
    told = [f"{path}: {found[0]}" for path, text in texts.items() for found in by_name.finditer(text)]
    assert told == []


def test_the_wheel_ships_what_the_program_reads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(ROOT)
    with zipfile.ZipFile(tmp_path / build_wheel(str(tmp_path))) as wheel:
        wheel.extractall(tmp_path)
    here = {name: [*files.shipped_files(name, "").items()] for name in ("configs", "scenarios", "suites")}
    monkeypatch.setattr(files, "_PACKAGE", tmp_path / "armour")
    files.shipped_files.cache_clear()
    for name, shipped in here.items():
        assert shipped
        assert [*files.shipped_files(name, "")] == [path for path, _ in shipped]
        assert files.shipped(name) == tmp_path / "armour" / name
    assert [*files.shipped_notebooks()] == ["study.ipynb"]
    files.shipped_files.cache_clear()
    more = "py.typed", "__init__.pyi", "reporting/templates/report.html"
    assert all((tmp_path / "armour" / name).exists() for name in more)
