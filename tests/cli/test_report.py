"""The command, and its reports in a browser where there is one."""

import json
import re
from pathlib import Path

import pytest

from tests.helpers.browser import browse, needs_chromium
from tests.helpers.cases import SCENARIOS
from tests.helpers.commands import invoke
from tests.helpers.suites import TABLE

pytestmark = pytest.mark.slow

PANEL = SCENARIOS / "panel.toml"
# The design found for the catalogue.
FOUND = "7.5 mm AD85 on 8 mm 7075-T6"


@pytest.fixture(scope="module")
def catalogue(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of a catalogue."""
    path = tmp_path_factory.mktemp("report") / "r.html"
    result = invoke(["report", "catalogue", "-o", str(path)])
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", f"wrote {path}\n")
    return path


def test_a_report(catalogue: Path):
    page = catalogue.read_text().replace("\N{NO-BREAK SPACE}", " ")
    for words in (FOUND, "48.3 kg/m²", "armour report", "[Paper], table 2"):
        assert words in page


def test_markdown(cli, folder: Path):
    assert cli("report", SCENARIOS / "catalogue.toml", "-o", "r.md").stderr == "wrote r.md\n"
    page = (folder / "r.md").read_text()
    assert page.startswith(f"# {FOUND} against 7.62 mm AP at 850 m/s and ")
    assert f"\n* armour: {FOUND}, 48.3 kg/m², " in page
    assert "\n## Designs\n" in page
    assert "```toml\ntitle = " in page
    (folder / "suite.toml").write_text(f"{TABLE.replace('wilkins.toml', str(SCENARIOS / 'wilkins.toml'))}")
    assert cli("report", "suite.toml", "-o", "s.md").exit_code == 0
    assert "2 of 3 within their bands" in (folder / "s.md").read_text()


def test_the_armour_as_it_is(cli, folder: Path):
    assert cli("report", PANEL, "--as-is", "-o", "r.md", "--set", "author=A. Smith").exit_code == 0
    page = (folder / "r.md").read_text()
    assert page.startswith("# 7 mm AD85 on 7 mm 6061-T6 against ")
    assert "\n* armour: 7 mm AD85 on 7 mm 6061-T6, 43.3 kg/m², " in page
    assert "\n## Designs\n" not in page
    assert "author: A. Smith, program version: armour " in page
    assert "--as-is -o r.md --set 'author=A. Smith'" in page
    [line] = cli.fails(2, "report", SCENARIOS.parent / "suites" / "paper.toml", "--as-is")
    assert line == "command line: --as-is: needs a scenario, found a suite"
    [line] = cli.fails(2, "report", "paper", "--probability", "0.9")
    assert line == "command line: --probability: needs a scenario, found a suite"
    [line] = cli.fails(2, "report", PANEL, "--as-is", "--set", "design.minimise=thickness_mm")
    assert "--set design.minimise: " in line


def test_a_required_probability(cli, folder: Path):
    few = "--probability 0.9 --set design.areal_density_max_kg_m2=70 --set optimise.ceramic_thickness_mm.step=0.5"
    assert cli("report", PANEL, "-o", "r.md", *few.split()).exit_code == 0
    page = (folder / "r.md").read_text()
    [verdict] = re.findall(r"^Passes: .+", page, re.MULTILINE)
    assert "(90 % required)" in verdict
    assert "45.7 of at most 70 kg/m²" in page
    assert cli("report", "wilkins", "-o", "w.md", "--as-is", "--probability", "0.9").exit_code == 0
    [verdict] = re.findall(r"^FAILS: .+", (folder / "w.md").read_text(), re.MULTILINE)
    assert "(90 % required)" in verdict


# A script of its own, which the page's policy would not allow, records what the browser complains of and asks for.
WATCH = """<script>
  const said = [];
  addEventListener("error", e => said.push(e.message));
  addEventListener("securitypolicyviolation", e => said.push(e.violatedDirective + " " + e.blockedURI));
  addEventListener("load", () => setTimeout(() => {
    const height = document.documentElement.scrollHeight;
    document.querySelectorAll("details").forEach(part => part.open = true);
    const boxes = [...document.querySelectorAll(".chart svg")].map(c => c.getBoundingClientRect());
    const drawn = boxes.map(box => box.width > 200 && box.height > 100);
    const asked = performance.getEntriesByType("resource").map(entry => entry.name);
    const wide = document.documentElement.scrollWidth > innerWidth;
    const cut = [...document.querySelectorAll(".scroll")].filter(box => box.scrollWidth > box.clientWidth).length;
    const found = {said, drawn, asked, wide, height, cut};
    document.body.innerHTML = `<pre id=found>${JSON.stringify(found)}</pre>`;
  }, 500));
</script>"""


@pytest.mark.usefixtures("drawn")
@needs_chromium
def test_a_browser_shows_it_without_an_error_or_a_request(cli, folder: Path, catalogue: Path):
    """Every chart and table is within the page, which is short; no address is asked for."""
    assert cli("report", "uncertain", "--set", "uncertainty.samples=128", "-o", "r.html").exit_code == 0
    # The window of a browser cannot be as narrow as a telephone's; a frame can.
    frames = []
    for number, page in enumerate((catalogue, folder / "r.html")):
        policy = "style-src 'unsafe-inline'"
        watched = page.read_text().replace(policy, f"{policy}; script-src 'unsafe-inline'", 1)
        (folder / f"{number}.html").write_text(watched.replace("<head>", "<head>" + WATCH, 1))
        frames += [f'<iframe src="{number}.html" style="width: {w}px; height: 900px"></iframe>' for w in (390, 1280)]
    options = ("--virtual-time-budget=8000", "--window-size=1400,2000")
    show = """<script>setTimeout(() => { const pages = [...document.querySelectorAll("iframe")];
      document.body.innerHTML = pages.map(page => page.contentDocument.body.innerHTML).join(""); }, 3000);</script>"""
    (folder / "frame.html").write_text(f"<body>{''.join(frames)}{show}</body>")
    content = browse(folder / "frame.html", *options, "--dump-dom")
    answers = content.split('<pre id="found">')[1:]
    assert len(answers) == len(frames)
    for answer in answers:
        found = json.loads(answer.split("</pre>")[0])
        assert found["said"] == []
        assert found["asked"] == []
        assert len(found["drawn"]) >= 3
        assert all(found["drawn"])
        assert not found["wide"]
        assert found["height"] <= 5400  # every warning is open
        assert found["cut"] == 0


@needs_chromium
def test_nothing_is_folded_in_print(catalogue: Path, folder: Path):
    opened = folder / "opened.html"
    opened.write_text(catalogue.read_text().replace("<details>", "<details open>"))
    pages = []
    for name, page in (("folded", catalogue), ("opened", opened)):
        browse(page, "--no-pdf-header-footer", f"--print-to-pdf={folder / name}.pdf")
        pages.append((folder / f"{name}.pdf").read_bytes().count(b"/Type /Page\n"))
    assert pages[0] == pages[1]
    assert 4 <= pages[0] <= 8
