"""The words of what is computed."""

import pytest

from armour import load_scenario
from armour.scenario.scenario import ANY_VELOCITY, Varied
from armour.scenario.schema import Threat
from tests.helpers.cases import scenario

CERAMIC, BACKING, PROJECTILE = "armour.ceramic", "armour.backing", "impact.projectile"
THICK, PLATE = "armour.ceramic_thickness_mm", "armour.backing_thickness_mm"


def test_the_armour_is_that_of_the_scenario_as_changed():
    changed = scenario().replaced({CERAMIC: "SiC", THICK: 8.00049, "impact.velocity_m_s": 850.5})
    assert changed.subject() == "8 mm SiC on 6.35 mm 6061-T6 against 7.62 mm AP at 850.5 m/s"
    assert changed.replaced({THICK: 0.0}).subject() == "6.35 mm 6061-T6 against 7.62 mm AP at 850.5 m/s"
    assert load_scenario("bare_plate").subject(ANY_VELOCITY) == "20 mm AA6082-T651 against 7.62 mm APM2"


@pytest.mark.parametrize(
    ("varied", "words"),
    [
        ({THICK: (4.0, 8.0)}, "AD85 on 6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s"),
        ({PLATE: (), **ANY_VELOCITY}, "6.35 mm AD85 on 6061-T6 against 7.62 mm AP"),
        ({CERAMIC: ("AD85", "SiC", "AD85")}, "6.35 mm AD85 or SiC on 6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s"),
        ({CERAMIC: [*"abc"], THICK: ()}, "a, b or c on 6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s"),
        ({CERAMIC: [*"abcde"], THICK: ()}, "a, b, c or 2 more on 6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s"),
        ({CERAMIC: [None], THICK: ()}, "6.35 mm 6061-T6 against 7.62 mm AP at 800 m/s"),
        (
            dict.fromkeys((CERAMIC, BACKING, PROJECTILE), ()),
            "6.35 mm ceramic on 6.35 mm metal against different rounds at 800 m/s",
        ),
    ],
)
def test_what_varies_is_listed_or_left_out(varied: Varied, words: str):
    assert scenario().subject(varied) == words


def test_threats_are_in_place_of_the_impact():
    threats = [Threat(name=name, projectile="7.62 mm APM2", velocity_m_s=800.0) for name in ("a", "b", "c", "d")]
    assert scenario().subject({}, threats[:1]).endswith(" against 7.62 mm APM2 at 800 m/s")
    assert scenario().subject({}, threats).endswith("6061-T6 against 4 threats")
