"""One answer: a reason planted in a result stands, word for word, wherever the result is shown."""

import json
from collections.abc import Iterator
from dataclasses import replace
from html import unescape
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest

import armour
from armour.design import check as module
from armour.design.check import CheckedThreat
from armour.reporting.by_result import by_result, draw
from armour.reporting.pictures.drawing import Sheet
from armour.scenario.scenario import Scenario
from tests.helpers.cases import scenario
from tests.helpers.commands import invoke
from tests.helpers.known import known

pytestmark = pytest.mark.slow

REASON = "the moon was full when it was fired at, and nobody noted the phase"


@pytest.fixture(autouse=True)
def planted() -> Iterator[None]:
    """A reason that nobody has heard of, for which every probability that is unknown is so."""
    checked = module._checked_threat

    def with_reason(*given: Any, **options: Any) -> CheckedThreat:
        return replace(checked(*given, **options), reason=REASON)

    with patch.object(module, "_checked_threat", with_reason):
        yield


def case() -> Scenario:
    """An armour of which no test is known, alone in its catalogue, against two threats."""
    layers = {"ceramic": [{"material": "SiC", "thickness_mm": [9.0]}]}
    layers["backing"] = [{"material": "6061-T6", "thickness_mm": [8.0]}]
    faced = [{"projectile": name, "velocity_m_s": 700.0} for name in ("7.62 mm AP", "7.62 mm APM2")]
    design = {**layers, "probability_of_stopping": 0.9}
    return scenario("7.62 mm AP", "SiC", "6061-T6", 9.0, 8.0, threat=faced, design=design)


def is_said(text: str) -> bool:
    """Whether a text, a page or a file contains the reason, whose lines may end anywhere."""
    return REASON in " ".join(unescape(text).replace("\N{NO-BREAK SPACE}", " ").split())


def test_a_planted_reason_stands_wherever_the_answer_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(case().to_toml())
    lines = (
        "check s.toml --junit check.xml --markdown check.md",
        "check s.toml --json",
        "optimise s.toml --map page.html",
        "optimise s.toml --json",
    )
    for line in lines:
        done = invoke(line.split())
        assert done.exit_code in (1, 3)
        assert is_said(done.stdout), line
    assert invoke(["report", "s.toml", "-o", "report.html"]).exit_code == 0
    for name in ("check.xml", "check.md", "page.html", "report.html"):
        assert is_said(Path(name).read_text()), name
    for result in (armour.check(case()), armour.optimise(case())):
        picture = by_result(draw, result)(result, Sheet())
        assert is_said(f"{picture.title} {picture.note}")
        assert is_said(json.dumps(result.to_dict()))


def test_the_best_design_has_the_check_of_its_armour():
    found = armour.optimise(case())
    nearest = known(found.nearest)
    assert nearest.check == armour.check(nearest.scenario)
    assert [pair.best for pair in found.pairs] == [nearest]
    assert found.to_dict()["nearest"]["check"] == nearest.check.to_dict()
