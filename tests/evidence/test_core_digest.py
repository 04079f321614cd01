"""The equations that the tests were computed with."""

from pathlib import Path
from shutil import copytree

import pytest

import armour
from armour.evidence import core_digest as digests
from armour.evidence.core_digest import CORE_FOLDER, core_digest
from armour.evidence.fit import shipped_data
from tests.conftest import RENEW


def test_the_recorded_digest_is_that_of_the_core():
    assert core_digest() == shipped_data()["core"]["sha256"], RENEW


@pytest.mark.parametrize(
    ("old", "new", "counts"),
    [
        ("    return pi * D0 * D0 / 4.0", "    return pi * D0 * D0 / 4.1", True),
        ("    return pi * D0 * D0 / 4.0", "    if D0:\n        return pi * D0 * D0 / 4.0", True),
        ("    v = V - W\n", "    v = V - W\n    v = V + W\n", True),
        ("    v = V - W\n", "    v = V - W  # relative\n", False),
        ('"""Equations of the paper', '"""The equations of the paper', False),
        ("    v = V - W\n", "    v = (\n        V - W)\n", False),
        ("STRENGTH, INTERFACE = 0, 1\n", "\n\nSTRENGTH,  INTERFACE = 0, 1\r\n", False),
        ("    ", "  ", False),
    ],
)
def test_what_changes_the_digest(tmp_path: Path, old: str, new: str, counts: bool):
    changed = copytree(CORE_FOLDER, tmp_path / "core", ignore=lambda *_: ["__pycache__"]) / "equations.py"
    text = changed.read_text(encoding="utf-8")
    assert old in text
    changed.write_text(text.replace(old, new), encoding="utf-8", newline="")
    assert (core_digest(tmp_path / "core") != core_digest()) == counts


def test_without_its_equations_no_probability_is_known(monkeypatch: pytest.MonkeyPatch):
    scenario = armour.load_scenario("wilkins")
    assert armour.ballistic_limit(scenario).model_error is not None
    monkeypatch.setattr(digests, "core_digest", lambda: "of other equations")
    assert armour.ballistic_limit(scenario).model_error is None
    confidence = armour.confidence(scenario)
    assert confidence.probability_of_stopping is None
    assert "the tests were not computed with the equations as they are in armour/core" in confidence.reason
