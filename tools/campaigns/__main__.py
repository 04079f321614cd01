"""Run the campaigns and write docs/campaigns.md, with what each has found.

    python -m tools.campaigns [NAME]...

runs the named campaigns, by default all, one after the other; a name may have options, as in "coverage firings
--samples 100". A campaign ends with a line for the page and exit code 0, or 3 if something is not as it should be. The
page is written after each one: an interrupted run keeps what it has, and another run may go on beside it.
"""

import ast
import json
import subprocess
import sys
import time
from datetime import UTC, datetime
from pathlib import Path

from armour import MODEL_VERSION, __version__
from tools.campaigns.verdict import RESULT, WRONG

ROOT = Path(__file__).resolve().parents[2]
PAGE, KNOWN = ROOT / "docs" / "campaigns.md", Path(__file__).with_name("results.json")
CAMPAIGNS = {
    "Faults and inputs": ("inputs", "sweeps", "tables", "cache"),
    "Numbers": ("accuracy", "unusual", "perturbations", "mutants"),
    "Statistics": ("coverage", "own_tests", "evidence"),
}
ENDINGS = {0: "yes", WRONG: "**no**"}
TEXT = """# Campaigns

This page is written by `make campaigns`, which runs the programs of `tools/campaigns`, each also run alone by `python
-m tools.campaigns NAME`. They try what takes too long for the tests: many inputs, faults at every step, and how often
the stated intervals contain the truth. "As expected" is "yes" if the program found nothing wrong: no fault, no share
below the least that it requires. Minutes are those of one core, which others may have used as well.
"""
HEAD = """| program | what it does | result | as expected | minutes | version, model, commit, date |
|---|---|---|---|--:|---|
"""


def run(name: str, options: list[str]) -> dict[str, str]:
    """Run a campaign, show what it prints, and return what the page tells of it."""
    start, lines = time.monotonic(), []
    command = [sys.executable, "-m", f"tools.campaigns.{name}", *options]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            print(line, end="", flush=True)
            lines.append(line.strip())
    results = [line.removeprefix(RESULT) for line in lines if line.startswith(RESULT)]
    return {
        "purpose": purpose(name),
        "result": "; ".join(results),
        "ending": ENDINGS.get(process.returncode, f"**ended with exit code {process.returncode}**"),
        "minutes": f"{(time.monotonic() - start) / 60.0:.1f}",
        "version": f"{__version__}, {MODEL_VERSION}, {commit()}, {datetime.now(UTC):%Y-%m-%d}",
    }


def commit() -> str:
    """Return the commit, and whether the program was changed after it."""
    found = subprocess.check_output(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, text=True).strip()
    same = subprocess.run(["git", "diff", "--quiet", "HEAD", "--", "src", "configs"], cwd=ROOT, check=False)
    return f"{found}, changed" if same.returncode else found


def page(known: dict[str, dict[str, str]]) -> str:
    """Return the page of what is known."""
    parts = [TEXT]
    for heading, names in CAMPAIGNS.items():
        rows = [f"| `{name}` | {' | '.join(known[name].values())} |\n" for name in names if name in known]
        parts += [f"## {heading}\n", HEAD + "".join(rows)] if rows else []
    return "\n".join(parts)


def purpose(name: str) -> str:
    """Return what a campaign does: the first line of its docstring."""
    docstring = ast.get_docstring(ast.parse(Path(__file__).with_name(f"{name}.py").read_text(encoding="utf-8")))
    return " ".join((docstring or "").partition("\n\n")[0].split())


def main(names: list[str]) -> int:
    """Run campaigns; the exit code is 3 if one did not end as it should."""
    endings, ran = set(), names or [name for some in CAMPAIGNS.values() for name in some]
    for words in ran:
        name, *options = words.split()
        print(f"{name}: {purpose(name)}", flush=True)
        found = run(name, options)
        known = json.loads(KNOWN.read_text(encoding="utf-8")) | {name: found}
        endings.add(found["ending"])
        KNOWN.write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")
        PAGE.write_text(page(known), encoding="utf-8")
    return WRONG if endings - {ENDINGS[0]} else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
