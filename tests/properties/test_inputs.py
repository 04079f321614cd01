"""Commands on inputs that nobody meant end in an answer or in messages, without a number that is none."""

import csv
import json
import re
import tempfile
import tomllib
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from tests.helpers.cases import SCENARIOS
from tests.helpers.commands import invoke
from tests.helpers.examples import examples

pytestmark = pytest.mark.slow

WILKINS: dict[str, Any] = tomllib.loads((SCENARIOS / "wilkins.toml").read_text())
# A scenario with a table of every kind that these commands read.
SCENARIO: dict[str, Any] = {
    **WILKINS,
    "model": {"shear_perimeter": "projectile"},
    "solver": {"arrest_velocity_m_s": 1.0},
    "ballistic_limit": {"velocity_min_m_s": 100.0, "velocity_max_m_s": 2000.0, "tolerance_m_s": 0.1},
    "library": {
        "projectile": {"7.62 mm AP": {"based_on": "7.62 mm AP", "penetrator_diameter_mm": 6.5}},
        "ceramic": {"AD85": {"based_on": "AD85", "flow_stress_GPa": {"value": 3.0, "source": "a"}}},
        "metal": {"6061-T6": {"based_on": "6061-T6", "density_kg_m3": 2700.0}},
    },
}
ASKED = {"name": "a", "scenario": "scenario.toml", "band": 20.0}
SUITE: dict[str, Any] = {
    "title": "t",
    "case": [{**ASKED, "quantity": "ballistic_limit_m_s", "expected": 723.0, "reason": "r", "source": "s"}],
    "table": [{**ASKED, "quantity": "residual_velocity_m_s", "columns": ["impact.velocity_m_s", "expected"]}],
}
SUITE["table"][0] |= {"rows": [[800.0, 277.0]], "rms_band_percent": 5.0}
SHOTS = (SCENARIOS / "tests" / "shots.csv").read_text()
TESTS = "\n".join((SCENARIOS / "tests" / "wilkins.csv").read_text().splitlines()[:4])

NUMBERS = (0, -1, 5e-324, 1e-9, 1e-3, 1e3, 1e5, 1e300, float("nan"), float("inf"), 2**62, 10**400)
TEXTS = ("", "value", "AD85", "\x1b[31m", "a|b\n# c", "<!--<script>", "[bold]", "=1+1", "$x$", "\ufffe", "_")
ODD = st.sampled_from([*NUMBERS, *TEXTS, True, [], {}, [[]], {"value": 1.0}, {"min": 1.0, "max": 2.0, "step": 0.5}])
JUNK = st.sampled_from([b"", b"\0", b"\xff", b"\xef\xbb\xbf", b"\r", b'"', b"[", b"]]", b"=", b",", b"9" * 5000, b"e9"])


def places(data: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The paths of all values within data."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return [found for key, inner in items for found in [(*path, key), *places(inner, (*path, key))]]


@st.composite
def changed(draw: st.DrawFn, data: dict[str, Any]) -> bytes:
    """TOML data with a value replaced, added, renamed or removed, or its text with other bytes."""
    data = deepcopy(data)
    *path, last = draw(st.sampled_from(places(data)))
    table: Any = data
    for part in path:
        table = table[part]
    match draw(st.sampled_from(["scale", "scale", "replace", "replace", "add", "remove", "bytes"])):
        case "scale" if isinstance(table[last], float):
            table[last] *= 10.0 ** draw(st.floats(-4.0, 4.0))
        case "add" if isinstance(table, dict):
            table[draw(st.sampled_from([f"{last}x", *TEXTS]))] = draw(ODD)
        case "remove":
            del table[last]
        case "bytes":
            return draw(with_junk(tomli_w.dumps(data).encode()))
        case _:
            table[last] = draw(ODD)
    return tomli_w.dumps(data).encode()


@st.composite
def with_junk(draw: st.DrawFn, content: bytes) -> bytes:
    """A file with some bytes replaced."""
    at = draw(st.integers(0, len(content)))
    return content[:at] + draw(JUNK) + content[at + draw(st.integers(0, 3)) :]


@st.composite
def with_cell(draw: st.DrawFn, content: str) -> bytes:
    """A table with a cell replaced."""
    rows = list(csv.reader(content.splitlines()))
    row = draw(st.sampled_from(rows))
    row[draw(st.integers(0, len(row) - 1))] = str(draw(ODD.filter(lambda value: value != 10**400)))
    return "\n".join(",".join(row) for row in rows).encode()


scenarios = changed(SCENARIO)
plain = st.just(tomli_w.dumps(SCENARIO).encode())
COMMANDS = {
    "simulate scenario.toml --history out.csv": (16, {"scenario.toml": scenarios}),
    "ballistic-limit scenario.toml": (15, {"scenario.toml": scenarios}),
    "compare scenario.toml": (6, {"scenario.toml": scenarios}),
    "validate suite.toml --markdown out.md --junit out.xml": (
        20,
        {"suite.toml": changed(SUITE), "scenario.toml": plain},
    ),
    "v50 shots.csv": (10, {"shots.csv": with_cell(SHOTS) | with_junk(SHOTS.encode())}),
    "calibrate tests.csv scenario.toml --lot 7 --write out.toml": (
        15,
        {"tests.csv": with_cell(TESTS) | with_junk(TESTS.encode()), "scenario.toml": scenarios},
    ),
    "report scenario.toml -o out.md": (4, {"scenario.toml": scenarios}),
}


def refuse(constant: str) -> None:
    raise AssertionError(constant)


@pytest.mark.parametrize("command", COMMANDS)
def test_any_input_ends_in_an_answer_or_in_messages(command: str):
    count, files = COMMANDS[command]

    @given(st.fixed_dictionaries(files), st.booleans())
    @examples(max_examples=count, suppress_health_check=list(HealthCheck))
    def run(contents: dict[str, bytes], as_json: bool) -> None:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for file, content in contents.items():
                (folder / file).write_bytes(content)
            words = [str(folder / word) if "." in word else word for word in command.split()]
            flags = ["--json"] if as_json and "report" not in command else []
            result = invoke([*words, *flags])
            assert result.exception is None or isinstance(result.exception, SystemExit)
            assert result.exit_code in (0, 1, 2, 3)
            made = {path.name: path.read_text() for path in folder.iterdir() if path.name not in contents}
        if result.exit_code == 2:
            made.pop("out.xml", "")  # JUnit XML of the messages
        assert not made or result.exit_code in (0, 3)
        if flags and result.stdout:
            json.loads(result.stdout, parse_constant=refuse)
        for text in [*made.values(), *([] if flags else [result.stdout])]:
            assert not re.search(r"(?<![\w\"'=.|\\-])[-+]?(nan|inf|Infinity)(?![\w\"'])", text)

    run()
