"""The command, and its reports in a browser where there is one."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.helpers.cases import SCENARIOS
from tests.helpers.suites import TABLE

pytestmark = pytest.mark.slow

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
    page = (folder / "r.html").read_text().replace("\N{NO-BREAK SPACE}", " ")
    for words in ("11 mm AD85 on 6 mm <span>5083-H3</span>", "54.23 kg/m²", "armour report", "[Paper], table 2"):
        assert words in page


def test_markdown(cli, folder: Path):
    assert cli("report", SCENARIOS / "catalogue.toml", "-o", "r.md").stderr == "wrote r.md\n"
    page = (folder / "r.md").read_text()
    assert page.startswith("# 5 mm Al-N on 5 mm 7075-T6 against 7.62 mm AP at 850 m/s and ")
    assert "* Best design: **5 mm Al-N on 5 mm 7075-T6**; 10.5 mm thick" in page
    assert "## Pareto front" in page
    assert "```toml\ntitle = " in page
    (folder / "suite.toml").write_text(f"{TABLE.replace('wilkins.toml', str(SCENARIOS / 'wilkins.toml'))}")
    assert cli("report", "suite.toml", "-o", "s.md").exit_code == 0
    assert "2 of 3 within their bands" in (folder / "s.md").read_text()


def test_the_armour_as_it_is(cli, folder: Path):
    assert cli("report", OPTIMUM, "--as-is", "-o", "r.md", "--set", "author=A. Smith").exit_code == 0
    page = (folder / "r.md").read_text()
    assert "* Armour: **10.3 mm AD85 on 7 mm 5083-H3**" in page
    assert "author: A. Smith, revision: armour " in page
    assert "--output r.md --as-is --set 'author=A. Smith'" in page
    [line] = cli.fails(2, "report", SCENARIOS.parent / "suites" / "paper.toml", "--as-is")
    assert line == "command line: --as-is: must be given with a scenario, found a suite"
    [line] = cli.fails(2, "report", OPTIMUM, "--as-is", "--set", "design.thickness_max_mm=20")
    assert "--set design.thickness_max_mm: " in line


def test_changes_and_standard_input(cli, folder: Path):
    text = (SCENARIOS / "bare_plate.toml").read_text()
    done = cli("report", "-", "-o", "r.html", "--set", "title=Changed", stdin=text)
    assert done.stderr == "wrote r.html\n"
    assert "<span>Scenario: Changed</span>" in (folder / "r.html").read_text()


def test_an_impact_without_energy(cli, folder: Path):
    change = ("--set", "impact.velocity_m_s=1e-9")
    assert cli("report", SCENARIOS / "bare_plate.toml", *change, "-o", "r.html").exit_code == 0
    assert "projectile defeated" in (folder / "r.html").read_text()


def browse(page: Path, *options: str) -> str:
    """What Chromium writes when it opens a page."""
    command = [str(CHROMIUM), *QUIET, f"--user-data-dir={page.parent / 'profile'}", *options, page.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout


# A script of its own, which the page's policy would not allow, records what the browser complains of and asks for.
WATCH = """<script>
  const said = [];
  addEventListener("error", e => said.push(e.message));
  addEventListener("securitypolicyviolation", e => said.push(e.violatedDirective + " " + e.blockedURI));
  addEventListener("load", () => setTimeout(() => {
    const boxes = [...document.querySelectorAll(".chart svg")].map(c => c.getBoundingClientRect());
    const drawn = boxes.map(box => box.width > 200 && box.height > 100);
    const asked = performance.getEntriesByType("resource").map(entry => entry.name);
    const wide = document.documentElement.scrollWidth > innerWidth;
    const cut = [...document.querySelectorAll(".scroll")].filter(box => box.scrollWidth > box.clientWidth).length;
    const tip = document.querySelector(".point text");
    const hidden = getComputedStyle(tip).visibility;
    tip.parentNode.focus();
    const shown = getComputedStyle(tip).visibility;
    document.body.innerHTML = `<pre id=found>${JSON.stringify({said, drawn, asked, wide, cut, hidden, shown})}</pre>`;
  }, 500));
</script>"""


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
@pytest.mark.parametrize("name", ["catalogue", "uncertain"])
def test_a_browser_shows_it_without_an_error_or_a_request(cli, folder: Path, name: str):
    """Every chart and table is within the page, values are shown on focus, and no address is asked for."""
    few = ("--set", "uncertainty.samples=128") if name == "uncertain" else ()
    assert cli("report", SCENARIOS / f"{name}.toml", *few, "-o", "r.html").exit_code == 0
    page = (folder / "r.html").read_text()
    watched = page.replace("style-src 'unsafe-inline'", "style-src 'unsafe-inline'; script-src 'unsafe-inline'", 1)
    (folder / "watched.html").write_text(watched.replace("<head>", "<head>" + WATCH, 1))
    # The window of a browser cannot be as narrow as a telephone's; a frame can.
    widths = (390, 1280)
    frames = [f'<iframe src="watched.html" style="width: {width}px; height: 900px"></iframe>' for width in widths]
    options = ("--virtual-time-budget=8000", "--allow-file-access-from-files", "--window-size=1400,2000")
    show = """<script>setTimeout(() => { const pages = [...document.querySelectorAll("iframe")];
      document.body.innerHTML = pages.map(page => page.contentDocument.body.innerHTML).join(""); }, 3000);</script>"""
    (folder / "frame.html").write_text(f"<body>{''.join(frames)}{show}</body>")
    content = browse(folder / "frame.html", *options, "--dump-dom")
    answers = content.split('<pre id="found">')[1:]
    assert len(answers) == len(widths)
    for answer in answers:
        found = json.loads(answer.split("</pre>")[0])
        assert found["said"] == []
        assert found["asked"] == []
        assert len(found["drawn"]) >= 4
        assert all(found["drawn"])
        assert not found["wide"]
        assert found["cut"] == 0
        assert (found["hidden"], found["shown"]) == ("hidden", "visible")


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_a_printed_report_has_few_pages(cli, folder: Path):
    assert cli("report", SCENARIOS / "catalogue.toml", "-o", "r.html").exit_code == 0
    browse(folder / "r.html", "--no-pdf-header-footer", f"--print-to-pdf={folder / 'r.pdf'}")
    assert 2 <= (folder / "r.pdf").read_bytes().count(b"/Type /Page\n") <= 6
