"""What leaves with version 3 says so when it is used, and docs/stability.md announces it."""

import json
import re
import shlex
import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

import armour
from armour.cli.runner import CHECK_FAILED
from armour.leaving import LEAVING, leaving
from tests.helpers.cases import SCENARIOS
from tests.helpers.commands import invoke
from tests.helpers.suites import TABLE, WILKINS_LIMIT, case
from tests.test_stability import LIST

STABILITY = Path(__file__).parent.parent / "docs" / "stability.md"
OPTIMUM = "paper/optimum_7.62mm_AP"
CERAMICS = "armour.ceramic_thickness_mm"
# By what leaves, commands that use it.
COMMANDS = {
    "plan tests": [f"plan tests wilkins --candidates {CERAMICS}=5,7 --number 1 --scatter-percent 3"],
    "compile": ["compile"],
    "calibrate --prior": ["calibrate tests/unknown_ceramic unknown_ceramic --prior"],
    "calibrate --law all": ["calibrate tests/unknown_ceramic unknown_ceramic --law all"],
    "library show": ["library show AD85", "library show 'NIJ 0101.06 type IV, M2 AP'", "library --json show AD85"],
    **{f"library {kind}": [f"library {kind}"] for kind in ("projectiles", "ceramics", "threats", "metals")},
    "table.rivals": ["validate suite.toml", "report suite.toml -o suite.md"],
}
# Commands near to these, which stay.
STAYING = [
    *("library", "library --tested", f"optimise {OPTIMUM}", "v50 tests/shots wilkins --prior"),
    *("calibrate tests/unknown_ceramic unknown_ceramic", "validate paper --only table", "validate plain.toml"),
]


def calibrated(**options: Any) -> object:
    scenario = armour.load_scenario("unknown_ceramic")
    return armour.calibrate(armour.read_tests("tests/unknown_ceramic", scenario), scenario, **options)


# By what leaves, programs that use it.
PROGRAMS: dict[str, Callable[[], object]] = {
    "plan_tests": lambda: armour.plan_tests(
        armour.load_scenario("wilkins"), {CERAMICS: [5.0, 7.0]}, number=1, scatter_percent=3.0
    ),
    "calibrate(prior=True)": lambda: calibrated(prior=True),
    'calibrate(law="all")': lambda: calibrated(law="all"),
    "table.rivals": lambda: armour.validate("suite.toml"),
    **{name: partial(getattr, armour, name[7:]) for name in LEAVING if name.startswith("armour.")},
}
# Keys of JSON that leave, by command of tests/interface.json; they say nothing.
KEYS = {
    "optimise paper/fig11_7.62mm_ceramics": [
        *("best.outside_tests", "frontier.outside_tests"),
    ],
    "check wilkins": ["threats.outside_tests"],
    "uncertainty uncertain --samples 128": [
        *("ballistic_limit_m_s.V05", "ballistic_limit_m_s.V50", "ballistic_limit_m_s.V95"),
        *("inputs.first", "inputs.total"),
    ],
    "calibrate unknown_ceramic tests/unknown_ceramic": ["aicc", "laws", "coefficients.prior_share"],
    "compare wilkins": [
        *("fits", "fitted_m_s", "florence.best_ceramic_thickness_mm", "florence.best_backing_thickness_mm"),
        *("florence.best_thickness_ratio", "florence.best_ballistic_limit_m_s", "florence.model_ballistic_limit_m_s"),
    ],
    "validate paper": ["errors"],
}


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Suites with and without rivals in the working folder, and no public name used before."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(SCENARIOS / "wilkins.toml", "wilkins.toml")
    Path("suite.toml").write_text(TABLE)
    Path("plain.toml").write_text(case("limit", WILKINS_LIMIT, "band = 1.0"))
    for name in LEAVING:
        monkeypatch.delitem(vars(armour), name.removeprefix("armour."), raising=False)


def notes(line: str) -> list[str]:
    """What a command says of what it uses that leaves."""
    done = invoke(shlex.split(line))
    assert done.exit_code in (0, CHECK_FAILED), done.stderr
    return [said for said in done.stderr.splitlines() if "version 3" in said]


def test_every_use_is_tested():
    # The line on replaced equations is tested in tests/core/test_replaced.py.
    assert {*COMMANDS, *PROGRAMS, "replacing equations"} == LEAVING.keys()


@pytest.mark.parametrize(("what", "line"), [(what, line) for what, lines in COMMANDS.items() for line in lines])
def test_a_command_says_once_that_it_uses_what_leaves(what: str, line: str):
    assert notes(line) == [f"note: {leaving(what)}"]


@pytest.mark.parametrize("line", STAYING)
def test_a_command_that_stays_says_nothing(line: str):
    assert notes(line) == []


@pytest.mark.parametrize("what", PROGRAMS)
def test_a_program_is_warned_where_it_uses_what_leaves(what: str):
    with pytest.warns(DeprecationWarning, match=re.escape(leaving(what))) as told:
        PROGRAMS[what]()
    assert {warning.filename for warning in told} == {__file__}
    assert {str(warning.message) for warning in told} == {leaving(what)}


@pytest.mark.parametrize("what", [*LEAVING, *(key for keys in KEYS.values() for key in keys)])
def test_the_page_on_stability_announces_it(what: str):
    announced = STABILITY.read_text(encoding="utf-8").partition("## Announced for version 3")[2].partition("\n## ")[0]
    assert f"`{what}`" in announced


@pytest.mark.parametrize("command", KEYS)
def test_the_keys_announced_are_keys(command: str):
    known = json.loads(LIST.read_text(encoding="utf-8"))["json"][command].split()
    assert {*KEYS[command]} <= {*known}
