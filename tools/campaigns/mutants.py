"""Change the core term by term, by mutmut's mutants, and count the changes that tests detect.

    python -m tools.campaigns mutants

One process collects the tests of the core and forks a child for each mutant, which puts the mutant's code into the
function and runs the tests that call it, the quickest first.  A mutant is detected if a test fails or takes over four
times as long as usual.
"""

import difflib
import importlib
import os
import resource
import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import Any, NamedTuple

import libcst
import pytest
from mutmut.mutation.file_mutation import create_mutations

from armour.engine import compiled
from tools.campaigns.trials import exit_code, forked
from tools.campaigns.verdict import asked, verdict

# The core in plain Python, and the same random inputs each time.
os.environ["CI"] = "1"
vars(compiled)["library"] = lambda: None

ROOT = Path(__file__).resolve().parents[2]
CORE = ROOT / "src" / "armour" / "core"
FILES = ("equations.py", "rk4.py", "stages.py", "roots.py", "events.py", "run.py", "search.py")
TESTS = (
    "tests/core",
    "tests/analysis/test_impact.py",
    *(f"tests/numerics/test_{name}.py" for name in ("closed_forms", "order", "similarity", "independent")),
)
# Least share of mutants that must be detected, per cent.
LEAST = 95.0
# A test that takes this much longer has noticed: times the usual, and seconds.
LONGER, AT_LEAST_S = 4.0, 0.2
SURVIVED, DETECTED, TIMED_OUT = "survived", "detected", "timed out"
ENDINGS = {0: SURVIVED, 1: DETECTED, -signal.SIGPROF: TIMED_OUT}


class Mutant(NamedTuple):
    """A changed function of a file of the core."""

    file: str
    function: str
    source: str
    difference: str


def mutants_of(file: str) -> Iterator[Mutant]:
    """Yield the mutants of a file."""
    module, mutations, _, _ = create_mutations(file, (CORE / file).read_text(encoding="utf-8"))
    for mutation in mutations:
        function = mutation.contained_by_top_level_function
        if not isinstance(function, libcst.FunctionDef):
            continue
        changed = function.deep_replace(mutation.original_node, mutation.mutated_node)
        assert isinstance(changed, libcst.FunctionDef)
        before, after = module.code_for_node(function), module.code_for_node(changed)
        lines = difflib.ndiff(before.splitlines(), after.splitlines())
        difference = " ".join(" ".join(line.split()) for line in lines if line[0] in "-+")
        yield Mutant(file, function.name.value, after, difference)


def original(mutant: Mutant) -> FunctionType:
    """Return the function that a mutant changes."""
    function = getattr(importlib.import_module(f"armour.core.{mutant.file.removesuffix('.py')}"), mutant.function)
    assert isinstance(function, FunctionType)
    return function


class Usual:
    """Plugin of pytest that records the time of each test and the functions of the core that it calls."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.calls: dict[str, set[CodeType]] = {}

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Run a test."""
        called = self.calls[item.nodeid] = set()
        codes: set[CodeType] = set()

        def entered(frame: FrameType, event: str, _argument: Any) -> None:
            if event == "call":
                codes.add(frame.f_code)

        start = time.process_time()
        sys.setprofile(entered)
        try:
            return (yield)
        finally:
            sys.setprofile(None)
            self.seconds[item.nodeid] = time.process_time() - start
            called |= {code for code in codes if Path(code.co_filename).parent == CORE}


class Campaign:
    """Plugin of pytest that tries mutants in place of running the tests once."""

    def __init__(self, mutants: list[Mutant], usual: Usual) -> None:
        self.mutants, self.usual = mutants, usual
        self.outcomes: Counter[tuple[str, str]] = Counter()

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Try the mutants."""
        quickest = sorted(session.items, key=lambda item: self.usual.seconds[item.nodeid])
        for mutant in self.mutants:
            code = original(mutant).__code__
            items = [item for item in quickest if code in self.usual.calls[item.nodeid]]
            ending = ENDINGS.get(exit_code(forked(self.try_in_child, mutant, items)), DETECTED)
            self.outcomes[mutant.file, ending] += 1
            if ending == SURVIVED:
                print(f"{mutant.file}: {mutant.function}: {mutant.difference}", flush=True)
        return True

    def try_in_child(self, mutant: Mutant, items: list[pytest.Item]) -> int:
        """Put the mutant in place and run the tests; the process ends at the first that fails."""
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
        function = original(mutant)
        names: dict[str, Any] = {}
        exec(mutant.source, function.__globals__, names)
        changed = names[mutant.function]
        function.__code__, function.__defaults__ = changed.__code__, changed.__defaults__
        for item in items:
            signal.setitimer(signal.ITIMER_PROF, LONGER * self.usual.seconds[item.nodeid] + AT_LEAST_S)
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=None)
        return 0

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """End the child at the first test that fails."""
        if report.failed:
            os._exit(1)


def main() -> int:
    """Try the mutants and print those that survive, and a table."""
    files = asked(__doc__).words or FILES
    mutants = [mutant for file in files for mutant in mutants_of(file)]
    options = ["-o", "addopts=", *(f"-pno:{name}" for name in ("cacheprovider", "terminal", "xdist")), *TESTS]
    # The first run also fills what the tests keep, which no child then computes.
    usual = Usual()
    if code := pytest.main(options, [usual]):
        print("the tests fail without a mutant")
        return int(code)
    campaign = Campaign(mutants, usual)
    pytest.main(options, [campaign])
    print("| file | mutants | detected | timed out | survived |\n|---|---:|---:|---:|---:|")
    for name in files:
        counts = [campaign.outcomes[name, ending] for ending in (DETECTED, TIMED_OUT, SURVIVED)]
        print(f"| `{name}` | {sum(counts)} | {' | '.join(map(str, counts))} |")
    survivors = sum(campaign.outcomes[name, SURVIVED] for name in files)
    detected = 100.0 * (1.0 - survivors / len(mutants))
    return verdict(f"{detected:.1f} % of {len(mutants):,} mutants detected", right=detected >= LEAST)
