"""How the model error does on tests left out: parts of docs/evidence/left-out.md, computed anew."""

import pytest

from tests.helpers.cases import SCENARIOS
from tools.campaigns.evidence import Outcome, bands, beyond_the_limit, study
from tools.tables import table

pytestmark = pytest.mark.slow

PAGE = (SCENARIOS.parent / "docs" / "evidence" / "left-out.md").read_text(encoding="utf-8")


def are_shown(rows: list[list[str]]) -> bool:
    _, _, lines = table([""], rows).split("\n", 2)
    return lines in PAGE


def test_alloys_left_out():
    plates, found, rows = study("fragments_aluminium")
    assert are_shown(rows)
    assert are_shown([*bands("fragments_aluminium", plates, found)])
    of_limits = [*beyond_the_limit("fragments_aluminium", found)]
    assert are_shown(of_limits)
    assert all(float(stopped) >= float(stated) for _, stated, *_, stopped in of_limits if float(stated) >= 90.0)
    outcome = Outcome.of(*found)
    assert outcome.within.mean() >= 0.93
    assert outcome.above.mean() >= 0.92
    # Better than a rule of thumb.
    rms = {method: float(rms) for _, method, _, rms, *_ in rows}
    assert rms["this model"] <= 7.8
    assert rms["this model"] < 0.5 * rms["k sqrt(Y t D²/m)"]
