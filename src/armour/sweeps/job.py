"""What a sweep computes and by which program: its chunks serve the same job only."""

from collections.abc import Mapping, Sequence
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

import armour
from armour.scenario.inputs import ROLES
from armour.scenario.scenario import Scenario
from armour.sweeps.cases import Cases, Grid

# What a job depends on, by name, each as text.
Job = Mapping[str, str]

PACKAGE = Path(__file__).resolve().parent.parent
LIBRARIES = ("numba", "numpy")


@cache
def program() -> str:
    """Return a hash of all source files of this program and of the versions of the libraries that compute."""
    found = sha256(repr([(name, version(name)) for name in LIBRARIES]).encode())
    for path in sorted(PACKAGE.rglob("*.py")):
        found.update(sha256(path.relative_to(PACKAGE).as_posix().encode() + b"\n" + path.read_bytes()).digest())
    return found.hexdigest()


def job_of(scenario: Scenario, source: Grid | Cases, quantities: Sequence[str]) -> Job:
    """Return the job of a sweep."""
    entries = [scenario.entry_of(role) for role in ROLES]
    return {
        "version": armour.__version__,
        "program": program(),
        "scenario": sha256(repr((scenario, scenario.inputs(), entries)).encode()).hexdigest(),
        "quantities": ",".join(quantities),
        "rows": source.digest,
    }


def differences(here: Job, there: Job) -> list[str]:
    """Return what differs between two jobs, in words."""
    found = [name for name in here if here[name] != there.get(name)]
    if "version" in found:
        # The source of another version is another one.
        found = [name for name in found if name != "program"]
    words = {
        "version": f"version of armour ({there.get('version')}, where this is {here['version']})",
        "program": "program (its source, or the version of numba or numpy)",
    }
    return [words.get(name, name) for name in found]
