"""The page of designs: what it holds, and in Chromium what it answers."""

import json
import re
import shlex
from base64 import b64decode, b64encode
from collections.abc import Sequence
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from armour.analysis.ballistic_limit import ballistic_limit, confidence
from armour.design.catalogue import catalogue_of
from armour.design.optimise import optimise
from armour.errors import InputError
from armour.reporting import design_page as module
from armour.reporting.design_page import design_page
from armour.reporting.formats import TEMPLATES
from armour.reporting.words import chance
from armour.scenario.scenario import Scenario
from tests.helpers.browser import CHROMIUM, browse, needs_chromium
from tests.helpers.cases import scenario, shipped_scenario
from tests.helpers.known import known

pytestmark = pytest.mark.slow

COMMAND = ("armour", "simulate", "catalogue")
TITLE = "</script><script>alert(1)</script> & <b>"


@cache
def offered() -> Scenario:
    return shipped_scenario("catalogue").replaced({"title": TITLE, "design.confidence": 0.9})


@cache
def page() -> str:
    return design_page(offered(), COMMAND)


def data_of(content: str) -> dict[str, Any]:
    [text] = re.findall(r'<script type="application/json" id="data">(.*?)</script>', content, re.DOTALL)
    found: dict[str, Any] = json.loads(text)
    return found


def numbers_of(pair: dict[str, Any], threats: int) -> tuple[Any, Any]:
    """Limits, (ceramics, back plates, threats), and the velocities stopped with each probability."""
    shape = len(pair["ceramics"]), len(pair["backings"]), threats
    floats = np.frombuffer(b64decode(pair["floats"]), dtype="<f4").reshape(*shape, 3).astype(float)
    differences = np.frombuffer(b64decode(pair["differences"]), dtype="<u2").reshape(*shape, -1)
    above = np.concatenate([np.zeros((*shape, 1)), np.cumsum(differences, axis=-1) * pair["step"]], axis=-1)
    return floats[..., 0], floats[..., 1:2] + above


def test_every_thickness_on_offer_is_a_node():
    pairs = data_of(page())["pairs"]
    for pair, offer in zip(pairs, catalogue_of(offered()).offers, strict=True):
        for nodes, places, layer in zip((pair["ceramics"], pair["backings"]), pair["offered"], offer[:2], strict=True):
            assert [nodes[place] for place in places] == list(layer.thicknesses())


def test_a_node_has_the_limit_and_the_probabilities_of_its_design():
    threats = data_of(page())["threats"]
    pair = data_of(page())["pairs"][0]
    limits, stopped = numbers_of(pair, len(threats))
    i, j = pair["offered"][0][7], pair["offered"][1][2]
    for t in range(len(threats)):
        armour = (
            catalogue_of(offered())
            .against(0, t)
            .replaced(
                {"armour.ceramic_thickness_mm": pair["ceramics"][i], "armour.backing_thickness_mm": pair["backings"][j]}
            )
        )
        assert limits[i, j, t] == pytest.approx(ballistic_limit(armour).ballistic_limit_m_s, abs=0.02)
        for q in (0, 8, 16):
            sure = confidence(armour.replaced({"impact.velocity_m_s": float(stopped[i, j, t, q])}))
            stated = min(module.PROBABILITIES[q], known(sure.model_error).greatest_probability)
            assert sure.probability_of_stopping == pytest.approx(stated, abs=2e-4)


def test_a_page_is_the_same_each_time():
    grid = {"min": 6.0, "max": 8.0, "step": 1.0}
    few = scenario(optimise={"ceramic_thickness_mm": grid, "backing_thickness_mm": grid})
    assert design_page(few, COMMAND) == design_page(few, COMMAND)


def test_a_page_is_small_and_asks_for_nothing():
    assert len(page().encode()) < 1_500_000
    assert (TEMPLATES / "map.js").stat().st_size <= 54_000
    assert "http" not in page().replace("http-equiv", "").replace("http://www.w3.org/2000/svg", "")
    assert page().count("</script>") == 2
    scripts, styles = (re.findall(rf"<{tag}>(.*?)</{tag}>", page(), re.DOTALL) for tag in ("script", "style"))
    for text, policy in ((scripts[0], "script-src"), (styles[0], "style-src")):
        assert f"{policy} 'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'" in page()


def test_more_than_a_page_can_hold_is_refused(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "MOST_DESIGNS", 500)
    with pytest.raises(InputError, match="must offer at most 500 designs times threats to draw them on a page"):
        design_page(offered(), COMMAND)


def test_a_page_that_would_be_large_has_fewer_nodes_between_those_on_offer(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "MOST_DESIGNS", 620)
    pairs = data_of(design_page(offered(), COMMAND))["pairs"]
    assert all(pair["coarser"] for pair in pairs)
    assert [len(pair["ceramics"]) for pair in pairs] == [len(pair["offered"][0]) for pair in pairs]
    assert not data_of(page())["pairs"][0]["coarser"]


def test_what_is_not_shown_is_said():
    grid = {"min": 6.0, "max": 8.0, "step": 1.0}
    several = shipped_scenario("reliable").replaced(
        {"design.minimise": "thickness_mm", "optimise": {"ceramic_thickness_mm": grid, "backing_thickness_mm": grid}}
    )
    notes = " ".join(data_of(page())["notes"] + data_of(design_page(several, COMMAND))["notes"])
    for words in (
        "Pareto front",
        "greatest thickness",
        "least thickness; this page",
        "distributions of the inputs are not",
    ):
        assert words in notes


# --- in Chromium ------------------------------------------------------------------------------------------------------


class Question(NamedTuple):
    """A page, a script that returns what is asked of it, or a promise, and the width of its frame."""

    content: str
    script: str
    width: int = 1280


WATCH = """const said = [];
  addEventListener("error", e => said.push(e.message));
  addEventListener("securitypolicyviolation", e => said.push(e.violatedDirective + " " + e.blockedURI));"""


def framed(question: Question) -> str:
    """The page of a question with its script, which the policy admits, and with one that watches."""
    after = f"""(async () => {{
      let found; try {{ found = await (async () => {{ {question.script} }})(); }} catch (e) {{ said.push(String(e)); }}
      const asked = performance.getEntriesByType("resource").map(entry => entry.name);
      document.body.innerHTML = "";
      const pre = document.createElement("pre");
      pre.id = "found";
      pre.textContent = JSON.stringify({{ said, asked, found }});
      document.body.append(pre);
      }})();"""
    hashes = " ".join(f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'" for text in (WATCH, after))
    content = question.content.replace("script-src '", f"script-src {hashes} '", 1)
    content = content.replace("<title>", f"<script>{WATCH}</script><title>", 1)
    return content.replace("</body>", f"<script>{after}</script></body>")


def browsed(folder: Path, questions: Sequence[Question]) -> list[Any]:
    """What the scripts return, all in one start of the browser; without an error or a request."""
    # The window of a browser cannot be as narrow as a telephone's; a frame can.
    frames = ""
    for number, question in enumerate(questions):
        (folder / f"{number}.html").write_text(framed(question))
        frames += f'<iframe src="{number}.html" style="width: {question.width}px; height: 900px"></iframe>'
    take = """setTimeout(() => {
      const found = [...document.querySelectorAll("iframe")].map(frame =>
        JSON.parse(frame.contentDocument.getElementById("found").textContent));
      document.body.textContent = JSON.stringify(found);
    }, 4000);"""
    (folder / "outer.html").write_text(f"<body>{frames}<script>{take}</script></body>")
    window = ("--window-size=1400,1200", "--virtual-time-budget=8000", "--dump-dom")
    written = browse(folder / "outer.html", *window)
    [text] = re.findall(r"<body>(.*)</body>", written, re.DOTALL)
    results = json.loads(text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
    assert [(result["said"], result["asked"]) for result in results] == [([], [])] * len(questions)
    return [result["found"] for result in results]


CASES = [
    ([850.0, 830.0], None),
    ([850.0, 830.0], 90),
    ([800.0, 900.0], 80),
    ([700.0, 650.0], 95),
    ([1200.0, 900.0], 50.5),
]
LIGHTEST = f"""const cases = {json.dumps(CASES)};
return cases.map(([velocities, confidence]) => {{
  state.velocities = velocities;
  state.confidence = confidence;
  return DATA.pairs.map(pair => {{ const k = lightest(pair); return k === null ? null : thicknesses(pair, k); }});
}});"""
VELOCITIES = np.linspace(600.0, 1300.0, 36).tolist()
CHANCES = f"""const pair = DATA.pairs[0];
  return pair.onOffer.map(k => [...thicknesses(pair, k), ...{VELOCITIES}.map(v => below(score(pair, k, v)))]);"""
KEYS = """const press = (key, more) => $("map").dispatchEvent(new KeyboardEvent("keydown", { key, ...more }));
  press("Home"); press("ArrowUp"); press("ArrowLeft", { shiftKey: true }); press("Enter");
  return { wide: document.documentElement.scrollWidth - innerWidth, pins: state.pins.length, title: document.title,
    notes: $("notes").textContent, headline: $("headline").textContent, design: $("design").textContent,
    commands: document.querySelectorAll("code").length };"""
COPIES = """const pair = DATA.pairs[state.pair], words = command(pair, lightest(pair)), copies = [];
  for (const refuses of [false, true]) {
    let written = null;
    const writeText = async text => { if (refuses) throw new Error("refused"); written = text; };
    Object.defineProperty(navigator, "clipboard", { value: { writeText }, configurable: true });
    const button = document.querySelector("#table button");
    button.focus();
    button.click();
    await new Promise(after => setTimeout(after, 50));
    copies.push([button.textContent, written ?? String(getSelection()).trim(), document.activeElement === button]);
  }
  return [words, copies];"""
SHOWN = """const pair = DATA.pairs[0];
  return pair.onOffer.map(k => {
    state.cursor = k;
    drawDesign(pair, k);
    return [...thicknesses(pair, k), $("design").textContent.replaceAll("\u2212", "-")];
  });"""
SENTENCES: list[tuple[dict[str, Any], str]] = [
    ({"armour.ceramic": "SiC"}, "How likely it is to stop is unknown."),
    (
        {
            "threat": [
                {"projectile": "7.62 mm AP", "velocity_m_s": 850.0},
                {"projectile": "7.62 mm APM2", "velocity_m_s": 830.0, "obliquity_deg": 30.0},
            ]
        },
        "No test like AD85 on 5083-H3 against 7.62 mm APM2 at 830 m/s, 30° is known, so no probability is known.",
    ),
    (
        {"impact.velocity_m_s": 3000.0},
        "None passes: the nearest, 12 mm AD85 on 12 mm 5083-H3, 74.2 kg/m², lacks 1995 m/s against",
    ),
    (
        {"impact.velocity_m_s": 3000.0, "design.confidence": 0.9},
        "None passes: the nearest, 12 mm AD85 on 12 mm 5083-H3, 74.2 kg/m², lacks 2038 m/s against",
    ),
    ({"optimise.backing_thickness_mm": {"min": 6.0, "max": 6.0, "step": 1.0}}, "6 mm 5083-H3"),
    (
        {
            "design.confidence": 0.6,
            "uncertainty.impact.velocity_m_s": {"distribution": "normal", "standard_deviation": 5.0},
        },
        "with 60 % confidence, with exact inputs.",
    ),
    (
        {"design.ceramic": [{"material": "AD85", "thickness_mm": {"min": 8.0, "max": 14.0}}]},
        "Any thickness is on offer",
    ),
    ({"impact.velocity_m_s": 700.0}, "is the lightest whose computed ballistic limit reaches 7.62 mm AP at 700 m/s."),
]


@cache
def thin() -> Scenario:
    """Few designs, some with thin back plates, where the laws of the evidence are far apart."""
    return shipped_scenario("paper/optimum_7.62mm_AP").replaced(
        {
            "optimise.ceramic_thickness_mm": {"min": 8.0, "max": 14.0, "step": 3.0},
            "optimise.backing_thickness_mm": {"min": 4.0, "max": 8.0, "step": 2.0},
        }
    )


ODD = 'it\'s a "rod" of $HOME'


def odd_page() -> str:
    """The page of a projectile whose name a shell would not leave as it is."""
    projectile = {
        "penetrator_diameter_mm": 6.5,
        "penetrator_mass_g": 5.46,
        "density_kg_m3": 7850.0,
        "flow_stress_GPa": 2.35,
    }
    range_mm = {"min": 6.0, "max": 9.0, "step": 1.0}
    own = scenario(
        library={"projectile": {ODD: projectile}},
        threat=[{"projectile": ODD, "velocity_m_s": 800.0}],
        optimise={"ceramic_thickness_mm": range_mm, "backing_thickness_mm": range_mm},
    )
    return design_page(own, ("armour", "simulate", "a file.toml"), ["ballistic_limit.velocity_max_m_s=2500"])


def page_with(changes: dict[str, Any]) -> str:
    grid = {"min": 6.0, "max": 12.0, "step": 2.0}
    first: dict[str, Any] = {"optimise.ceramic_thickness_mm": grid, "optimise.backing_thickness_mm": grid}
    return design_page(shipped_scenario("paper/optimum_7.62mm_AP").replaced({**first, **changes}), COMMAND)


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the pages answer in Chromium, by the name of the question."""
    if CHROMIUM is None:
        pytest.skip("needs Chromium")
    questions = {
        "lightest": Question(page(), LIGHTEST),
        "chances": Question(design_page(thin(), COMMAND), CHANCES),
        "keys, 390": Question(page(), KEYS, 390),
        "keys, 1280": Question(page(), KEYS),
        "shown": Question(page(), SHOWN),
        "copies": Question(page(), COPIES),
        "odd": Question(odd_page(), "return command(DATA.pairs[0], DATA.pairs[0].onOffer[5]);"),
    }
    show = 'return $("headline").textContent + $("beside").textContent;'
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "PAGE_NODES", module.PAGE_NODES[-1:])  # they are on designs on offer
        questions |= {words: Question(page_with(changes), show) for changes, words in SENTENCES}
    return dict(zip(questions, browsed(tmp_path_factory.mktemp("pages"), list(questions.values())), strict=True))


def answers(of: Scenario, velocities: list[float], asked: float | None) -> list[list[float] | None]:
    """The best design of every pair of a scenario by `optimise`, in the order of the catalogue."""
    threats = [
        {**threat.model_dump(exclude_unset=True), "velocity_m_s": v}
        for threat, v in zip(of.threat, velocities, strict=True)
    ]
    changed = of.replaced({"threat": threats, "design.confidence": asked})
    offers = catalogue_of(changed).offers
    result = optimise(changed)
    if result.reason:
        return [None] * len(offers)
    pairs = {(pair.ceramic, pair.backing): pair.best for pair in result.pairs}
    found = [pairs[offer.ceramic.material, offer.backing.material] for offer in offers]
    if asked is not None:  # the page keeps what passes by the computed limit alone apart
        found = [best and (best if best.model_error else None) for best in found]
    return [None if best is None else [best.ceramic_thickness_mm, best.backing_thickness_mm] for best in found]


def test_the_lightest_designs_are_those_that_optimise_finds(told):
    for (velocities, percent), designs in zip(CASES, told["lightest"], strict=True):
        assert designs == answers(offered(), velocities, None if percent is None else percent / 100)


def test_probabilities_between_the_nodes_are_right(told):
    found = np.array(told["chances"])
    catalogue = catalogue_of(thin())
    candidates = catalogue.candidates(0, found[:, 0], found[:, 1])
    rows = catalogue.against_each(candidates)
    of_shots = rows.shot_distributions(rows.limits_anywhere())
    for n, (chances, greatest) in enumerate(zip(found[:, 2:], rows.errors.greatest, strict=True)):
        sure = np.minimum(of_shots.one(n).probability_above(VELOCITIES), greatest)
        within = (sure >= 0.01) & (sure <= 0.99)
        assert within.sum() > 5
        assert chances[within] == pytest.approx(sure[within], abs=0.002)
        assert chances[~within] == pytest.approx(sure[~within], abs=0.0101)


def test_numbers_are_rounded_as_everywhere_else(told):
    """A limit to the nearest, a probability down, but where the error of the page may be a whole per cent."""
    catalogue = catalogue_of(offered())
    for ceramic_mm, backing_mm, text in told["shown"]:
        candidates = catalogue.candidates(0, np.array([ceramic_mm]), np.array([backing_mm]))
        rows = catalogue.against_each(candidates)
        limits = rows.limits_anywhere()
        by_tests = rows.shot_distributions(limits).probability_above(catalogue.velocities_m_s)
        sure = np.minimum(by_tests, rows.errors.greatest)
        for limit, probability, velocity in zip(limits, sure, catalogue.velocities_m_s, strict=True):
            assert f"Computed limit {limit:.0f} m/s, margin {limit - velocity:+.0f} m/s" in text
            if abs(100.0 * probability - round(100.0 * probability)) > 0.2:
                assert f"{chance(probability)} stopped" in text


@pytest.mark.parametrize("width", [390, 1280])
def test_it_works_by_keyboard_and_keeps_within_its_width(told, width: int):
    found = told[f"keys, {width}"]
    assert found["wide"] <= 0
    assert found["pins"] == 1
    assert TITLE in found["notes"]
    assert (
        "is the lightest that stops 7.62 mm AP at 850 m/s and 7.62 mm APM2 at 830 m/s with 90 % confidence "
        "and the margin asked for." in found["headline"]
    )
    assert "stopped" in found["design"]
    assert found["commands"] == 3


def test_a_command_is_copied_or_selected_where_the_browser_refuses(told):
    words, copies = told["copies"]
    assert copies == [["Copied", words, True], ["Selected", words, True]]


def test_commands_are_of_the_designs_and_need_no_care_in_a_shell(told):
    assert shlex.split(told["odd"]) == [
        *("armour", "simulate", "a file.toml", "--set", "ballistic_limit.velocity_max_m_s=2500"),
        *("--set", "armour.ceramic_thickness_mm=7", "--set", "armour.backing_thickness_mm=7"),
        *("--set", f"impact.projectile={json.dumps(ODD)}"),
    ]


@pytest.mark.parametrize("words", [words for _, words in SENTENCES])
def test_the_sentences_are_those_of_the_case(told, words: str):
    assert words in told[words]


@needs_chromium
def test_a_page_names_what_the_model_cannot_do_for_the_design_it_names(tmp_path: Path):
    rod = {"penetrator_diameter_mm": 10.0, "penetrator_mass_g": 138.2, "density_kg_m3": 17600.0, "flow_stress_GPa": 1.9}
    bare = scenario(
        "rod",
        None,
        "RHA Class 1",
        0.0,
        10.0,
        velocity=1500.0,
        library={"projectile": {"rod": rod}},
        design={"backing": [{"material": "RHA Class 1", "thickness_mm": [8.0, 10.0]}]},
    )
    metals = [{"material": name, "thickness_mm": [40.0]} for name in ("6061-T6", "7075-T6")]
    tiles = {"ceramic": [{"material": "SiC", "thickness_mm": [3.0, 12.0]}], "backing": metals}
    thin, thick = (
        scenario("12.7 mm APM2", "SiC", "6061-T6", 3.0, 40.0, velocity=v, design=tiles) for v in (400.0, 1100.0)
    )
    show = 'return $("headline").textContent + " " + $("beside").textContent;'
    found = browsed(tmp_path, [Question(design_page(of, COMMAND), show) for of in (bare, thin, thick)])
    assert found[0].startswith("Not known, as the limit is too low: the nearest, 10 mm RHA Class 1")
    assert "twice" not in found[0]
    assert "2.0 times the hydrodynamic depth; the limit is too low." in found[0]
    assert ["No ceramic thinner than 0.89 penetrator diameters" in words for words in found] == [False, True, False]
    assert ["do not rely on this comparison of metals" in words for words in found] == [False, True, True]
