"""Write a page on what the tests run: `python docs/coverage_page.py PAGE`, after `coverage combine`.

coverage.toml says why functions are not run whole; what it does not name ends the program with exit code 1.
"""

import json
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path
from typing import Any

HEAD = """# Coverage

Written by `make coverage`, which runs all tests, and counts the lines and branches of `src/armour` that they and the
processes that they start run.

| | run | of | % |
|---|---:|---:|---:|
"""


def measured() -> dict[str, Any]:
    """Return the JSON report of coverage."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "coverage.json"
        subprocess.run([sys.executable, "-m", "coverage", "json", "--quiet", "-o", path], check=True)
        return json.loads(path.read_text(encoding="utf-8"))


def row(what: str, run: int, total: int) -> str:
    """Return a row of the table of totals."""
    return f"| {what} | {run:,} | {total:,} | {100 * run / total:.1f} |"


def missing(function: dict[str, Any]) -> str:
    """Return what of a function is not run, in words."""
    lines, branches = function["missing_lines"], function["missing_branches"]
    # Branches from lines that are not run say nothing more.
    open_branches = sum(start not in lines for start, _ in branches)
    counts = [(len(lines), "line", "lines"), (open_branches, "branch", "branches")]
    return ", ".join(f"{count} {one if count == 1 else many}" for count, one, many in counts if count)


def page(report: dict[str, Any], reasons: dict[str, dict[str, str]]) -> tuple[str, list[str]]:
    """Return the page, and the functions without a reason."""
    totals = report["totals"]
    rows = [
        row("lines", totals["covered_lines"], totals["num_statements"]),
        row("branches", totals["covered_branches"], totals["num_branches"]),
    ]
    found: dict[str, list[str]] = {}
    unknown = []
    for path, file in sorted(report["files"].items()):
        module = path.partition("armour/")[2]
        for name, function in file["functions"].items():
            if not function["missing_lines"] and not function["missing_branches"]:
                continue
            given = reasons.get(module, {})
            reason = given.get(name or "module") or given.get("*")
            if reason is None:
                unknown.append(
                    f"{module}: {name or 'module'}: lines {function['missing_lines']}, "
                    f"branches {function['missing_branches']}"
                )
                reason = "No reason is given."
            found.setdefault(reason, []).append(f"* `{module}`, `{name or 'module'}`: {missing(function)}")
    parts = ["\n".join([reason, "", *lines]) for reason, lines in sorted(found.items(), key=lambda item: -len(item[1]))]
    return HEAD + "\n".join(rows) + "\n\n## What is not run\n\n" + "\n\n".join(parts) + "\n", unknown


def main(target: str) -> None:
    """Write the page; end with exit code 1 if a reason is missing."""
    reasons = tomllib.loads(Path(__file__).with_name("coverage.toml").read_text(encoding="utf-8"))
    text, unknown = page(measured(), reasons)
    Path(target).write_text(text, encoding="utf-8")
    if unknown:
        sys.exit("docs/coverage.toml: must say why these are not run whole:\n" + "\n".join(unknown))


if __name__ == "__main__":
    main(sys.argv[1])
