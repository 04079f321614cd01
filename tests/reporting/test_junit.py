import re
from pathlib import Path
from xml.etree import ElementTree

from armour.reporting.views.suite import junit
from tests.helpers.suites import TABLE, case, result


def test_every_case_and_table_is_a_test_case(folder: Path):
    text = (
        case("in", 724.0, "band = 1.0")
        + case("out", 725.0, "band = 1.0")
        + case("none", 724.0, "band = 1.0\nset.ballistic_limit.velocity_min_m_s = 1000.0")
        + case("slip", 1.0, 'not_scored = "a slip"')
    )
    suite = ElementTree.fromstring(junit(result(folder, 'title = "A | suite"\n' + text + TABLE), 1.25))
    found = (suite.get("name"), suite.get("tests"), suite.get("failures"), suite.get("skipped"))
    assert found == ("A | suite", "7", "3", "1")
    assert suite.get("time") == "1.250"
    cases = {(c.get("classname"), c.get("name")): c for c in suite}
    failure = cases["cases", "out"].find("failure")
    assert failure is not None
    assert failure.get("message") == (
        "expected 725 m/s, computed 723.8 m/s, deviation -1.2 m/s, relative deviation -0.17 %, band ± 1 m/s"
    )
    assert cases["cases", "slip"].find("skipped") is not None
    assert cases["cases", "in"].find("failure") is None
    rms = cases["t", "RMS"].find("failure")
    assert rms is not None
    assert re.fullmatch(r"RMS \d+\.\d\d m/s, RMS band \S+ m/s", str(rms.get("message")))
    message = cases["cases", "none"].find("failure")
    assert message is not None
    assert "no ballistic limit" in str(message.get("message"))


def test_control_characters_leave_it_well_formed(folder: Path):
    xml = junit(result(folder, 'title = "a\\u001b[31m"\n' + case("b\\u0007", 725.0, "band = 1.0")), 0.0)
    suite = ElementTree.fromstring(xml)
    assert (suite.get("name"), suite[0].get("name")) == ("a\\x1b[31m", "b\\x07")
