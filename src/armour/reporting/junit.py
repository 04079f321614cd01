"""Write results as JUnit XML, which continuous-integration services read."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from armour.files import printable

# First bytes of every file that `junit_xml` makes, by which it is recognised.
BEGINNING = b"<?xml version='1.0' encoding='utf-8'?>\n<testsuites name=\"armour\""


class TestCase(NamedTuple):
    """A test case: its group and title, its result, a message, the time it took, in seconds, and lines of output.

    `result` is "failure", "error", "skipped" or, if it passed, "".  `file` is the input file, and `line` the line of a
    mistake in it.
    """

    group: str
    title: str
    result: str
    message: str
    seconds: float | None = None
    file: str = ""
    line: int | None = None
    output: Sequence[str] = ()


def junit_suite(name: str, cases: Iterable[TestCase], seconds: float, origin: Mapping[str, str]) -> ElementTree.Element:
    """Return the XML element of a test suite with its test cases.

    `seconds` is the time that all of them took.  `origin` has properties of the suite, such as the program version.
    """
    suite = ElementTree.Element("testsuite", name=printable(name), time=f"{seconds:.3f}")
    properties = ElementTree.SubElement(suite, "properties")
    for key, text in origin.items():
        ElementTree.SubElement(properties, "property", name=key, value=printable(text))
    counts = Counter[tuple[str, str]]()
    for case in cases:
        counts[case.group, case.title] += 1
        count = counts[case.group, case.title]
        title = printable(case.title) + (f" ({count})" if count > 1 else "")  # services merge cases of equal names
        element = ElementTree.SubElement(suite, "testcase", classname=printable(case.group), name=title)
        time = "" if case.seconds is None else f"{case.seconds:.3f}"
        attributes = {"file": printable(case.file), "line": str(case.line or ""), "time": time}
        element.attrib |= {name: text for name, text in attributes.items() if text}
        if case.result:
            message = printable(case.message)
            # GitLab shows the text of the element, others its attribute.
            ElementTree.SubElement(element, case.result, message=message).text = message
        if case.output:
            ElementTree.SubElement(element, "system-out").text = "\n".join(map(printable, case.output))
    suite.set("tests", str(len(suite.findall("testcase"))))
    for plural, result in {"failures": "failure", "errors": "error", "skipped": "skipped"}.items():
        suite.set(plural, str(len(suite.findall(f"testcase/{result}"))))
    return suite


def junit_xml(suites: Iterable[ElementTree.Element]) -> bytes:
    """Format elements of test suites as one JUnit file."""
    root = ElementTree.Element("testsuites", name="armour")
    root.extend(suites)
    ElementTree.indent(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))


def is_junit_of_armour(path: Path) -> bool:
    """Return whether a file is one that `junit_xml` has made."""
    with suppress(OSError), path.open("rb") as file:
        return file.read(len(BEGINNING)) == BEGINNING
    return False
