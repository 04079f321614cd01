"""Run the campaigns of docs/evidence/campaigns.md and write their results into its tables.

    python -m tools.campaigns [NAME]...

runs the named campaigns, by default all, one on each core. A name may have options, as in "inputs --trials 100"; its
result is written only if the page has such a row. A campaign ends with its result and exit code 0, or 3 if something
is not as it should be. The page is written after each one, so that an interrupted run keeps what it has.
"""

import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor, as_completed
from datetime import UTC, datetime
from pathlib import Path

from armour import MODEL_VERSION, __version__
from armour.engine.batch import available_cores
from tools.campaigns.verdict import RESULT, WRONG

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "evidence" / "campaigns.md"
ENDINGS = {0: "yes", WRONG: "**no**"}


def run(name: str) -> list[str]:
    """Run a campaign, show what it prints, and return its results as cells of the page."""
    program, *options = name.split()
    results = []
    code = f"import sys; from tools.campaigns.{program} import main; sys.exit(main())"
    command = [sys.executable, "-c", code, *options]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            print(f"{name}: {line}", end="", flush=True)
            results += [line.removeprefix(RESULT).strip()] if line.startswith(RESULT) else []
        _, status, usage = os.wait4(process.pid, 0)
        ended = process.returncode = os.waitstatus_to_exitcode(status)
    ending = ENDINGS.get(ended, f"**ended with exit code {ended}**")
    minutes = f"{(usage.ru_utime + usage.ru_stime) / 60.0:.1f}"
    last_change = ["git", "log", "-1", "--format=%h", "--", "src", "configs"]
    commit = subprocess.check_output(last_change, cwd=ROOT, text=True).strip()
    version = f"{__version__}, {MODEL_VERSION}, {commit}, {datetime.now(UTC):%Y-%m-%d}"
    return ["; ".join(results), ending, minutes, version]


def write(name: str, cells: list[str]) -> None:
    """Write the results of a campaign into its row of the page."""
    row = re.compile(rf"^(\| `{re.escape(name)}` \| .+?) \| .*$", re.MULTILINE)
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(row.sub(lambda old: f"{old[1]} | {' | '.join(cells)} |", page), encoding="utf-8")


def main(names: list[str]) -> int:
    """Run campaigns; the exit code is 3 if one did not end as it should."""
    rows = re.findall(r"^\| `(.+?)` \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    code = 0
    with ThreadPoolExecutor(available_cores()) as pool:
        campaigns = {pool.submit(run, name): name for name in names or rows}
        for campaign in as_completed(campaigns):
            cells = campaign.result()
            write(campaigns[campaign], cells)
            code = code if ENDINGS[0] in cells else WRONG
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
