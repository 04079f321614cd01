"""Reports in a real browser, where there is one, and what the command says."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cases import SCENARIOS

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
OPTIMUM = SCENARIOS / "paper" / "optimum_7.62mm_AP.toml"
QUIET = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
)


def test_a_report(cli, folder: Path):
    result = cli("report", OPTIMUM, "-o", "r.html")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "wrote r.html\n")
    page = (folder / "r.html").read_text()
    for words in ("11 mm AD85 on 6 mm 5083-H3", "54.2 kg/m²", "armour report", "the paper, table 2"):
        assert words in page


def test_markdown(cli, folder: Path):
    assert cli("report", SCENARIOS / "catalogue.toml", "-o", "r.md").stderr == "wrote r.md\n"
    page = (folder / "r.md").read_text()
    assert page.startswith("# Two threats, three ceramics")
    assert "* Build: **5 mm Al-N on 5 mm 7075-T6**; 10.5 mm thick" in page
    assert "## Pareto front" in page
    assert "```toml\ntitle = " in page
    assert cli("report", SCENARIOS.parent / "suites" / "paper.toml", "-o", "s.md").exit_code == 0
    assert "74 of 74 within their bands" in (folder / "s.md").read_text()


def test_another_ending(cli):
    assert cli.fails(2, "report", OPTIMUM, "-o", "r.docx") == ["r.docx: must end in .html or .md, found .docx"]


def test_changes_and_standard_input(folder: Path):
    command = ["python", "-m", "armour", "report", "-", "-o", "r.html", "--set", "title=Changed"]

    done = subprocess.run(
        [sys.executable, *command[1:]],
        input=OPTIMUM.read_text(),
        capture_output=True,
        text=True,
        cwd=folder,
        check=True,
    )
    assert done.stderr == "wrote r.html\n"
    assert "<h1>Changed</h1>" in (folder / "r.html").read_text()


def test_an_impact_without_energy(cli, folder: Path):
    change = ("--set", "impact.velocity_m_s=1e-300")
    assert cli("report", SCENARIOS / "bare_plate.toml", *change, "-o", "r.html").exit_code == 0
    assert "projectile stopped" in (folder / "r.html").read_text()


WATCH = """<script>
  const said = [];
  addEventListener("error", e => said.push(e.message));
  addEventListener("securitypolicyviolation", e => said.push(e.violatedDirective + " " + e.blockedURI));
  console.error = (...all) => said.push(all.join(" "));
  addEventListener("load", () => setTimeout(() => {
    const drawn = [...document.querySelectorAll(".chart")].map(c => !!c.querySelector("svg.main-svg"));
    const asked = performance.getEntriesByType("resource").map(entry => entry.name);
    document.body.innerHTML = "<pre id=found>" + JSON.stringify({said, drawn, asked}) + "</pre>";
  }, 500));
</script>"""


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium")
@pytest.mark.parametrize("name", ["paper/optimum_7.62mm_AP", "catalogue", "uncertain"])
def test_a_browser_shows_it_without_an_error_or_a_request(cli, folder: Path, name: str):
    """Every chart is drawn, nothing is said on the console, no address is asked for and its policy forbids to."""
    assert cli("report", SCENARIOS / f"{name}.toml", "-o", "r.html").exit_code == 0
    page = (folder / "r.html").read_text()
    assert "default-src 'none'" in page
    (folder / "watched.html").write_text(page.replace("<head>", "<head>" + WATCH, 1))
    command = [str(CHROMIUM), *QUIET, f"--user-data-dir={folder / 'profile'}"]
    command += ["--virtual-time-budget=8000", "--dump-dom", (folder / "watched.html").as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    found = json.loads(done.stdout.split('<pre id="found">')[1].split("</pre>")[0])
    assert found["said"] == []
    assert found["asked"] == []
    assert len(found["drawn"]) >= 4
    assert all(found["drawn"])
