import pytest

from armour.analysis.ballistic_limit import ballistic_limit, confidence
from armour.design.check import check
from armour.reporting.views.design import check_junit
from armour.scenario.inputs import VELOCITY
from tests.helpers.cases import scenario, shipped_scenario
from tests.helpers.known import known

THREATS = [
    {"projectile": "7.62 mm AP", "velocity_m_s": 600.0, "name": "slow"},
    {"projectile": "7.62 mm AP", "velocity_m_s": 700.0, "margin_m_s": 30.0, "obliquity_deg": 0.0},
]


def test_the_impact_is_checked_where_there_is_no_threat():
    [found] = check(scenario(velocity=700.0)).threats
    own = scenario(velocity=700.0)
    assert found.ballistic_limit_m_s == ballistic_limit(own).ballistic_limit_m_s
    assert found.margin_m_s == known(found.expected_limit_m_s) - 700.0
    assert found.expected_limit_m_s == confidence(own).expected_limit_m_s
    assert found.probability_of_stopping == confidence(own).probability_of_stopping
    assert found.verdict == "expected to stop"
    assert found.required_probability is None


def test_every_threat_and_change_is_what_the_scenario_says_when_changed():
    case = scenario(threat=THREATS, design={"thickness_tolerance_mm": 0.5})
    slow, fast = check(case).threats
    assert (slow.threat, slow.verdict) == ("slow", "expected to stop")
    assert fast.verdict == "fails"  # 715 m/s are expected, and 730 required
    assert [what_if.change for what_if in fast.what_ifs] == [
        "tile 0.5 mm thinner",
        "plate 0.5 mm thinner",
        "5 % faster",
        "at 30°",
    ]
    changes = [
        {"armour.ceramic_thickness_mm": 5.85},
        {"armour.backing_thickness_mm": 5.85},
        {"impact.velocity_m_s": 735.0},
        {"impact.obliquity_deg": 30.0},
    ]
    for what_if, values in zip(fast.what_ifs, changes, strict=True):
        other = confidence(scenario(velocity=700.0).replaced(values))
        assert what_if.ballistic_limit_m_s == other.ballistic_limit_m_s
        assert what_if.probability_of_stopping == other.probability_of_stopping
        assert what_if.interval_m_s == other.interval_m_s
        assert what_if.expected_limit_m_s == other.expected_limit_m_s


@pytest.mark.parametrize(
    ("velocity", "required", "passed"), [(600.0, 0.9, True), (700.0, 0.9, False), (700.0, 0.55, True)]
)
def test_the_probability_that_is_required_decides(velocity: float, required: float, passed: bool):
    found = check(scenario(velocity=velocity, design={"probability_of_stopping": required}))
    assert found.verdict == ("passes" if passed else "fails")
    assert found.threats[0].required_probability == required


def test_a_probability_that_is_unknown_does_not_pass():
    found = check(scenario(ceramic="SiC", velocity=300.0, design={"probability_of_stopping": 0.6}))
    assert found.verdict == "not known"
    assert found.threats[0].reason
    assert check(scenario(ceramic="SiC", velocity=300.0)).verdict == "stopped by the model"


@pytest.mark.parametrize("ends", [{"velocity_max_m_s": 200.0}, {"velocity_min_m_s": 2500.0}])
def test_the_range_of_the_search_changes_nothing(ends: dict[str, float]):
    narrow, wide = (check(scenario(velocity=700.0, **of)) for of in ({"ballistic_limit": ends}, {}))
    assert narrow.threats[0].ballistic_limit_m_s == pytest.approx(wide.threats[0].ballistic_limit_m_s, abs=0.02)
    assert narrow.verdict == wide.verdict == "expected to stop"


def test_an_armour_that_nothing_perforates_is_stopped_by_the_model():
    found = check(shipped_scenario("bare_plate").replaced({"armour.backing_thickness_mm": 300.0}))
    assert (found.verdict, found.threats[0].ballistic_limit_m_s) == ("stopped by the model", None)


def test_a_test_case_for_every_threat():
    case = scenario(threat=THREATS)
    found = check_junit(check(case), case, 1.25, {"version": "2"})
    assert (found.attrib["tests"], found.attrib["time"]) == ("2", "1.250")
    [version] = found.iter("property")
    assert version.attrib == {"name": "version", "value": "2"}
    cases = found.findall("testcase")
    assert {case.attrib["classname"] for case in cases} == {case.file}
    assert [[part.tag for part in case] for case in cases] == [["skipped", "system-out"], ["failure", "system-out"]]
    assert [case.get("time") for case in cases] == ["1.250", None]
    assert "limit 715 m/s expected" in cases[1][0].attrib["message"]


def test_an_impact_that_is_no_threat_is_warned_of():
    case = shipped_scenario("catalogue")
    assert not [note for note in check(case).warnings if note.startswith("impact: ")]
    for velocity, shown in ((2000.0, "2000"), (case.impact.velocity_m_s + 1e-6, f"{case.impact.velocity_m_s:g}")):
        [note] = [note for note in check(case.replaced({VELOCITY: velocity})).warnings if note.startswith("impact: ")]
        words = "of [impact] is not used: the threats of [[threat]] are, and it is none of them"
        assert note == f"impact: 7.62 mm AP at {shown} m/s {words}"
