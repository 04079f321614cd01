"""JUnit XML, which continuous integration reads."""

from collections import Counter
from collections.abc import Iterable
from typing import Any
from xml.etree import ElementTree

from armour.files import printable


def junit_xml(name: str, cases: Iterable[tuple[str, str, str, str]], **attributes: Any) -> bytes:
    """Format test cases: class, name, "failure", "skipped" or "" for one that passed, and message of each."""
    suite = ElementTree.Element("testsuite", name=printable(name), **attributes)
    seen = Counter[tuple[str, str]]()
    for group, title, result, message in cases:
        seen[group, title] += 1
        number = f" ({seen[group, title]})" if seen[group, title] > 1 else ""  # readers take equal names for one case
        case = ElementTree.SubElement(suite, "testcase", classname=printable(group), name=printable(title) + number)
        if result:
            ElementTree.SubElement(case, result, message=printable(message))
    suite.set("tests", str(len(suite)))
    suite.set("failures", str(len(suite.findall("testcase/failure"))))
    suite.set("skipped", str(len(suite.findall("testcase/skipped"))))
    ElementTree.indent(suite)
    return bytes(ElementTree.tostring(suite, encoding="utf-8", xml_declaration=True))
