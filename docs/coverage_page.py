"""Write a page on what the tests run: `python docs/coverage_page.py PAGE`, after `coverage combine`.

coverage.toml says why functions are not run whole.  One that it does not name, or less coverage than is asked for, ends
the program with exit code 1.
"""

import json
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path
from typing import Any

# Lines and branches that the tests must run, %.
LEAST_PERCENT = 97.0
HEAD = f"""# Coverage

Written by `make coverage`, which runs all tests and counts the lines and branches of `src/armour` that they, and the
processes that they start, run. At least {LEAST_PERCENT:g} % of each are asked for.

| | run | of | % |
|---|---:|---:|---:|
"""


def measured() -> dict[str, Any]:
    """Return the JSON report of coverage."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "coverage.json"
        subprocess.run([sys.executable, "-m", "coverage", "json", "--quiet", "-o", path], check=True)
        return dict(json.loads(path.read_text(encoding="utf-8")))


def missing(function: dict[str, Any]) -> str:
    """Return what of a function is not run, in words; "" for nothing."""
    lines, branches = function["missing_lines"], function["missing_branches"]
    # A branch from a line that is not run, or to one, says nothing more.
    only_branches = [(start, end) for start, end in branches if start not in lines and end not in lines]
    counts = [(len(lines), "line", "lines"), (len(only_branches), "branch", "branches")]
    return ", ".join(f"{count} {one if count == 1 else many}" for count, one, many in counts if count)


def functions(report: dict[str, Any]) -> dict[str, str]:
    """Return the functions that are not run whole, as ``module.py: name``, with what is not run."""
    return {
        f"{path.partition('armour/')[2]}: {name or 'module'}": words
        for path, file in sorted(report["files"].items())
        for name, function in file["functions"].items()
        if (words := missing(function))
    }


def main(target: str) -> None:
    """Write the page, and say what is wrong."""
    report = measured()
    totals, left = report["totals"], functions(report)
    counts = {
        "lines": (totals["covered_lines"], totals["num_statements"]),
        "branches": (totals["covered_branches"], totals["num_branches"]),
    }
    rows = [f"| {what} | {run:,} | {of:,} | {100.0 * run / of:.1f} |" for what, (run, of) in counts.items()]
    parts = ["\n".join(rows), "## What is not run"]
    reasons = tomllib.loads(Path(__file__).with_name("coverage.toml").read_text(encoding="utf-8"))["reason"]
    for reason in reasons:
        if found := [name for name in left if name in reason["functions"]]:
            parts += [reason["why"], "\n".join(f"* `{name}`: {left.pop(name)}" for name in found)]
    Path(target).write_text(HEAD + "\n\n".join(parts) + "\n", encoding="utf-8")

    wrong = [f"docs/coverage.toml: must say why {name} is not run whole: {words}" for name, words in left.items()]
    wrong += [
        f"the tests must run {LEAST_PERCENT:g} % of the {what}, found {100.0 * run / of:.1f} %"
        for what, (run, of) in counts.items()
        if 100.0 * run < LEAST_PERCENT * of
    ]
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main(sys.argv[1])
