"""The outcome of a suite as JUnit's XML, for CI."""

from xml.etree import ElementTree

from armour.files import printable
from armour.reporting.tables.validation import failure, held_to
from armour.validation.validate import FAILED, Status, SuiteResult


def suite_junit(result: SuiteResult, seconds: float) -> bytes:
    """Format the outcome of a suite: a test case for every case, and for every table that is held to a band.

    The time in seconds is that of all cases, most of which are computed together.
    """
    suite = ElementTree.Element("testsuite", name=printable(result.title or result.file), time=f"{seconds:.3f}")
    for check in result.checks:
        if check.in_group:
            continue
        message = check.message or check.case.not_scored
        if check.status == "outside":
            message = failure(check)
        _add(suite, check.case.group or "cases", check.case.name, check.status, message)
    for summary in result.summaries:
        if summary.status != "not scored":
            _add(suite, summary.name, summary.group or "RMS", summary.status, held_to(summary))
    suite.set("tests", str(len(suite)))
    suite.set("failures", str(len(suite.findall("testcase/failure"))))
    suite.set("skipped", str(len(suite.findall("testcase/skipped"))))
    ElementTree.indent(suite)
    return bytes(ElementTree.tostring(suite, encoding="utf-8", xml_declaration=True))


def _add(suite: ElementTree.Element, group: str, name: str, status: Status, message: str) -> None:
    case = ElementTree.SubElement(suite, "testcase", classname=printable(group), name=printable(name))
    if status in FAILED:
        ElementTree.SubElement(case, "failure", message=printable(message))
    elif status == "not scored":
        ElementTree.SubElement(case, "skipped", message=printable(message))
